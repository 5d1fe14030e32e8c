//! What shared photographs say about two parts: point pairs at the same pixels, camera poses.

use std::collections::BTreeSet;

use crate::geometry::{Matrix3, Point3, Rotation3, Similarity, Vector3};
use crate::merging::limits::MergeLimits;
use crate::merging::point_covariance::focal_px;
use crate::merging::prepared::PreparedPart;
use crate::merging::shared_photos::{PixelMap, SharedPhoto};
use crate::reconstruction::{ImageIndex, Observation, PointIndex, Reconstruction};
use crate::robust::median;

/// The same spot as both parts have it.
#[derive(Clone, Debug)]
pub(super) struct PointPair {
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
    pub axis_a: Vector3<f64>,
    /// Difference of the focal lengths, as a share: depth is as uncertain as this.
    pub focal_doubt: f64,
    /// Median distance of what it shows, a's frame.
    pub depth_a: f64,
    /// Median ratio of depths along the same rays, a's units per b's.
    pub scale: Option<f64>,
}

/// All of it.
#[derive(Clone, Debug)]
pub(super) struct SharedTracks {
    pub photos: Vec<SharedPhoto>,
    pub pairs: Vec<PointPair>,
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

/// Tracks of two points of one photograph that meet in a keypoint.
type Match = (PointIndex, PointIndex);

/// Gathers what the photographs say.
pub(super) fn shared_tracks(
    [a, b]: [&PreparedPart<'_>; 2],
    photos: Vec<SharedPhoto>,
    limits: &MergeLimits,
) -> SharedTracks {
    let sfms = [a.sfm(), b.sfm()];
    let (mut couples, mut cameras, mut chance) = (BTreeSet::new(), Vec::new(), 0.0);
    for photo in &photos {
        let pixels = PixelMap::of(sfms, [photo.in_a, photo.in_b], &limits.keypoints);
        let matches = matches(sfms, photo, &pixels);
        chance += chance_matches(sfms, photo, &pixels);
        cameras.push(camera_pair(sfms, photo, &matches));
        couples.extend(matches);
    }
    let pair = |(in_a, in_b): Match| {
        let (in_a, in_b) = (a.known_point(in_a), b.known_point(in_b));
        PointPair { in_a: in_a.at, in_b: in_b.at, covariance_a: in_a.covariance, covariance_b: in_b.covariance }
    };
    let keypoints = |sfm: &Reconstruction, image_of: fn(&SharedPhoto) -> ImageIndex| {
        photos.iter().flat_map(|p| &sfm.images[image_of(p).0 as usize].observations).filter(|o| has_point(o)).count()
    };
    SharedTracks {
        pairs: couples.into_iter().map(pair).collect(),
        cameras,
        chance,
        fewer_keypoints: keypoints(sfms[0], |p| p.in_a).min(keypoints(sfms[1], |p| p.in_b)),
        radius_a: a.extent.radius,
        own_error: [own_error(sfms[0], &photos, |p| p.in_a), own_error(sfms[1], &photos, |p| p.in_b)],
        photos,
    }
}

fn has_point(o: &Observation) -> bool {
    o.point.is_some()
}

fn matches([a, b]: [&Reconstruction; 2], photo: &SharedPhoto, pixels: &PixelMap) -> Vec<Match> {
    let in_a = &a.images[photo.in_a.0 as usize].observations;
    let in_b = &b.images[photo.in_b.0 as usize].observations;
    let found = pixels.same_keypoints(in_a, in_b, &has_point).into_iter();
    found.filter_map(|(i, j)| Some((in_a[i as usize].point?, in_b[j as usize].point?))).collect()
}

/// Mean number of coincidences where one photograph is shifted over the other.
fn chance_matches(sfms: [&Reconstruction; 2], photo: &SharedPhoto, pixels: &PixelMap) -> f64 {
    let shifted = |by: &[f64; 2]| PixelMap { shift: by.map(|v| v * pixels.tolerance), ..*pixels };
    let found: usize = CHANCE_SHIFTS.iter().map(|by| matches(sfms, photo, &shifted(by)).len()).sum();
    found as f64 / CHANCE_SHIFTS.len() as f64
}

fn camera_pair([a, b]: [&Reconstruction; 2], photo: &SharedPhoto, matches: &[Match]) -> CameraPair {
    let (image_a, image_b) = (&a.images[photo.in_a.0 as usize], &b.images[photo.in_b.0 as usize]);
    let (center_a, center_b) = (image_a.center(), image_b.center());
    let relative_focal = |r: &Reconstruction, image| {
        let camera = r.camera_of(image);
        focal_px(camera) / camera.width_px.max(1) as f64
    };
    let ratio = relative_focal(a, photo.in_a) / relative_focal(b, photo.in_b);
    let depth = |r: &Reconstruction, p: PointIndex, center: &Point3<f64>| (r.points[p.0 as usize] - center).norm();
    let ratios = matches.iter().map(|(pa, pb)| depth(a, *pa, &center_a) / depth(b, *pb, &center_b));
    let mut ratios: Vec<f64> = ratios.filter(|v| v.is_finite() && *v > 0.0).collect();
    let seen = image_a.observations.iter().filter_map(|o| o.point);
    let mut depths: Vec<f64> = seen.map(|p| depth(a, p, &center_a)).collect();
    let a_from_cam = image_a.cam_from_sfm_rotation.inverse();
    CameraPair {
        center_a,
        center_b,
        a_from_b_rotation: a_from_cam * image_b.cam_from_sfm_rotation,
        axis_a: a_from_cam * Vector3::z(),
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

/// Median distance of keypoints from the points that they see, as a share of the width.
fn own_error(r: &Reconstruction, photos: &[SharedPhoto], image_of: impl Fn(&SharedPhoto) -> ImageIndex) -> f64 {
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
