//! Linear least squares: the method that the paper compares with.
//!
//! ```text
//! Problem     rigid pose from many points on planes, without any trigonometry
//! Given       12 or more rows on four or more planes
//! Unknowns    the twelve numbers of x = A p + t, as if A were any matrix
//! Equations   n . (A p + t) + d = 0
//! Method      1. Least squares for A and t by singular values; freedoms that the rows do not hold stay zero.
//!             2. The rotation nearest to A. 3. t again, for that rotation.
//! Solutions   1
//! Degenerate  three planes: points of one plane are coplanar, so a plane contributes rank 3 at most and three planes
//!             9 of 12, however many points. The answer is then arbitrary: `rank` tells
//! Scaling     points about their centroid in units of their spread
//! Source      Ramalingam et al. 2010, section 5; mathematics.md section 11
//! Cost        not measured; it is a baseline
//! Tests       below; examples/figure4.rs
//! ```

use crate::geometry::{Matrix3, Similarity, Vector3, nearest_rotation};

use super::algebra::singular::Singular;
use super::row::{Row, centroid};

/// Singular values below this, relative to the largest, count as zero.
const NO_INFORMATION: f64 = 1e-10;

/// A rigid pose, and how many of the twelve numbers the rows determine.
#[derive(Clone, Copy, Debug)]
pub struct LinearFit {
    pub object_from_sensor: Similarity,
    pub rank: usize,
}

/// `None` for fewer rows than unknowns, and where A has no nearest rotation.
pub fn linear_least_squares(rows: &[Row]) -> Option<LinearFit> {
    if rows.len() < 12 {
        return None;
    }
    let count = rows.len() as f64;
    let centroid = centroid(rows);
    let spread_sq = rows.iter().map(|row| (row.point - centroid).norm_squared()).sum::<f64>() / count;
    if !(spread_sq > 0.0) {
        return None;
    }
    let spread = spread_sq.sqrt();
    let equations: Vec<[f64; 12]> = rows
        .iter()
        .map(|row| {
            let (n, p) = (row.normal, (row.point - centroid) / spread);
            std::array::from_fn(|k| if k < 9 { n[k / 3] * p[k % 3] } else { n[k - 9] })
        })
        .collect();
    let right: Vec<f64> = rows.iter().map(|row| -row.offset).collect();
    let singular = Singular::of(&equations);
    let rank = singular.sorted().iter().filter(|&&s| s > NO_INFORMATION * singular.largest()).count();
    let x = singular.least_squares(&right, NO_INFORMATION);
    let rotation = nearest_rotation(&Matrix3::from_fn(|i, j| x[3 * i + j] / spread))?;
    let normals: Vec<[f64; 3]> = rows.iter().map(|row| row.normal.into()).collect();
    let heights: Vec<f64> =
        rows.iter().map(|row| -row.offset - row.normal.dot(&(rotation * (row.point - centroid)))).collect();
    let image = Vector3::from_vec(Singular::of(&normals).least_squares(&heights, NO_INFORMATION));
    Some(LinearFit { object_from_sensor: Similarity::about(&centroid.into(), &image.into(), 1.0, rotation), rank })
}

#[cfg(test)]
mod tests;
