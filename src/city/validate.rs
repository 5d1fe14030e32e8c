//! What is wrong with shells as a whole: sides that disagree, walls that stand twice, shells that are open.

use rayon::prelude::*;

use super::edges::{by_object, objects_of, sorted_edges};
use super::sorting::{digest, each_alike};
use super::warning::{CityDefect, CityPlace, Warnings};
use super::{CityModel, CityRole, CitySource, Facet};
use crate::geometry::{Point3, Vector3};

/// Objects looked at together by one thread.
pub(super) const OBJECTS_PER_CHUNK: usize = 64;

/// Metres; a city that is smaller or larger across is in other units, or has vertices that belong elsewhere.
const SMALLEST_CITY_M: f64 = 1.0;
const LARGEST_CITY_M: f64 = 200_000.0;

/// Metres; a further mesh may begin this far from the city, or as far as the city is large.
const NEAR_M: f64 = 1000.0;

/// What the edges of one object tell.
#[derive(Clone, Copy, Default)]
struct Shell {
    edges: u64,
    /// Edges of one facet only, and the first facet that has one.
    open: u64,
    first_open: u32,
    /// Edges that two facets walk in the same direction, so that their outward sides disagree.
    mixed: u64,
    first_mixed: u32,
}

/// Judges the objects of one file; `place_of` says where a facet came from.
pub(super) fn validate(
    model: &CityModel,
    source: &CitySource,
    warnings: &mut Warnings,
    place_of: impl Fn(u32) -> CityPlace,
) {
    let by_object = by_object(model, source.facets.clone());
    let objects = objects_of(model, &by_object);
    let judged = objects.par_chunks(OBJECTS_PER_CHUNK);
    let shells: Vec<Vec<Shell>> =
        judged.map(|chunk| chunk.iter().map(|facets| judge(model, facets)).collect()).collect();
    for shell in shells.iter().flatten() {
        if shell.mixed > 0 {
            let defect = CityDefect::MixedOrientation { edges: shell.mixed };
            warnings.add(defect, 1, || place_of(shell.first_mixed));
        }
        // Terrain is open by its nature.
        if shell.open > 0 && source.role == CityRole::City {
            let defect = CityDefect::OpenShell { open_edges: shell.open, edges: shell.edges };
            warnings.add(defect, 1, || place_of(shell.first_open));
        }
    }
    for (facet, earlier_is_reversed) in doubled(model, source.facets.clone()) {
        let defect = if earlier_is_reversed { CityDefect::DoubledReversed } else { CityDefect::Doubled };
        warnings.add(defect, 1, || place_of(facet));
    }
}

fn judge(model: &CityModel, facets: &[u32]) -> Shell {
    let edges = sorted_edges(model, facets);
    let mut shell = Shell { first_open: u32::MAX, first_mixed: u32::MAX, ..Shell::default() };
    for edge in edges.chunk_by(|a, b| a.ends() == b.ends()) {
        shell.edges += 1;
        match edge {
            [only] => {
                shell.open += 1;
                shell.first_open = shell.first_open.min(facets[only.facet()]);
            }
            // More than two facets at one edge are no shell, and tell nothing about sides.
            [one, other] if one.rises() == other.rises() => {
                shell.mixed += 1;
                shell.first_mixed = shell.first_mixed.min(facets[one.facet().min(other.facet())]);
            }
            _ => {}
        }
    }
    shell
}

/// Facets that have the outline of an earlier one of the whole model, and whether that runs the other way round.
fn doubled(model: &CityModel, facets: std::ops::Range<u32>) -> Vec<(u32, bool)> {
    let key_of = |facet: u32| key(&model.facets[facet as usize]);
    let mut doubled = Vec::new();
    each_alike(
        facets.end,
        |facet| digest(key_of(facet).map(u64::from)),
        key_of,
        |alike| {
            let outline = |&facet: &u32| {
                let (outline, is_reversed) = canonical(&model.facets[facet as usize]);
                (outline, facet, is_reversed)
            };
            let mut outlines: Vec<(Vec<u32>, u32, bool)> = alike.iter().map(outline).collect();
            outlines.sort_unstable();
            for same in outlines.chunk_by(|a, b| a.0 == b.0) {
                doubled.extend(same[1..].iter().map(|(_, facet, is_reversed)| (*facet, *is_reversed != same[0].2)));
            }
        },
    );
    doubled.retain(|(facet, _)| facets.contains(facet));
    doubled.sort_unstable();
    doubled
}

