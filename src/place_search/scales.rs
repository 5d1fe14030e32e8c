//! The scales that are scanned, and what a wall of the cloud weighs at each.

use super::city_walls::CityWall;
use super::cloud_walls::{CloudWall, CloudWalls};
use super::prior::PlacePrior;
use crate::limits::PlaceSearchLimits;
use crate::robust::quantile;

/// The tallest wall is sought among so many of the strongest. Chosen: weak ones are often trees.
const WELL_SEEN: usize = 8;

/// Scales at linear steps of the cloud's radius: the tallest well-seen wall is neither a fence nor taller than the city's.
pub fn scales(cloud: &CloudWalls, city: &[CityWall], prior: &PlacePrior, limits: &PlaceSearchLimits) -> Vec<f64> {
    let mut heights: Vec<f64> = city.iter().map(CityWall::height_m).collect();
    let tallest_m = quantile(&mut heights, limits.tallest_share).unwrap_or(0.0) + limits.overshoot_m;
    let seen = cloud.walls.iter().take(WELL_SEEN).map(CloudWall::height).fold(0.0, f64::max);
    let [mut least, mut most] = [limits.least_height_m / seen, tallest_m / seen];
    if let Some([low, high]) = prior.scale {
        (least, most) = (least.max(low).min(high), most.min(high).max(low));
    }
    let step = limits.step_m / cloud.radius;
    let count = ((most - least) / step).ceil();
    if !count.is_finite() || count < 0.0 {
        return Vec::new();
    }
    let step = (most - least) / count.max(1.0);
    (0..=count as usize).map(|k| least + k as f64 * step).take_while(|scale| *scale <= most * 1.0001).collect()
}

/// How much a wall weighs: the root of the independent looks that its length is worth; less than one look as such, so that a cloud that
/// shrinks weighs nothing.
pub fn weight(wall: &CloudWall, scale: f64, limits: &PlaceSearchLimits) -> f64 {
    let looks = (wall.length * scale / limits.metres_of_look).min(limits.most_looks);
    if looks < 1.0 { looks } else { looks.sqrt() }
}
