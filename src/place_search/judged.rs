//! A pose of the scan with all that is asked of it before it becomes a start.
//!
//! Question     how does a pose stand once it is sharp, with its height and the lines of sight?
//! Method       plan, height, score, sight in that order; the score is the scan's, with how far what was seen and the wall overlap in
//!              height in the place of a hit, less what lines of sight deny

use super::city_plan::CityPlan;
use super::city_walls::CityWall;
use super::cloud_walls::{CloudWall, CloudWalls};
use super::heights::{HeightVote, stabbed};
use super::meeting::{PLACES, met};
use super::poses::PlanPose;
use super::raster::{Question, classes_asked, height_code};
use super::scales::weight;
use super::sharpen::{class_cos, sharpened};
use super::sight::Sights;
use crate::limits::{Limits, PlaceSearchLimits};

/// What poses are judged by.
pub struct Judge<'a> {
    pub plan: &'a CityPlan<'a>,
    pub cloud: &'a CloudWalls,
    pub sights: &'a Sights,
    pub limits: &'a Limits,
}

/// A sharp pose.
#[derive(Clone, Copy, Debug)]
pub struct JudgedPose {
    pub pose: PlanPose,
    /// Of the level frame's origin, the least and the most that most walls allow; city frame (local).
    pub heights_m: [f64; 2],
    /// Walls against chance in plan alone.
    pub z_plan: f64,
    /// ... and with heights and lines of sight.
    pub z: f64,
    /// Share of the lines of sight that walls block.
    pub blocked: f64,
}

impl JudgedPose {
    pub fn height_m(&self) -> f64 {
        (self.heights_m[0] + self.heights_m[1]) / 2.0
    }
}

impl Judge<'_> {
    /// `None` where no wall tells a height.
    pub fn judged(&self, pose: &PlanPose) -> Option<JudgedPose> {
        let limits = &self.limits.place_search;
        let pose = sharpened(pose, self.cloud, &self.plan.index, limits);
        let walls = &self.cloud.walls[..self.cloud.walls.len().min(limits.most_walls)];
        let met = met(&self.plan.index, walls, &pose, limits.near_wall_m, class_cos(limits));
        let votes = height_votes(walls, &met, pose.scale, limits);
        let heights_m = stabbed(&votes)?;
        let height_m = (heights_m[0] + heights_m[1]) / 2.0;
        let overlap = |wall: &CloudWall, city: &CityWall| {
            let seen = [wall.bottom, wall.top].map(|z| height_m + pose.scale * z);
            let common = seen[1].min(city.top_m) - seen[0].max(city.foot_m);
            (common / (seen[1] - seen[0]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
        };
        let hits = |of: &dyn Fn(&CloudWall, &CityWall) -> f64| -> Vec<f64> {
            let share = |(wall, met): (&CloudWall, &[Option<&CityWall>; PLACES.len()])| {
                met.iter().flatten().map(|city| of(wall, city)).sum::<f64>() / PLACES.len() as f64
            };
            walls.iter().zip(&met).map(share).collect()
        };
        let blocked = self.sights.blocked(&pose, height_m, self.plan.city, self.limits);
        let z_plan = self.z(&pose, walls, &hits(&|_, _| 1.0));
        let z = self.z(&pose, walls, &hits(&overlap)) * (1.0 - limits.sight_weight * blocked);
        Some(JudgedPose { pose, heights_m, z_plan, z, blocked })
    }

    fn z(&self, pose: &PlanPose, walls: &[CloudWall], hits: &[f64]) -> f64 {
        let limits = &self.limits.place_search;
        let (mut above, mut variance) = (0.0, 1.0);
        for (wall, hit) in walls.iter().zip(hits) {
            let height = height_code(wall.height() * pose.scale - limits.overshoot_m);
            let classes = classes_asked(wall.azimuth() + pose.heading_rad, wall.sided);
            let (p, w) = (self.plan.raster.chance(Question { classes, height }), weight(wall, pose.scale, limits));
            above += w * (hit - p);
            variance += w * w * p * (1.0 - p);
        }
        above / f64::sqrt(variance)
    }
}

/// What each place that lies on a wall allows; walls that were seen taller than they are have no say.
fn height_votes(
    walls: &[CloudWall],
    met: &[[Option<&CityWall>; PLACES.len()]],
    scale: f64,
    limits: &PlaceSearchLimits,
) -> Vec<HeightVote> {
    let vote = |wall: &CloudWall, city: &CityWall| HeightVote {
        from_m: city.foot_m - limits.overshoot_m - scale * wall.bottom,
        to_m: city.top_m + limits.overshoot_m - scale * wall.top,
        weight: weight(wall, scale, limits) / PLACES.len() as f64,
    };
    let of_wall = |(wall, met): (_, &[Option<&CityWall>; PLACES.len()])| met.map(|m| m.map(|city| vote(wall, city)));
    let votes = walls.iter().zip(met).flat_map(of_wall).flatten();
    votes.filter(|vote| vote.from_m <= vote.to_m).collect()
}
