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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::surfaces::SurfaceRecord;

    /// Objects by class and parent, and a polygon for each object and level.
    fn file(objects: &[(&str, Option<u32>)], polygons: &[(u32, Option<Lod>)]) -> SurfaceFile {
        let object = |(at, &(class, parent)): (usize, &(&str, Option<u32>))| ObjectRecord {
            id: format!("o{at}"),
            class: class.into(),
            parent,
        };
        let surface = |&(object, lod): &(u32, Option<Lod>)| SurfaceRecord {
            object,
            first_ring: 0,
            ring_count: 1,
            lod,
            kind: None,
            shell: None,
        };
        SurfaceFile {
            objects: objects.iter().enumerate().map(object).collect(),
            surfaces: polygons.iter().map(surface).collect(),
            ..SurfaceFile::default()
        }
    }

    const fn lod(whole: u8, step: u8) -> Option<Lod> {
        Some(Lod(whole, step))
    }

    #[test]
    fn each_object_has_its_own_highest() {
        let file = file(
            &[("Building", None), ("Building", None)],
            &[(0, lod(1, 2)), (0, lod(2, 2)), (1, lod(1, 3)), (0, lod(2, 2)), (1, lod(0, 0))],
        );
        assert_eq!(choose(&file, CityLod::Highest, CityRole::City).surfaces, [1, 2, 3]);
        let limited = choose(&file, CityLod::UpTo(Lod(1, u8::MAX)), CityRole::City);
        assert_eq!(limited.surfaces, [0, 2]);
        let nothing = choose(&file, CityLod::UpTo(Lod(1, 0)), CityRole::City);
        assert_eq!((nothing.surfaces.len(), nothing.too_high.count, nothing.footprints.count), (0, 4, 1));
        assert_eq!((nothing.too_high.first_object, nothing.footprints.first_object), (0, 1));
    }

    #[test]
    fn walls_of_a_building_are_not_taken_again_from_a_coarser_part_of_it() {
        let objects = [("Building", None), ("BuildingPart", Some(0)), ("BuildingInstallation", Some(0))];
        let file = file(&objects, &[(0, lod(1, 2)), (1, lod(2, 2)), (2, lod(1, 0))]);
        // The installation is a thing of its own.
        assert_eq!(choose(&file, CityLod::Highest, CityRole::City).surfaces, [1, 2]);
        assert_eq!(choose(&file, CityLod::UpTo(Lod(1, 9)), CityRole::City).surfaces, [0, 2]);
    }

    #[test]
    fn footprints_are_walls_of_nothing_but_ground_of_terrain() {
        let file = file(&[("Building", None), ("TINRelief", None)], &[(0, lod(0, 0)), (1, lod(0, 0)), (0, None)]);
        // A polygon of no level stands above a footprint.
        assert_eq!(choose(&file, CityLod::Highest, CityRole::City).surfaces, [1, 2]);
        let alone = self::file(&[("Building", None)], &[(0, lod(0, 1))]);
        assert_eq!(choose(&alone, CityLod::Highest, CityRole::City).footprints, Passed { count: 1, first_object: 0 });
        assert_eq!(choose(&alone, CityLod::Highest, CityRole::Terrain).surfaces, [0]);
    }

    #[test]
    fn every_polygon_is_taken_or_passed_over_for_one_reason() {
        let objects = [("Building", None), ("BuildingPart", Some(0)), ("BuildingPart", Some(1)), ("Road", None)];
        let levels = [None, lod(0, 0), lod(1, 0), lod(1, 3), lod(2, 2)];
        let all = (0..4_u32).flat_map(|object| levels.map(|level| (object, level)));
        let is_there =
            |(object, level): &(u32, Option<Lod>)| (object + level.map_or(0, |level| u32::from(level.0))) % 3 > 0;
        let polygons: Vec<_> = all.filter(is_there).collect();
        let file = file(&objects, &polygons);
        let mut taken_before = 0;
        for limit in [Lod(0, 9), Lod(1, 0), Lod(1, 9), Lod(3, 0)] {
            let chosen = choose(&file, CityLod::UpTo(limit), CityRole::City);
            assert!(chosen.surfaces.is_sorted());
            for &at in &chosen.surfaces {
                let level = file.surfaces[at as usize].lod;
                assert!(level.is_none_or(|level| level <= limit && level.0 > 0), "{level:?} above {limit}");
            }
            let all = chosen.surfaces.len() as u64 + chosen.footprints.count + chosen.too_high.count;
            assert!(all <= file.surfaces.len() as u64);
            taken_before = taken_before.max(chosen.surfaces.len());
        }
        assert!(taken_before > 0);
    }
}
