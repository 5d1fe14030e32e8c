//! A pose of the scan made sharp in plan.
//!
//! Problem      heading, scale and position in plan, from walls that lie on walls
//! Equations    n . (c + s R x - q) = 0 for each place x of a wall that lies on a wall of the city with normal n through q, metres
//! Method       Gauss-Newton with Tukey weights whose gate narrows from step to step; all unknowns are lengths at the cloud's radius. The
//!              scan's pose holds what no wall does (along a street) as well as its steps are wide
//! Source       derived here

use nalgebra::{Matrix4, Vector4};

use super::cloud_walls::CloudWalls;
use super::meeting::{PLACES, candidates};
use super::poses::PlanPose;
use super::wall_index::WallIndex;
use super::weights::weights;
use crate::limits::PlaceSearchLimits;
use crate::robust::tukey_weight;

/// Error of a wall of the model or the cloud, metres, against which the steps of the scan are held.
const WALL_SIGMA_M: f64 = 0.3;

pub fn sharpened(start: &PlanPose, cloud: &CloudWalls, index: &WallIndex, limits: &PlaceSearchLimits) -> PlanPose {
    let min_cos = class_cos(limits);
    let walls = cloud.strongest(limits.most_walls);
    let weights = weights(walls, start.scale, limits);
    let mut pose = *start;
    for &gate_m in limits.gates_m {
        let radius_m = cloud.radius * pose.scale;
        let held = (WALL_SIGMA_M / limits.step_m).powi(2);
        let mut normal = Matrix4::identity() * held;
        let mut right = -held * between(start, &pose, cloud.radius);
        for (wall, weight) in walls.iter().zip(&weights) {
            let each = weight / PLACES.len() as f64;
            for share in PLACES {
                let place = pose.apply(wall.at(share));
                let found = candidates(index, wall, &pose, place, gate_m, min_cos);
                let Some((city, _)) = found.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
                let (n, r) = (city.normal, [place[0] - pose.center[0], place[1] - pose.center[1]]);
                let across = city.across_m(place);
                let turn = (n[1] * r[0] - n[0] * r[1]) / radius_m;
                let stretch = (n[0] * r[0] + n[1] * r[1]) / radius_m;
                let row = Vector4::new(n[0], n[1], turn, stretch);
                let believed = each * tukey_weight(across * across, gate_m);
                normal += believed * row * row.transpose();
                right -= believed * across * row;
            }
        }
        let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { break };
        pose.center = [pose.center[0] + step[0], pose.center[1] + step[1]];
        pose.heading_rad += step[2] / radius_m;
        pose.scale *= (step[3] / radius_m).exp();
    }
    pose
}

/// What leads from one pose to the other, in the unknowns of the adjustment.
fn between(from: &PlanPose, to: &PlanPose, radius: f64) -> Vector4<f64> {
    let radius_m = radius * to.scale;
    Vector4::new(
        to.center[0] - from.center[0],
        to.center[1] - from.center[1],
        (to.heading_rad - from.heading_rad) * radius_m,
        (to.scale / from.scale).ln() * radius_m,
    )
}

/// Walls of one class may differ by so much.
pub fn class_cos(limits: &PlaceSearchLimits) -> f64 {
    limits.same_direction_deg.to_radians().cos()
}
