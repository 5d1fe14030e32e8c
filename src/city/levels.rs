//! Which level of detail of each object is taken.
//!
//! The highest that is wanted, of each object for itself. Level 0 is a footprint or the edge of a roof, drawn flat: a wall-less
//! polygon at a height of its own, which no photograph shows; it is never taken for a building. Where a building and its parts
//! have different levels, the lower are the same walls again, drawn coarser.

use super::{CityRole, Lod};
use crate::format::surfaces::{ObjectRecord, SurfaceFile};

/// Which level of detail is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CityLod {
    /// The highest of each object.
    #[default]
    Highest,
    /// The highest of each object that is not above this.
    UpTo(Lod),
}

/// Ground has no walls at any level.
const GROUND_CLASS: &str = "TINRelief";

/// Polygons with no level stand above footprints and below all others.
const UNSAID: Lod = Lod(0, u8::MAX);

/// How polygons of a file are passed over, with the first object of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Passed {
    pub count: u64,
    pub first_object: u32,
}

impl Passed {
    fn add(&mut self, object: u32) {
        self.first_object = if self.count == 0 { object } else { self.first_object };
        self.count += 1;
    }
}

/// The polygons that are taken.
#[derive(Clone, Debug, Default)]
pub(super) struct Chosen {
    /// Indices into [`SurfaceFile::surfaces`], ascending.
    pub surfaces: Vec<u32>,
    /// Footprints of objects that have nothing higher.
    pub footprints: Passed,
    /// Polygons of objects that have nothing up to the wanted level.
    pub too_high: Passed,
}

/// Chooses polygons of a file.
pub(super) fn choose(file: &SurfaceFile, wanted: CityLod, role: CityRole) -> Chosen {
    let levels = levels_of_objects(file, wanted, role);
    let mut chosen = Chosen::default();
    for (at, surface) in file.surfaces.iter().enumerate() {
        let object = surface.object as usize;
        let level = level_of(surface.lod);
        let takes_footprints = takes_footprints(&file.objects[object], role);
        match levels[object] {
            Level::Taken(taken) if taken == level => chosen.surfaces.push(at as u32),
            Level::Taken(_) | Level::Coarser => {}
            Level::Relatives if is_footprint(level) => {}
            Level::None if is_footprint(level) && !takes_footprints => chosen.footprints.add(surface.object),
            Level::None | Level::Relatives => chosen.too_high.add(surface.object),
        }
    }
    chosen
}

/// What is taken of one object.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Level {
    Taken(Lod),
    /// Its building, or a part of it, has a higher one.
    Coarser,
    /// It has none that may be taken, but its building or a part of it has.
    Relatives,
    /// Neither has.
    None,
}

fn levels_of_objects(file: &SurfaceFile, wanted: CityLod, role: CityRole) -> Vec<Level> {
    let mut best: Vec<Option<Lod>> = vec![None; file.objects.len()];
    for surface in &file.surfaces {
        let object = surface.object as usize;
        let level = level_of(surface.lod);
        let is_wanted = match wanted {
            CityLod::Highest => true,
            CityLod::UpTo(limit) => level == UNSAID || level <= limit,
        };
        if is_wanted && (!is_footprint(level) || takes_footprints(&file.objects[object], role)) {
            best[object] = best[object].max(Some(level));
        }
    }
    // The highest of a building and its parts, at the building.
    let mut of_family = best.clone();
    let heads: Vec<usize> = (0..best.len()).map(|object| head_of(&file.objects, object)).collect();
    for (object, &head) in heads.iter().enumerate() {
        of_family[head] = of_family[head].max(best[object]);
    }
    let level = |(object, &head): (usize, &usize)| match best[object] {
        None if of_family[head].is_some() => Level::Relatives,
        None => Level::None,
        Some(level) if Some(level) < of_family[head] => Level::Coarser,
        Some(level) => Level::Taken(level),
    };
    heads.iter().enumerate().map(level).collect()
}

fn level_of(lod: Option<Lod>) -> Lod {
    lod.unwrap_or(UNSAID)
}

fn is_footprint(level: Lod) -> bool {
    level.0 == 0 && level != UNSAID
}

fn takes_footprints(object: &ObjectRecord, role: CityRole) -> bool {
    role == CityRole::Terrain || object.class == GROUND_CLASS
}

/// The building that an object is a part of by its class, or the object. Balconies and chimneys (installations) are none: their
/// level says nothing of the walls.
fn head_of(objects: &[ObjectRecord], object: usize) -> usize {
    let mut head = object;
    while let Some(parent) = objects[head].parent.filter(|_| objects[head].class.ends_with("Part")) {
        head = parent as usize;
    }
    head
}
