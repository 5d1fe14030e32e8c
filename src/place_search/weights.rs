//! What each wall of the cloud says of a pose.
//!
//! Question     how many independent looks is a wall worth at a scale?
//! Method       a look every two metres of it. Walls that can lie on one wall of the city together share that wall's looks: a front in
//!              pieces, storeys above each other, and under a small scale all that is parallel. Less than one look weighs as such and
//!              not by its root, so that a cloud that shrinks weighs nothing

use super::cloud_walls::{CloudWall, is_parallel};
use crate::limits::PlaceSearchLimits;

/// Walls that differ by less than this are parallel, degrees: a class of direction.
const PARALLEL_DEG: f64 = 10.0;

/// The weight of each wall at a scale: the root of its looks.
pub fn weights(walls: &[CloudWall], scale: f64, limits: &PlaceSearchLimits) -> Vec<f64> {
    let together = 2.0 * limits.near_wall_m / scale;
    let weight = |wall: &CloudWall| {
        let looks_of = |length: f64| (length * scale / limits.metres_of_look).min(limits.most_looks);
        let line = Line::of(wall, walls, together);
        let looks = looks_of(wall.length).min(looks_of(line.extent) * wall.length / line.length);
        if looks < 1.0 { looks } else { looks.sqrt() }
    };
    walls.iter().map(weight).collect()
}

/// The walls in the line of one.
struct Line {
    /// Of all of them together.
    length: f64,
    /// From the first end to the last.
    extent: f64,
}

impl Line {
    fn of(wall: &CloudWall, walls: &[CloudWall], across: f64) -> Line {
        let (mut length, mut from, mut to) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        for other in walls {
            let off = [0, 1].map(|k| other.middle[k] - wall.middle[k]);
            let dot = |axis: [f64; 2]| off[0] * axis[0] + off[1] * axis[1];
            if dot(wall.normal).abs() <= across && is_parallel(wall, other, PARALLEL_DEG) {
                length += other.length;
                from = from.min(dot(wall.along()) - other.length / 2.0);
                to = to.max(dot(wall.along()) + other.length / 2.0);
            }
        }
        Line { length: length.max(f64::MIN_POSITIVE), extent: to - from }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(x: f64, y: f64, length: f64) -> CloudWall {
        CloudWall { middle: [x, y], normal: [0.0, 1.0], sided: true, length, bottom: 0.0, top: 1.0, points: 50 }
    }

    #[test]
    fn a_wall_weighs_the_root_of_its_looks_and_as_such_below_one() {
        let weights = |scale: f64| weights(&[wall(0.0, 0.0, 1.0)], scale, &PlaceSearchLimits::default())[0];
        assert_eq!([weights(18.0), weights(1.0), weights(1e3)], [3.0, 0.5, 4.0]);
    }

    #[test]
    fn walls_that_can_lie_on_one_wall_share_its_looks() {
        let limits = PlaceSearchLimits::default();
        // Ten metres each: over each other, behind each other by 3 m, and beside each other.
        let [stacked, behind] = [0.0, 3.0].map(|y| weights(&[wall(0.0, 0.0, 10.0), wall(0.0, y, 10.0)], 1.0, &limits));
        assert_eq!((stacked[0].powi(2).round(), behind[0].powi(2).round()), (3.0, 5.0));
        let beside = weights(&[wall(0.0, 0.0, 10.0), wall(10.0, 0.0, 10.0)], 1.0, &limits);
        assert!((beside[0].powi(2) - 5.0).abs() < 1e-9);
        // A tenth of the size brings those behind onto one wall.
        assert!(weights(&[wall(0.0, 0.0, 100.0), wall(0.0, 3.0, 100.0)], 0.1, &limits)[0] < behind[0]);
    }
}
