//! The scales that are scanned.

use super::cloud_walls::{CloudWall, CloudWalls};
use super::prior::PlacePrior;
use crate::limits::PlaceSearchLimits;

/// The tallest wall is sought among so many of the strongest. Chosen: weak ones are often trees.
const WELL_SEEN: usize = 8;

/// The least and the most metres to an sfm unit: the tallest well-seen wall is neither a fence nor taller than the city's.
pub fn scale_range(cloud: &CloudWalls, tallest_m: f64, prior: &PlacePrior, limits: &PlaceSearchLimits) -> [f64; 2] {
    let seen = cloud.walls.iter().take(WELL_SEEN).map(CloudWall::height).fold(f64::MIN_POSITIVE, f64::max);
    let [least, most] = [limits.least_height_m / seen, (tallest_m + limits.overshoot_m) / seen];
    match prior.scale {
        // What is known beforehand is believed, whatever the walls.
        Some(known) => known,
        None => [least, most.min(limits.most_radius_m / cloud.radius)],
    }
}

/// Scales at linear steps of the cloud's radius.
pub fn scale_steps([least, most]: [f64; 2], cloud: &CloudWalls, limits: &PlaceSearchLimits) -> Vec<f64> {
    let steps = ((most - least) * cloud.radius / limits.step_m).ceil();
    if !steps.is_finite() || steps < 0.0 {
        return Vec::new();
    }
    (0..=steps as usize).map(|k| least + (most - least) * k as f64 / steps.max(1.0)).collect()
}
