//! How well a point is known: its covariance from the rays that meet in it.
//!
//! Each ray holds the point across itself, with the focal length over the distance as pixels per unit of length; the sum of
//! these informations is that of linear triangulation (Hartley and Zisserman 2004, chapter 12).

use super::pair_limits::KeypointLimits;
use crate::geometry::{Camera, CameraModel, Matrix3, Point3};
use crate::reconstruction::{ImageIndex, PointIndex, Reconstruction};

/// Nothing is known worse than this share of the cloud's radius: keeps points on nearly parallel rays finite.
const WORST_SHARE: f64 = 1.0;

/// Pixels per radian near the axis.
pub(super) fn focal_px(camera: &Camera) -> f64 {
    match camera.model {
        CameraModel::Equirectangular => camera.width_px as f64 / std::f64::consts::TAU,
        _ => camera.params.first().copied().unwrap_or(1.0).abs().max(1.0),
    }
}

/// A point and how well it is known, in its part's frame.
#[derive(Clone, Debug)]
pub(super) struct KnownPoint {
    pub at: Point3<f64>,
    pub covariance: Matrix3<f64>,
}

/// Covariance of a point in the frame of `posed`, whose tracks may be kept elsewhere.
pub(super) fn covariance(
    posed: &Reconstruction,
    track: &[(ImageIndex, u32)],
    point: PointIndex,
    radius: f64,
    limits: &KeypointLimits,
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
        let per_unit = focal_px(posed.camera_of(*image)) / (distance * limits.sigma_px);
        information += (Matrix3::identity() - direction * direction.transpose()) * per_unit.powi(2);
    }
    information.try_inverse().unwrap_or_else(|| Matrix3::identity() * radius.powi(2))
}

#[cfg(test)]
mod tests;
