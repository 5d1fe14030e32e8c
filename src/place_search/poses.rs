//! Poses in plan, and which of them are the same place.

use std::collections::HashMap;

use super::prior::wrapped;

/// Where the level frame stands in the city: `x_city = center + scale * turned(x_level)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanPose {
    pub center: [f64; 2],
    pub heading_rad: f64,
    /// Metres per sfm unit.
    pub scale: f64,
}

impl PlanPose {
    pub fn apply(&self, place: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.turned(place);
        [self.center[0] + self.scale * x, self.center[1] + self.scale * y]
    }

    /// A direction of the level frame in the city.
    pub fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.heading_rad.sin_cos();
        [cos * x - sin * y, sin * x + cos * y]
    }

    /// How far two poses set a cloud of this radius apart, metres: root of the squares of shift, turn and stretch at its rim.
    pub fn apart_m(&self, other: &PlanPose, radius: f64) -> f64 {
        let shift = (self.center[0] - other.center[0]).hypot(self.center[1] - other.center[1]);
        let turn = wrapped(self.heading_rad - other.heading_rad) * self.scale * radius;
        let stretch = (self.scale - other.scale) * radius;
        shift.hypot(turn).hypot(stretch)
    }
}

/// A pose with its score against chance.
#[derive(Clone, Copy, Debug)]
pub struct ScoredPose {
    pub pose: PlanPose,
    pub z: f64,
    /// By which whoever made it tells it from others.
    pub tag: u32,
}

/// The best of poses at distinct places, best first; of equal scores the one that stood first.
pub fn distinct(mut poses: Vec<ScoredPose>, keep: usize, apart_m: f64, radius: f64) -> Vec<ScoredPose> {
    poses.sort_by(|a, b| b.z.total_cmp(&a.z));
    let cell = |pose: &PlanPose| pose.center.map(|c| (c / apart_m).floor() as i64);
    let mut by_cell: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    let mut kept: Vec<ScoredPose> = Vec::new();
    for scored in poses {
        let [x, y] = cell(&scored.pose);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let mut near = around.filter_map(|c| by_cell.get(&c)).flatten();
        if near.any(|&other| kept[other].pose.apart_m(&scored.pose, radius) < apart_m) {
            continue;
        }
        by_cell.entry([x, y]).or_default().push(kept.len());
        kept.push(scored);
        if kept.len() == keep {
            break;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn drawn(random: &mut Random) -> ScoredPose {
        let mut draw = |width: f64| width * (random.unit() - 0.5);
        let pose = PlanPose { center: [draw(40.0), draw(40.0)], heading_rad: draw(6.0), scale: 2.0 + draw(1.0) };
        // Whole numbers, so that some are equal.
        ScoredPose { pose, z: draw(20.0).round(), tag: 0 }
    }

    #[test]
    fn keeps_what_holding_each_against_all_better_ones_keeps() {
        let mut random = Random::stream(8, 0);
        for (keep, apart_m) in [(1, 5.0), (20, 5.0), (1000, 12.0), (1000, 0.5)] {
            let poses: Vec<ScoredPose> = (0..300).map(|_| drawn(&mut random)).collect();
            let mut sorted = poses.clone();
            sorted.sort_by(|a, b| b.z.total_cmp(&a.z));
            let mut expected: Vec<ScoredPose> = Vec::new();
            for pose in sorted {
                if expected.iter().all(|kept| kept.pose.apart_m(&pose.pose, 3.0) >= apart_m) {
                    expected.push(pose);
                }
            }
            expected.truncate(keep);
            let found = distinct(poses, keep, apart_m, 3.0);
            let plain = |poses: &[ScoredPose]| poses.iter().map(|scored| scored.pose).collect::<Vec<_>>();
            assert_eq!(plain(&found), plain(&expected), "{keep} kept at {apart_m} m");
        }
    }

    #[test]
    fn the_distance_of_poses_is_the_same_both_ways_and_bounds_how_far_any_point_moves() {
        let mut random = Random::stream(9, 0);
        for _ in 0..500 {
            let (a, b) = (drawn(&mut random).pose, drawn(&mut random).pose);
            let b = PlanPose { scale: a.scale, ..b };
            assert!((a.apart_m(&b, 3.0) - b.apart_m(&a, 3.0)).abs() < 1e-12);
            let rim = [3.0 * random.unit(), 0.0];
            let ([x, y], [u, v]) = (a.apply(rim), b.apply(rim));
            // A chord is shorter than its arc, and shift and turn add up to at most the root of two of their root of squares.
            assert!((x - u).hypot(y - v) <= std::f64::consts::SQRT_2 * a.apart_m(&b, 3.0) + 1e-12);
        }
    }

    #[test]
    fn a_whole_turn_sets_nothing_apart() {
        let pose = PlanPose { center: [1.0, 2.0], heading_rad: 3.1, scale: 2.0 };
        let turned = PlanPose { heading_rad: 3.1 - std::f64::consts::TAU, ..pose };
        assert!(pose.apart_m(&turned, 100.0) < 1e-9);
    }
}
