//! What a problem must have so that its pose is determined.
//!
//! ```text
//! Problem     tell the problems that have isolated poses from those that leave some motion free
//! Method      1. Structural tests before solving, in the order of `Degeneracy`: numbers of rows, planes, directions, points.
//!             2. At a pose: the motion x -> x + rho (omega x y + tau + sigma y) about the centroid of the images (y: their
//!                coordinates over their spread rho) changes row r by rho J_r (omega, tau, sigma) with
//!                J_r = [ y_r x n_r,  n_r,  n_r . y_r ]; for a known vertical u the first three become (y_r x n_r) . u.
//!                condition = smallest / largest singular value of J. It depends neither on origins nor on units nor on
//!                the senses of normals, and is 0 exactly where the pose is not isolated to first order. An error eta in
//!                the rows moves the pose by at most about sqrt(m) eta / (rho sigma_min).
//!             3. J at one arbitrary rotation: what is free there is free at every pose.
//!             4. Three quadrics that share a curve leave a motion free as well (algebra/macaulay.rs).
//! Thresholds  condition below `NOT_ISOLATED` = 1e-10 is refused: it is what rounding of 1e-16 leaves of a double solution
//!             after polishing, with room; random scenes come below 1e-5 once in a thousand
//! Source      mathematics.md section 10
//! Tests       golden/degenerate.json; tests/solver_problems/
//! ```

use super::jacobian::singular_of;
use crate::geometry::{Matrix3, Vector3, distance_derivative};
use crate::solvers::row::Row;
use crate::solvers::sought::Sought;

/// Condition below which a pose is not isolated.
pub const NOT_ISOLATED: f64 = 1e-10;

/// Condition below which a pose is determined, but weakly: an error of the rows is multiplied by a thousand.
pub const WEAK: f64 = 1e-3;

/// Why a problem has no isolated pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Degeneracy {
    #[error("too few pairs ({rows} different ones, {unknowns} are needed)")]
    TooFewRows { rows: usize, unknowns: usize },
    #[error("fewer than 3 planes")]
    TooFewPlanes,
    #[error("parallel planes (fewer than three directions)")]
    ParallelPlanes,
    #[error("normals in one plane")]
    CoplanarNormals,
    #[error("the points coincide")]
    OnePoint,
    #[error("the planes meet in one point, the scale is free")]
    ConcurrentPlanes,
    #[error("more than three points on one plane")]
    CrowdedPlane,
    #[error("collinear points on one plane")]
    CollinearPoints,
    #[error("some motion is free at every pose")]
    FreeMotion,
    #[error("the heading is free")]
    FreeHeading,
    #[error("the solutions are not isolated")]
    NotIsolated,
}

/// Smallest over largest singular value of the Jacobian (14) for images `y` in units of their spread about their centroid.
pub fn condition(sought: &Sought, images: &[Vector3<f64>], normals: &[Vector3<f64>]) -> f64 {
    let singular = singular_of(sought, images.iter().zip(normals).map(|(y, n)| distance_derivative(y, n)));
    if images.len() < sought.unknowns() || !(singular.largest() > 0.0) {
        return 0.0;
    }
    singular.smallest() / singular.largest()
}

/// The condition of a pose for rows in any units: what `solve` reports, for callers with poses of their own.
pub fn condition_at(sought: &Sought, rows: &[Row], scale: f64, rotation: &Matrix3<f64>) -> f64 {
    let mut images: Vec<Vector3<f64>> = rows.iter().map(|row| scale * (rotation * row.point)).collect();
    let mean = images.iter().sum::<Vector3<f64>>() / images.len().max(1) as f64;
    let spread_sq = images.iter().map(|x| (x - mean).norm_squared()).sum::<f64>() / images.len().max(1) as f64;
    if !(spread_sq > 0.0) {
        return 0.0;
    }
    images.iter_mut().for_each(|x| *x = (*x - mean) / spread_sq.sqrt());
    let normals: Vec<Vector3<f64>> = rows.iter().map(|row| row.normal / row.normal.norm()).collect();
    condition(sought, &images, &normals)
}

#[cfg(test)]
mod tests;
