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
//!             4. The quadrics times all quadratic monomials, a 30 x 35 matrix: its rank is 27 exactly where the three
//!                quadrics meet in points alone. A curve of common points makes the octic rounding noise, and noise may
//!                have no root; "no pose" would then be the wrong answer.
//! Thresholds  condition below `NOT_ISOLATED` = 1e-10 is refused: it is what rounding of 1e-16 leaves of a double solution
//!             after polishing, with room; random scenes come below 1e-5 once in a thousand
//! Source      mathematics.md section 10
//! Tests       golden/degenerate.json; tests/solver_problems.rs
//! ```

use super::forms::reduced;
use super::quadrics::Quadric;
use super::quaternion::MONOMIALS;
use super::singular::Singular;
use super::{Row, Sought};
use crate::geometry::{Matrix3, Vector3};

/// Condition below which a pose is not isolated.
pub const NOT_ISOLATED: f64 = 1e-10;

/// Condition below which a pose is determined, but weakly: an error of the rows is multiplied by a thousand.
pub const WEAK: f64 = 1e-3;

/// Singular value, relative to the largest, below which the Macaulay matrix has lost a rank.
const MACAULAY_RANK: f64 = 1e-12;

/// More rows than this are brought to triangular form before their singular values are taken: those of few are more exact without
/// it, those of many would take long.
const MANY_ROWS: usize = 64;

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
pub(super) fn condition(sought: &Sought, images: &[Vector3<f64>], normals: &[Vector3<f64>]) -> f64 {
    let jacobian = images.iter().zip(normals);
    match sought {
        Sought::Rigid => ratio(jacobian.map(|(y, n)| {
            let t = y.cross(n);
            [t.x, t.y, t.z, n.x, n.y, n.z]
        })),
        Sought::Similarity => ratio(jacobian.map(|(y, n)| {
            let t = y.cross(n);
            [t.x, t.y, t.z, n.x, n.y, n.z, n.dot(y)]
        })),
        Sought::UprightRigid(up) => ratio(jacobian.map(|(y, n)| [y.cross(n).dot(&up.in_object()), n.x, n.y, n.z])),
        Sought::UprightSimilarity(up) => {
            ratio(jacobian.map(|(y, n)| [y.cross(n).dot(&up.in_object()), n.x, n.y, n.z, n.dot(y)]))
        }
    }
}

fn ratio<const K: usize>(rows: impl Iterator<Item = [f64; K]>) -> f64 {
    let mut rows: Vec<[f64; K]> = rows.collect();
    if rows.len() > MANY_ROWS {
        rows = reduced(rows.into_iter());
    }
    let singular = Singular::of(&rows);
    if rows.len() < K || !(singular.largest() > 0.0) { 0.0 } else { singular.smallest() / singular.largest() }
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

/// Whether three quadrics meet in points alone, in complex projective space.
pub(super) fn meet_in_points(quadrics: &[Quadric; 3]) -> bool {
    let mut place = [[[[usize::MAX; 5]; 5]; 5]; 5];
    let mut count = 0;
    for a in 0..5 {
        for b in 0..5 - a {
            for c in 0..5 - a - b {
                place[a][b][c][4 - a - b - c] = count;
                count += 1;
            }
        }
    }
    // Columns of the transposed matrix: quadric times monomial; 35 rows, one for each monomial of degree 4.
    let mut rows = vec![[0.0; 30]; 35];
    for (k, quadric) in quadrics.iter().enumerate() {
        let size = quadric.iter().map(|v| v * v).sum::<f64>().sqrt();
        for (m, times) in MONOMIALS.iter().enumerate() {
            for (coefficient, of) in quadric.iter().zip(MONOMIALS) {
                let mut power = [0; 4];
                for i in [times.0, times.1, of.0, of.1] {
                    power[i] += 1;
                }
                let [a, b, c, d] = power;
                rows[place[a][b][c][d]][10 * k + m] += coefficient / size;
            }
        }
    }
    let sorted = Singular::of(&rows).sorted();
    sorted[26] > MACAULAY_RANK * sorted[0]
}
