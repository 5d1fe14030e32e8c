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

#[cfg(test)]
mod tests {
    use super::*;

    fn line(values: impl IntoIterator<Item = f64>) -> Vec<Point3<f64>> {
        values.into_iter().map(|x| Point3::new(x, 2.0 * x, -x)).collect()
    }

    #[test]
    fn is_the_middle_corner_in_whole_metres() {
        assert_eq!(origin_of(&line([90_851.4, 90_853.0, 90_852.6])), Vector3::new(90_853.0, 181_705.0, -90_853.0));
        assert_eq!(origin_of(&[]), Vector3::zeros());
    }

    #[test]
    fn a_few_corners_far_off_do_not_drag_it() {
        let mut corners = line((0..99).map(|k| 450_000.0 + f64::from(k)));
        let before = origin_of(&corners);
        corners.extend(line([0.0, 0.0, 1e8]));
        assert!((origin_of(&corners) - before).norm() < 10.0);
    }

    #[test]
    fn never_has_the_sign_of_a_negative_zero() {
        let origin = origin_of(&line([-0.2, -0.1, -0.3]));
        assert!(origin.iter().all(|value| value.to_bits() == 0), "{origin}");
    }

    #[test]
    fn looks_at_no_more_corners_than_tell_something() {
        for corners in [0, 1, SAMPLES, SAMPLES + 1, 123_456_789] {
            let step = sample_step(corners);
            assert!(step >= 1 && corners.div_ceil(step) <= SAMPLES, "{corners} by {step}");
        }
    }
}
