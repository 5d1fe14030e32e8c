//! A pose of the scan with all that is asked of it before it becomes a start.
//!
//! Question     how does a pose stand once it is sharp, with its height?
//! Method       plan, height, score in that order; the score is the scan's, with how far what was seen and the wall overlap in
//!              height in the place of a hit. Lines of sight take from it what they deny (`compared`)

use super::chance::Chance;
use super::city_walls::CityWall;
use super::cloud_walls::{CloudWall, CloudWalls};
use super::heights::{HeightVote, stabbed};
use super::meeting::{Met, PLACES, met};
use super::poses::PlanPose;
use super::raster::{Question, classes_asked, height_code};
use super::sharpen::{class_cos, sharpened};
use super::wall_index::WallIndex;
use super::weights::weights;
use crate::limits::PlaceSearchLimits;

/// What poses are judged by.
pub struct Judge<'a> {
    pub index: &'a WallIndex,
    pub chance: &'a Chance,
    pub cloud: &'a CloudWalls,
    pub limits: &'a PlaceSearchLimits,
}

/// A sharp pose.
#[derive(Clone, Copy, Debug)]
pub struct JudgedPose {
    pub pose: PlanPose,
    /// Of the level frame's origin, the least and the most that most walls allow; city frame (local).
    pub heights_m: [f64; 2],
    /// Walls and heights against chance, in standard deviations of it; once they were looked along, with lines of sight.
    pub z: f64,
}

impl JudgedPose {
    pub fn height_m(&self) -> f64 {
        (self.heights_m[0] + self.heights_m[1]) / 2.0
    }
}

impl Judge<'_> {
    /// `None` where no wall tells a height.
    pub fn judged(&self, pose: &PlanPose) -> Option<JudgedPose> {
        let limits = self.limits;
        let pose = sharpened(pose, self.cloud, self.index, limits);
        let walls = self.cloud.strongest(limits.most_walls);
        let weights = weights(walls, pose.scale, limits);
        let met = met(self.index, walls, &pose, limits.near_wall_m, class_cos(limits));
        let heights_m = stabbed(&height_votes(walls, &weights, &met, pose.scale, limits))?;
        let height_m = (heights_m[0] + heights_m[1]) / 2.0;
        let overlap = |wall: &CloudWall, city: &CityWall| {
            let seen = [wall.bottom, wall.top].map(|z| height_m + pose.scale * z);
            let wall = [city.foot_m - limits.overshoot_m, city.top_m + limits.overshoot_m];
            let common = seen[1].min(wall[1]) - seen[0].max(wall[0]);
            (common / (seen[1] - seen[0]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
        };
        let hit = |(wall, met): (&CloudWall, &Met)| {
            met.iter().flatten().map(|city| overlap(wall, city)).sum::<f64>() / PLACES.len() as f64
        };
        let hits: Vec<f64> = walls.iter().zip(&met).map(hit).collect();
        Some(JudgedPose { pose, heights_m, z: self.z(&pose, &weights, &hits) })
    }

    fn z(&self, pose: &PlanPose, weights: &[f64], hits: &[f64]) -> f64 {
        let (mut above, mut variance) = (0.0, 1.0);
        for ((wall, w), hit) in self.cloud.walls.iter().zip(weights).zip(hits) {
            let height = height_code(wall.height() * pose.scale - self.limits.overshoot_m);
            let classes = classes_asked(wall.azimuth() + pose.heading_rad, wall.sided);
            let p = self.chance.of(Question { classes, height });
            above += w * (hit - p);
            variance += w * w * p * (1.0 - p);
        }
        above / f64::sqrt(variance)
    }
}

/// What each place that lies on a wall allows; walls that were seen taller than they are have no say.
fn height_votes(
    walls: &[CloudWall],
    weights: &[f64],
    met: &[Met],
    scale: f64,
    limits: &PlaceSearchLimits,
) -> Vec<HeightVote> {
    let mut votes = Vec::with_capacity(PLACES.len() * walls.len());
    for ((wall, weight), met) in walls.iter().zip(weights).zip(met) {
        votes.extend(met.iter().flatten().map(|city| HeightVote {
            from_m: city.foot_m - limits.overshoot_m - scale * wall.bottom,
            to_m: city.top_m + limits.overshoot_m - scale * wall.top,
            weight: weight / PLACES.len() as f64,
        }));
    }
    votes.retain(|vote| vote.from_m <= vote.to_m);
    votes
}
