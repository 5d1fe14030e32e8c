//! From where each point was seen: which way is outside, and which cameras to trace lines of sight to.

use crate::geometry::{Point3, Vector3};
use crate::reconstruction::{PointIndex, Reconstruction};

/// For each supporting point the sum of the directions to the cameras that saw it (or a copy of it), or of the file's own
/// normals; zero where neither is known.
pub(super) fn outward_hints(
    r: &Reconstruction,
    slots: &[Option<u32>],
    points: &[Point3<f64>],
    cameras: &[Point3<f64>],
) -> Vec<Vector3<f64>> {
    let mut hints = vec![Vector3::zeros(); points.len()];
    for (i, slot) in slots.iter().enumerate() {
        let Some(slot) = slot.map(|s| s as usize) else { continue };
        if r.images.is_empty() {
            hints[slot] += r.normals.get(i).copied().unwrap_or_default();
        }
        for (image, _) in r.seen_by(PointIndex(i as u32)) {
            let to_camera = cameras[image.0 as usize] - points[slot];
            hints[slot] += to_camera.try_normalize(0.0).unwrap_or_default();
        }
    }
    hints
}

/// For each supporting point the nearest and the farthest of the cameras that saw it or a copy of it.
pub(super) fn viewers(
    r: &Reconstruction,
    slots: &[Option<u32>],
    points: &[Point3<f64>],
    cameras: &[Point3<f64>],
) -> Vec<[Option<u32>; 2]> {
    let mut viewers = vec![[None; 2]; points.len()];
    for (i, slot) in slots.iter().enumerate() {
        let Some(slot) = slot.map(|s| s as usize) else { continue };
        let distance = |camera: u32| (cameras[camera as usize] - points[slot]).norm_squared();
        let [nearest, farthest]: &mut [Option<u32>; 2] = &mut viewers[slot];
        for &(image, _) in r.seen_by(PointIndex(i as u32)) {
            if nearest.is_none_or(|n| distance(image.0) < distance(n)) {
                *nearest = Some(image.0);
            }
            if farthest.is_none_or(|f| distance(image.0) >= distance(f)) {
                *farthest = Some(image.0);
            }
        }
    }
    viewers.into_iter().map(|[nearest, farthest]| [nearest, farthest.filter(|_| farthest != nearest)]).collect()
}
