//! Lines of sight that walls block.
//!
//! Question     what share of the points could their cameras not have seen where a pose puts both?
//! Method       some lines from camera to point, evenly from all patches; walls alone block them: a height that is off by a metre would
//!              put every camera under the ground
//! Fails when   the height is off by storeys: then eaves block what was seen over them. A factor of a score, hence, and no veto

use super::cloud_walls::CloudWalls;
use super::poses::PlanPose;
use crate::geometry::Point3;
use crate::limits::Limits;
use crate::planes::{Patches, PreparedCity};

/// Cameras and the points that they saw; level frame, sfm units.
pub struct Sights {
    lines: Vec<[Point3<f64>; 2]>,
}

impl Sights {
    pub fn new(patches: &Patches, cloud: &CloudWalls, limits: &Limits) -> Sights {
        let seen = patches.patches.iter().flat_map(|p| &p.members);
        let line = |&m: &u32| {
            let camera = patches.viewers[m as usize][0]?;
            Some([&patches.cameras[camera as usize], &patches.points[m as usize]])
        };
        let all: Vec<[&Point3<f64>; 2]> = seen.filter_map(line).collect();
        let count = limits.place_search.sights.min(all.len());
        let some = (0..count).map(|i| all[i * all.len() / count]);
        Sights { lines: some.map(|ends| ends.map(|end| cloud.level_from_sfm.apply(end))).collect() }
    }

    /// How far from the middle they reach, in plan.
    pub fn reach(&self) -> f64 {
        self.lines.iter().flatten().map(|end| end.x.hypot(end.y)).fold(0.0, f64::max)
    }

    /// The share of them that walls block; 0 where nobody is known to have seen anything.
    pub fn blocked(&self, pose: &PlanPose, height_m: f64, city: &PreparedCity, limits: &Limits) -> f64 {
        let in_city = |p: &Point3<f64>| {
            let [x, y] = pose.apply([p.x, p.y]);
            Point3::new(x, y, height_m + pose.scale * p.z)
        };
        let is_wall = |triangle: u32| city.normal_of(triangle).z.abs() < limits.upright_sin;
        let is_blocked = |[camera, point]: &&[Point3<f64>; 2]| {
            let (camera, point) = (in_city(camera), in_city(point));
            let (distance, slack) = ((point - camera).norm(), limits.place_search.sight_slack_m);
            let Some(direction) = (point - camera).try_normalize(0.0) else { return false };
            distance > slack && city.rays().first_hit_of(is_wall, &camera, &direction, distance - slack).is_some()
        };
        self.lines.iter().filter(is_blocked).count() as f64 / self.lines.len().max(1) as f64
    }
}
