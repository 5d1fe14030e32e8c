//! Where a cloud lies, and how large it is.

use crate::geometry::Point3;
use crate::robust::{median, quantile};

/// Share of the points that a cloud's radius holds: the rest is sky and mismatches.
const HELD: f64 = 0.98;

/// Middle and size of a cloud.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Median of the points along each axis.
    pub center: Point3<f64>,
    /// Holds 98 % of the points.
    pub radius: f64,
}

impl Extent {
    pub fn of(points: &[Point3<f64>]) -> Extent {
        let center = median_point(points.iter()).unwrap_or_else(Point3::origin);
        let mut distances: Vec<f64> = points.iter().map(|p| (p - center).norm()).collect();
        Extent { center, radius: quantile(&mut distances, HELD).filter(|r| *r > 0.0).unwrap_or(1.0) }
    }
}

/// Median along each axis.
pub(super) fn median_point<'a>(points: impl Iterator<Item = &'a Point3<f64>> + Clone) -> Option<Point3<f64>> {
    let mut center = Point3::origin();
    for axis in 0..3 {
        let mut values: Vec<f64> = points.clone().map(|p| p[axis]).collect();
        center[axis] = median(&mut values)?;
    }
    Some(center)
}

#[cfg(test)]
mod tests;
