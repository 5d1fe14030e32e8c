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
