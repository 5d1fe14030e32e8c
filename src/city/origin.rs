//! The shift that keeps coordinates small.

use super::source::Source;
use crate::geometry::{Point3, Vector3};

/// Rounds the origin, metres: a person recognises the coordinates, and whole numbers are subtracted without rounding.
const ORIGIN_STEP_M: f64 = 1.0;

/// Vertices looked at; the middle of a city need not be exact.
const SAMPLES: usize = 10_000;

/// The middle vertex of the source, axis by axis, in whole metres. The median, because one stray vertex at (0, 0, 0)
/// beside national-grid coordinates would drag a mean or the middle of a box far off.
pub(super) fn common_origin(source: &Source) -> Vector3<f64> {
    let corners = source.corners.iter().step_by(sample_step(source.corners.len()));
    origin_of(&corners.map(|&vertex| source.positions[vertex as usize]).collect::<Vec<_>>())
}

/// Of so many corners every so-manieth is looked at.
pub(super) fn sample_step(corners: usize) -> usize {
    corners.div_ceil(SAMPLES).max(1)
}

/// The origin by the corners that are looked at.
pub(super) fn origin_of(corners: &[Point3<f64>]) -> Vector3<f64> {
    let median = |axis: usize| {
        let mut values: Vec<f64> = corners.iter().map(|corner| corner[axis]).collect();
        let middle = values.len() / 2;
        let value = values.select_nth_unstable_by(middle, f64::total_cmp).1;
        (*value / ORIGIN_STEP_M).round() * ORIGIN_STEP_M + 0.0
    };
    if corners.is_empty() { Vector3::zeros() } else { Vector3::new(median(0), median(1), median(2)) }
}