/// Equal for outlines of the same vertices in the same or the opposite order with as many holes, and seldom for others.
fn key(facet: &Facet) -> [u32; 4] {
    let lowest = facet.outline.iter().copied().min().unwrap_or_default();
    let highest = facet.outline.iter().copied().max().unwrap_or_default();
    let sum = facet.outline.iter().fold(0_u32, |sum, &vertex| sum.wrapping_add(vertex));
    [
        lowest,
        highest,
        sum,
        facet.rings().map(|ring| ring.len() as u32).fold(0, |all, ring| all.wrapping_mul(31).wrapping_add(ring)),
    ]
}

/// The outline from its lowest vertex on, in the direction of the lower neighbour, and whether that is backwards.
fn canonical(facet: &Facet) -> (Vec<u32>, bool) {
    let outline = &facet.outline;
    let start = (0..outline.len()).min_by_key(|&at| outline[at]).unwrap_or(0);
    let mut turned: Vec<u32> = outline[start..].iter().chain(&outline[..start]).copied().collect();
    let is_reversed = turned.len() > 2 && turned[1] > turned[turned.len() - 1];
    if is_reversed {
        turned[1..].reverse();
    }
    (turned, is_reversed)
}

/// Looks for files in other units or frames than metres about one place.
pub(super) fn check_extents(model: &CityModel, warnings: &mut Warnings) {
    let boxes: Vec<Option<Extent>> = model.sources.iter().map(|source| extent(model, source.facets.clone())).collect();
    let is_city = |at: &usize| model.sources[*at].role == CityRole::City;
    let city_without = |left_out: usize| {
        let tiles = (0..boxes.len()).filter(is_city).filter(|&at| at != left_out);
        tiles.filter_map(|at| boxes[at]).reduce(Extent::with)
    };
    let place = |source: &CitySource| CityPlace { path: source.path.clone(), line: None, object: String::new() };
    let Some(city) = city_without(usize::MAX) else { return };
    if let Some(defect) = odd_extent(city.across_m()) {
        warnings.add(defect, 1, || place(&model.sources[0]));
    }
    for (at, source) in model.sources.iter().enumerate().skip(1) {
        let (Some(own), Some(city)) = (boxes[at], city_without(at)) else { continue };
        let gap = (own.low - city.high).sup(&(city.low - own.high)).sup(&Vector3::zeros());
        let distance_m = gap.norm();
        if distance_m > NEAR_M.max(city.across_m()) {
            warnings.add(CityDefect::FarApart { distance_m }, 1, || place(source));
        }
    }
}

/// What is told of a city that is so wide.
pub(super) fn odd_extent(across_m: f64) -> Option<CityDefect> {
    (!(SMALLEST_CITY_M..=LARGEST_CITY_M).contains(&across_m)).then_some(CityDefect::OddExtent { across_m })
}

#[derive(Clone, Copy)]
struct Extent {
    low: Point3<f64>,
    high: Point3<f64>,
}

impl Extent {
    fn with(self, other: Extent) -> Extent {
        Extent { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    fn across_m(&self) -> f64 {
        (self.high - self.low).xy().amax()
    }
}

fn extent(model: &CityModel, facets: std::ops::Range<u32>) -> Option<Extent> {
    let facets = &model.facets[facets.start as usize..facets.end as usize];
    let mut corners = facets.iter().flat_map(|facet| &facet.outline).map(|&vertex| model.vertices[vertex as usize]);
    let first = corners.next()?;
    let widen =
        |extent: Extent, corner: Point3<f64>| Extent { low: extent.low.inf(&corner), high: extent.high.sup(&corner) };
    Some(corners.fold(Extent { low: first, high: first }, widen))
}
