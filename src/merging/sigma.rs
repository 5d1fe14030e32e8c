//! How well a point is known: its covariance from the rays that meet in it.
//!
//! Each ray holds the point across itself, with the focal length over the distance as pixels per unit of length; the sum of
//! these informations is that of linear triangulation (Hartley and Zisserman 2004, chapter 12).

use crate::geometry::{Camera, CameraModel, Matrix3, Point3};
use crate::reconstruction::{ImageIndex, PointIndex, Reconstruction};

/// One sigma of a keypoint, pixels: detectors reach a third to a half, reconstructions leave about one.
const KEYPOINT_SIGMA_PX: f64 = 1.0;
/// Nothing is known worse than this share of the cloud's radius: keeps points on nearly parallel rays finite.
const WORST_SHARE: f64 = 1.0;

/// Pixels per radian near the axis.
pub(super) fn focal_px(camera: &Camera) -> f64 {
    match camera.model {
        CameraModel::Equirectangular => camera.width_px as f64 / std::f64::consts::TAU,
        _ => camera.params.first().copied().unwrap_or(1.0).abs().max(1.0),
    }
}

/// Covariance of a point in its reconstruction's frame.
pub(super) fn covariance(sfm: &Reconstruction, point: PointIndex, radius: f64) -> Matrix3<f64> {
    covariance_in(sfm, sfm.track(point), point, radius)
}

/// The same in the frame of `posed`, whose tracks may be kept elsewhere.
pub(super) fn covariance_in(
    posed: &Reconstruction,
    track: &[(ImageIndex, u32)],
    point: PointIndex,
    radius: f64,
) -> Matrix3<f64> {
    let x = &posed.points[point.0 as usize];
    let mut information = Matrix3::identity() * (WORST_SHARE * radius).powi(-2);
    for (image, _) in track {
        let ray = x - posed.images[image.0 as usize].center();
        let distance = ray.norm();
        if distance <= 0.0 || distance.is_nan() {
            continue;
        }
        let direction = ray / distance;
        let per_unit = focal_px(posed.camera_of(*image)) / (distance * KEYPOINT_SIGMA_PX);
        information += (Matrix3::identity() - direction * direction.transpose()) * per_unit.powi(2);
    }
    information.try_inverse().unwrap_or_else(|| Matrix3::identity() * radius.powi(2))
}

/// Median centre of the points, and the radius that holds 98 % of them: the rest is sky and mismatches.
pub(super) fn extent(points: &[Point3<f64>]) -> (Point3<f64>, f64) {
    let mut center = Point3::origin();
    for axis in 0..3 {
        let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        center[axis] = median(&mut values).unwrap_or(0.0);
    }
    let mut distances: Vec<f64> = points.iter().map(|p| (p - center).norm()).collect();
    (center, quantile(&mut distances, 0.98).filter(|r| *r > 0.0).unwrap_or(1.0))
}

pub(super) fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

pub(super) fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let rank = ((share * last as f64).round() as usize).min(last);
    Some(*values.select_nth_unstable_by(rank, f64::total_cmp).1)
}
