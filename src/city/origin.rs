//! The shift that keeps coordinates small.

use super::source::Source;
use crate::geometry::Vector3;

/// Rounds the origin, metres: a person recognises the coordinates, and whole numbers are subtracted without rounding.
const ORIGIN_STEP_M: f64 = 1.0;

/// Vertices looked at; the middle of a city need not be exact.
const SAMPLES: usize = 10_000;

/// The middle vertex of the source, axis by axis, in whole metres. The median, because one stray vertex at (0, 0, 0)
/// beside national-grid coordinates would drag a mean or the middle of a box far off.
pub(super) fn common_origin(source: &Source) -> Vector3<f64> {
    let step = source.corners.len().div_ceil(SAMPLES).max(1);
    let median = |axis: usize| {
        let corners = source.corners.iter().step_by(step);
        let mut values: Vec<f64> = corners.map(|&vertex| source.positions[vertex as usize][axis]).collect();
        let middle = values.len() / 2;
        let value = values.select_nth_unstable_by(middle, f64::total_cmp).1;
        (*value / ORIGIN_STEP_M).round() * ORIGIN_STEP_M + 0.0
    };
    if source.corners.is_empty() { Vector3::zeros() } else { Vector3::new(median(0), median(1), median(2)) }
}
