//! Files of other people, and files with mistakes in them, for all readers of surfaces alike.

mod mutations;
mod real_files;
mod recognisers;

use super::surfaces::{SurfaceFile, SurfaceKind, SurfaceRecord};

/// Polygons of a kind and a level of detail.
pub fn count(file: &SurfaceFile, lod: Option<(u8, u8)>, kind: Option<SurfaceKind>) -> usize {
    let is_meant = |surface: &&SurfaceRecord| surface.lod.map(|lod| (lod.0, lod.1)) == lod && surface.kind == kind;
    file.surfaces.iter().filter(is_meant).count()
}

/// The rings of a surface, as places.
pub fn rings(file: &SurfaceFile, surface: usize) -> Vec<Vec<[f64; 3]>> {
    let record = &file.surfaces[surface];
    let start = |ring: usize| ring.checked_sub(1).map_or(0, |before| file.ring_ends[before] as usize);
    let rings = record.first_ring as usize..(record.first_ring + record.ring_count) as usize;
    let corners = |ring: usize| &file.corners[start(ring)..file.ring_ends[ring] as usize];
    rings.map(|ring| corners(ring).iter().map(|&corner| file.positions[corner as usize]).collect()).collect()
}

/// Least and greatest coordinates of what bounds objects.
pub fn extent(file: &SurfaceFile) -> ([f64; 3], [f64; 3]) {
    let used = (0..file.surfaces.len()).flat_map(|surface| rings(file, surface)).flatten();
    used.fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), position| {
        ([0, 1, 2].map(|axis| position[axis].min(low[axis])), [0, 1, 2].map(|axis| position[axis].max(high[axis])))
    })
}

/// Six times the volume that each shell encloses, by its number; positive where its surfaces look outwards.
pub fn volumes(file: &SurfaceFile) -> Vec<f64> {
    let mut volumes = Vec::new();
    for (surface, record) in file.surfaces.iter().enumerate() {
        let Some(shell) = record.shell else { continue };
        volumes.resize(volumes.len().max(shell as usize + 1), 0.0);
        for ring in rings(file, surface) {
            let origin = file.positions[0];
            let corner = |at: usize| nalgebra::Vector3::from([0, 1, 2].map(|axis| ring[at][axis] - origin[axis]));
            let fan = (1..ring.len() - 1).map(|at| corner(0).dot(&corner(at).cross(&corner(at + 1))));
            volumes[shell as usize] += fan.sum::<f64>();
        }
    }
    volumes
}

/// What every file must hold to, whatever was in it.
pub fn assert_sound(file: &SurfaceFile) {
    assert!(file.positions.iter().flatten().all(|value| value.is_finite()));
    assert!(file.ring_ends.is_sorted());
    assert_eq!(file.ring_ends.last().map_or(0, |&end| end as usize), file.corners.len());
    assert!(file.corners.iter().all(|&corner| (corner as usize) < file.positions.len()));
    for (surface, record) in file.surfaces.iter().enumerate() {
        assert!((record.object as usize) < file.objects.len());
        assert!(record.ring_count > 0 && (record.first_ring + record.ring_count) as usize <= file.ring_ends.len());
        assert!(rings(file, surface).iter().all(|ring| ring.len() >= 3));
    }
    for object in &file.objects {
        assert!(object.parent.is_none_or(|parent| (parent as usize) < file.objects.len()));
    }
    assert!(file.skipped.iter().all(|skipped| skipped.count > 0));
}
