//! What shared photographs say about two parts: point pairs at the same pixels, camera poses, points on planes.

use std::collections::BTreeMap;

use super::Part;
use super::links::{SharedPhoto, pixel_scale, same_keypoints, tolerance_px};
use super::sigma::{covariance, extent, focal_px, median};
use crate::geometry::{Matrix3, Point3, Rotation3, Similarity};
use crate::reconstruction::{PointIndex, Reconstruction};

/// The same spot as both parts have it.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub in_a: Point3<f64>,
    pub in_b: Point3<f64>,
    pub covariance_a: Matrix3<f64>,
    pub covariance_b: Matrix3<f64>,
}

/// The same camera as both parts have it.
#[derive(Clone, Debug)]
pub(super) struct CameraPair {
    pub center_a: Point3<f64>,
    pub center_b: Point3<f64>,
    pub a_from_b_rotation: Rotation3<f64>,
    /// Viewing direction, a's frame.
    pub axis_a: nalgebra::Vector3<f64>,
    /// Difference of the focal lengths, as a share: depth is as uncertain as this.
    pub focal_doubt: f64,
    /// Median distance of what it shows, a's frame.
    pub depth_a: f64,
    /// Median ratio of depths along the same rays, a's units per b's.
    pub scale: Option<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct Evidence {
    pub photos: Vec<SharedPhoto>,
    pub pairs: Vec<Pair>,
    pub cameras: Vec<CameraPair>,
    /// Coincidences of keypoints that chance alone would give, measured by shifting one photograph over the other.
    pub chance: f64,
    /// Keypoints with points in the shared photographs, of the part that has fewer.
    pub fewer_keypoints: usize,
    pub radius_a: f64,
    /// Median error, in shares of the width, with which each part explains its own keypoints in the shared photographs.
    pub own_error: [f64; 2],
}

/// Shifts that measure chance, in units of the tolerance: far enough that no keypoint meets itself.
const CHANCE_SHIFTS: [[f64; 2]; 8] =
    [[9.0, 0.0], [-9.0, 0.0], [0.0, 9.0], [0.0, -9.0], [13.0, 13.0], [-13.0, 13.0], [13.0, -13.0], [-13.0, -13.0]];

pub(super) fn gather(a: &Part, b: &Part, photos: Vec<SharedPhoto>) -> Evidence {
    let (a, b) = (&a.sfm, &b.sfm);
    let (radius_a, radius_b) = (extent(&a.points).1, extent(&b.points).1);
    let mut couples: BTreeMap<(PointIndex, PointIndex), ()> = BTreeMap::new();
    let mut cameras = Vec::new();
    let mut chance = 0.0;
    let mut counts = [0usize; 2];
    let has_point = |o: &crate::reconstruction::Observation| o.point.is_some();
    for photo in &photos {
        let (image_a, image_b) = (&a.images[photo.in_a.0 as usize], &b.images[photo.in_b.0 as usize]);
        let (scale, tolerance) = (pixel_scale(a, b, photo), tolerance_px(a, photo));
        let link = |shift: [f64; 2]| {
            same_keypoints(&image_a.observations, &image_b.observations, scale, shift, tolerance, &has_point)
        };
        let links: Vec<_> = link([0.0; 2])
            .into_iter()
            .filter_map(|(i, j)| {
                Some((image_a.observations[i as usize].point?, image_b.observations[j as usize].point?))
            })
            .collect();
        let shifted: usize = CHANCE_SHIFTS.iter().map(|s| link(s.map(|v| v * tolerance)).len()).sum();
        chance += shifted as f64 / CHANCE_SHIFTS.len() as f64;
        counts[0] += image_a.observations.iter().filter(|o| has_point(o)).count();
        counts[1] += image_b.observations.iter().filter(|o| has_point(o)).count();
        cameras.push(camera_pair(a, b, photo, &links));
        couples.extend(links.into_iter().map(|couple| (couple, ())));
    }
    let pairs = couples.into_keys().map(|(pa, pb)| Pair {
        in_a: a.points[pa.0 as usize],
        in_b: b.points[pb.0 as usize],
        covariance_a: covariance(a, pa, radius_a),
        covariance_b: covariance(b, pb, radius_b),
    });
    let own_error = [own_error(a, &photos, |p| p.in_a), own_error(b, &photos, |p| p.in_b)];
    Evidence {
        pairs: pairs.collect(),
        cameras,
        chance,
        fewer_keypoints: counts[0].min(counts[1]),
        radius_a,
        own_error,
        photos,
    }
}

fn camera_pair(
    a: &Reconstruction,
    b: &Reconstruction,
    photo: &SharedPhoto,
    links: &[(PointIndex, PointIndex)],
) -> CameraPair {
    let (image_a, image_b) = (&a.images[photo.in_a.0 as usize], &b.images[photo.in_b.0 as usize]);
    let (center_a, center_b) = (image_a.center(), image_b.center());
    let relative_focal = |r: &Reconstruction, image| {
        let camera = r.camera_of(image);
        focal_px(camera) / camera.width_px.max(1) as f64
    };
    let ratio = relative_focal(a, photo.in_a) / relative_focal(b, photo.in_b);
    let depth = |r: &Reconstruction, p: PointIndex, center: &Point3<f64>| (r.points[p.0 as usize] - center).norm();
    let ratios = links.iter().map(|(pa, pb)| depth(a, *pa, &center_a) / depth(b, *pb, &center_b));
    let mut ratios: Vec<f64> = ratios.filter(|v| v.is_finite() && *v > 0.0).collect();
    let seen = image_a.observations.iter().filter_map(|o| o.point);
    let mut depths: Vec<f64> = seen.map(|p| depth(a, p, &center_a)).collect();
    let a_from_cam = image_a.cam_from_sfm_rotation.inverse();
    CameraPair {
        center_a,
        center_b,
        a_from_b_rotation: a_from_cam * image_b.cam_from_sfm_rotation,
        axis_a: a_from_cam * nalgebra::Vector3::z(),
        focal_doubt: ratio.ln().abs(),
        depth_a: median(&mut depths).unwrap_or(1.0),
        scale: median(&mut ratios),
    }
}

impl CameraPair {
    /// Where this camera alone puts the second part.
    pub fn a_from_b(&self) -> Option<Similarity> {
        let rotation = self.a_from_b_rotation;
        Some(Similarity::about(&self.center_b, &self.center_a, self.scale?, rotation))
    }
}

fn own_error(
    r: &Reconstruction,
    photos: &[SharedPhoto],
    image_of: impl Fn(&SharedPhoto) -> crate::reconstruction::ImageIndex,
) -> f64 {
    let mut errors = Vec::new();
    for photo in photos {
        let index = image_of(photo);
        let (image, camera) = (&r.images[index.0 as usize], r.camera_of(index));
        let width = camera.width_px.max(1) as f64;
        for o in &image.observations {
            let Some(point) = o.point else { continue };
            let pixel = camera.project(&image.cam_from_sfm(&r.points[point.0 as usize]));
            errors.push(pixel.map_or(1.0, |[x, y]| (x - o.x_px).hypot(y - o.y_px) / width));
        }
    }
    median(&mut errors).unwrap_or(0.0)
}
