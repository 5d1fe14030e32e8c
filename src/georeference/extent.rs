//! Where a cloud is, and how large.

use crate::geometry::Point3;
use crate::robust::quantile;

/// The share of points that counts as the cloud: some lie anywhere.
const MOST: f64 = 0.95;

/// The median of each coordinate.
pub(super) fn middle(points: &[Point3<f64>]) -> Point3<f64> {
    let of = |k: usize| {
        let mut values: Vec<f64> = points.iter().map(|p| p[k]).collect();
        quantile(&mut values, 0.5).unwrap_or(0.0)
    };
    Point3::new(of(0), of(1), of(2))
}

/// Within which most points lie about their middle, sfm units.
pub(super) fn radius(points: &[Point3<f64>], middle: &Point3<f64>) -> f64 {
    within_which(points, middle, MOST)
}

/// Within which a share of the points lies about their middle, sfm units.
pub(super) fn within_which(points: &[Point3<f64>], middle: &Point3<f64>, share: f64) -> f64 {
    let mut offsets: Vec<f64> = points.iter().map(|p| (p - middle).norm()).collect();
    quantile(&mut offsets, share).unwrap_or(0.0)
}
