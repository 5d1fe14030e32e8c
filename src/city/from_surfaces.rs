//! Chosen polygons of a file to a [`Source`].

use std::path::Path;

use super::frame::Frame;
use super::levels::{Chosen, Passed};
use super::source::{Source, written_precision};
use super::warning::{CityDefect, CityPlace, CityWarning};
use super::{CityContents, CityRole};
use crate::format::surfaces::{ObjectRecord, SurfaceFile};
use crate::geometry::Point3;

/// Nobody measures finer than micrometres, whatever a file can write.
const FINEST_STEP_M: f64 = 1e-6;

/// Index of an object whose polygons are not used.
const UNUSED: u32 = u32::MAX;

impl Source {
    /// Chosen polygons of a file, in the city's frame. What belongs to a building is named as the building.
    pub fn from_surfaces(path: &Path, role: CityRole, file: SurfaceFile, chosen: &Chosen, frame: &Frame) -> Source {
        let contents = CityContents::of(&file);
        let warnings = warnings(path, &file, chosen);
        let mut source = Source {
            path: path.to_owned(),
            role,
            positions: Vec::new(),
            corners: Vec::with_capacity(file.corners.len()),
            face_ends: Vec::with_capacity(chosen.surfaces.len()),
            holes: Vec::new(),
            face_lines: Vec::new(),
            face_kinds: Vec::with_capacity(chosen.surfaces.len()),
            face_objects: Vec::with_capacity(chosen.surfaces.len()),
            objects: Vec::new(),
            contents,
            // Every writer gives a corner of two polygons to both.
            shares_vertices: false,
            precision_m: 0.0,
            warnings,
        };
        let mut object_of_root = vec![UNUSED; file.objects.len()];
        for &surface in &chosen.surfaces {
            let surface = file.surfaces[surface as usize];
            let root = root_of(&file.objects, surface.object as usize);
            if object_of_root[root] == UNUSED {
                object_of_root[root] = source.objects.len() as u32;
                source.objects.push(file.objects[root].id.clone());
            }
            let face = source.face_ends.len() as u32;
            for ring in surface.first_ring..surface.first_ring + surface.ring_count {
                if ring > surface.first_ring {
                    source.holes.push((face, source.corners.len() as u32));
                }
                source.corners.extend_from_slice(file.ring(ring));
            }
            source.face_ends.push(source.corners.len() as u32);
            source.face_kinds.push(surface.kind);
            source.face_objects.push(object_of_root[root]);
        }
        // Heights alone, where the others are computed.
        let written = |[x, y, z]: &[f64; 3]| match frame.projection {
            None => Point3::new(*x, *y, *z),
            Some(_) => Point3::new(0.0, 0.0, *z),
        };
        let step = file.step.filter(|_| frame.projection.is_none()).map(|step| step.max(FINEST_STEP_M));
        let precision = || written_precision(&file.positions.iter().map(written).collect::<Vec<_>>(), 0.0);
        source.precision_m = step.unwrap_or_else(precision);
        source.positions = file.positions.into_iter().map(|position| frame.placed(position)).collect();
        source
    }
}

/// The building that a part of a part belongs to.
pub(super) fn root_of(objects: &[ObjectRecord], object: usize) -> usize {
    let mut root = object;
    while let Some(parent) = objects[root].parent {
        root = parent as usize;
    }
    root
}

fn warnings(path: &Path, file: &SurfaceFile, chosen: &Chosen) -> Vec<CityWarning> {
    let place = |object: &str| CityPlace { path: path.to_owned(), line: None, object: object.to_owned() };
    let skipped = file.skipped.iter().map(|skipped| CityWarning {
        defect: CityDefect::PassedOver { what: skipped.what.into() },
        count: skipped.count as u64,
        example: place(&skipped.example),
    });
    let passed = [(CityDefect::Footprints, chosen.footprints), (CityDefect::AboveWantedLevel, chosen.too_high)];
    let passed = passed.into_iter().filter(|(_, passed)| passed.count > 0).map(|(defect, passed): (_, Passed)| {
        let example = place(&file.objects[passed.first_object as usize].id);
        CityWarning { defect, count: passed.count, example }
    });
    skipped.chain(passed).collect()
}
