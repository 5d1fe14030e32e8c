//! What is told of a city that is built part by part: sums over the parts, and what follows from them.

use std::path::Path;

use crate::city::build::BuiltPart;
use crate::city::frame::Frame;
use crate::city::orientation::ToldArea;
use crate::city::source::Source;
use crate::city::units::{guess_by_houses, heights_of_houses};
use crate::city::upright::UprightAreas;
use crate::city::validate::odd_extent;
use crate::city::warning::Warnings;
use crate::city::{CityDefect, CityModel, CityOptions, CityPlace, CitySize, CityUp, CityWarning};
use crate::geometry::Point3;

/// Sums over parts.
#[derive(Default)]
pub(super) struct Tally {
    pub told: ToldArea,
    pub precision_m: f64,
    facets: usize,
    triangles: usize,
    /// Objects that have facets.
    judged: u64,
    heights: Vec<f64>,
    areas: UprightAreas,
    extent: Option<(Point3<f64>, Point3<f64>)>,
    /// Each with the place of its first object among all.
    warnings: Vec<(u32, CityWarning)>,
}

impl Tally {
    pub fn of_part(source: &Source, part: &BuiltPart, object_order: &dyn Fn(u32) -> u32) -> Tally {
        // Those of the source are among those of the part.
        let own = Tally::of_source(source, object_order);
        let warnings = placed(&part.model.warnings, source, object_order);
        Tally {
            told: part.told,
            facets: part.model.facets.len(),
            triangles: part.model.triangles.len(),
            judged: judged(&part.model),
            areas: UprightAreas::of(&part.model),
            extent: part.model.bounds(),
            warnings,
            ..own
        }
    }

    /// Of a part in which nothing has an area.
    pub fn of_source(source: &Source, object_order: &dyn Fn(u32) -> u32) -> Tally {
        Tally {
            precision_m: source.precision_m,
            heights: heights_of_houses(source),
            warnings: placed(&source.warnings, source, object_order),
            ..Tally::default()
        }
    }

    pub fn add(&mut self, other: Tally) {
        self.told.add(&other.told);
        self.precision_m = self.precision_m.max(other.precision_m);
        self.facets += other.facets;
        self.triangles += other.triangles;
        self.judged += other.judged;
        self.heights.extend(other.heights);
        self.areas.add(&other.areas);
        self.extent = match (self.extent, other.extent) {
            (Some((low, high)), Some((other_low, other_high))) => Some((low.inf(&other_low), high.sup(&other_high))),
            (own, other) => own.or(other),
        };
        self.warnings.extend(other.warnings);
    }

    /// Lowest and highest corner.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        self.extent.map_or([[0.0; 3]; 2], |(low, high)| [low.into(), high.into()])
    }

    pub fn size(&self, objects: usize) -> CitySize {
        CitySize { objects, facets: self.facets, triangles: self.triangles }
    }

    /// What concerns the whole, then what is counted, each kind once with its first example.
    pub fn warnings(mut self, frame: &Frame, path: &Path, options: &CityOptions) -> Vec<CityWarning> {
        let heights = std::mem::take(&mut self.heights);
        let guess = if options.unit.is_none() { guess_by_houses(heights) } else { None };
        let odd_heights = guess.map(|guess| CityDefect::OddHeights { unit: guess.unit, height: guess.height });
        let odd_up = self.areas.odd_up(options.up.unwrap_or(CityUp::Z));
        let of_whole = |defect| {
            let example = CityPlace { path: path.to_owned(), line: None, object: String::new() };
            CityWarning { defect, count: 1, example }
        };
        let decided = frame.defects.iter().cloned().chain(odd_heights).chain(odd_up);
        let across_m = self.extent.map_or(0.0, |(low, high)| (high - low).xy().amax());
        self.warnings.sort_by_key(|(order, warning)| (step_of(&warning.defect), *order));
        let mut counted = Warnings::default();
        counted.add_all(self.warnings.into_iter().map(|(_, warning)| warning));
        let mut counted = counted.into_list();
        // Parts in which nothing is inside out do not say how many objects they have.
        for warning in &mut counted {
            if let CityDefect::InsideOut { of } = &mut warning.defect {
                *of = self.judged;
            }
        }
        let odd_extent = odd_extent(across_m);
        decided.map(of_whole).chain(counted).chain(odd_extent.map(of_whole)).collect()
    }
}

/// Objects that have facets.
fn judged(model: &CityModel) -> u64 {
    let mut objects: Vec<u32> = model.facets.iter().map(|facet| facet.object.0).collect();
    objects.sort_unstable();
    objects.dedup();
    objects.len() as u64
}

fn placed(warnings: &[CityWarning], source: &Source, object_order: &dyn Fn(u32) -> u32) -> Vec<(u32, CityWarning)> {
    let order = |warning: &CityWarning| {
        let at = source.objects.iter().position(|name| *name == warning.example.object);
        at.map_or(u32::MAX, |at| object_order(at as u32))
    };
    warnings.iter().map(|warning| (order(warning), warning.clone())).collect()
}

/// The step in which a defect is found; those of one step are told in the order of the file.
fn step_of(defect: &CityDefect) -> u8 {
    match defect {
        CityDefect::PassedOver { .. } => 0,
        CityDefect::Footprints => 1,
        CityDefect::AboveWantedLevel => 2,
        CityDefect::ZeroArea | CityDefect::NonPlanar { .. } | CityDefect::SelfIntersecting | CityDefect::Tangled => 3,
        CityDefect::InsideOut { .. } => 4,
        CityDefect::WoundAgainstTheRest { .. } => 5,
        CityDefect::MixedOrientation { .. } | CityDefect::OpenShell { .. } => 6,
        _ => 7,
    }
}
