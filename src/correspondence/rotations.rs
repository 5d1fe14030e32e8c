//! Rotations that lay one direction, or two, onto others.

use nalgebra::Matrix3;

use crate::geometry::Vector3;

/// Sum and difference of normals shorter than this have no direction.
const SMALLEST_BISECTOR: f64 = 1e-3;

/// The turn about up that leads one normal to the azimuth of another.
pub(super) fn about_up_from(from: &Vector3<f64>, to: &Vector3<f64>) -> Matrix3<f64> {
    let lengths = from.xy().norm() * to.xy().norm();
    let (cos, sin) = (from.xy().dot(&to.xy()) / lengths, from.xy().perp(&to.xy()) / lengths);
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// The turn by a heading.
pub(super) fn about_up(heading_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = heading_rad.sin_cos();
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// Sum and difference of two unit vectors, and what stands across both: axes at right angles. Laying such axes onto each other
/// lays one pair of vectors onto another and divides evenly what their angles differ.
pub(super) fn bisectors(a: &Vector3<f64>, b: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let (sum, difference) = ((a + b).try_normalize(SMALLEST_BISECTOR)?, (a - b).try_normalize(SMALLEST_BISECTOR)?);
    Some(Matrix3::from_columns(&[sum, difference, sum.cross(&difference)]))
}

#[cfg(test)]
mod tests;
