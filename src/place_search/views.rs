//! The walls of the cloud under each up that it may have, and how far they reach.

use super::city_walls::tallest_m;
use super::cloud_walls::{CloudWalls, is_parallel};
use super::outcome::PlaceObstacle;
use super::prior::{Disc, PlacePrior};
use super::scales::scale_range;
use super::sight::Sights;
use crate::limits::{Limits, PlaceSearchLimits};
use crate::planes::{Patches, PreparedCity, Upright};

/// The walls of the cloud under one up, and what was seen past them.
pub struct View<'a> {
    pub upright: &'a Upright,
    pub cloud: CloudWalls,
    pub sights: Sights,
}

/// The views under which a place can be told, or why it cannot be under the first.
pub fn views<'a>(patches: &Patches, uprights: &'a [Upright], limits: &Limits) -> Result<Vec<View<'a>>, PlaceObstacle> {
    let mut views = Vec::new();
    let mut first = None;
    for upright in uprights {
        let cloud = CloudWalls::new(patches, upright, limits);
        match obstacle(&cloud, &limits.place_search) {
            None => views.push(View { upright, sights: Sights::new(patches, &cloud, limits), cloud }),
            Some(obstacle) => first = first.or(Some(obstacle)),
        }
    }
    if views.is_empty() { Err(first.unwrap_or(PlaceObstacle::NoWalls)) } else { Ok(views) }
}

/// Why a cloud has no place that walls could tell.
fn obstacle(cloud: &CloudWalls, limits: &PlaceSearchLimits) -> Option<PlaceObstacle> {
    let Some(main) = cloud.walls.first() else { return Some(PlaceObstacle::NoWalls) };
    let all: f64 = cloud.walls.iter().map(|wall| wall.length).sum();
    let across = cloud.walls.iter().filter(|wall| !is_parallel(main, wall, limits.one_direction_deg));
    let across: f64 = across.map(|wall| wall.length).sum();
    if across < limits.least_across * all {
        return Some(PlaceObstacle::OneDirection);
    }
    let found = cloud.walls.len();
    (found < limits.fewest_walls).then_some(PlaceObstacle::TooFewWalls { found, needed: limits.fewest_walls })
}

/// Where walls matter if the middle of the cloud lies in a disc: as far beyond it as the largest cloud reaches.
pub fn reached(near: &Disc, city: &PreparedCity, views: &[View], prior: &PlacePrior, limits: &Limits) -> Disc {
    let own = &limits.place_search;
    let tallest = tallest_m(city, &near.widened(own.most_radius_m), own.tallest_share, limits);
    near.widened(reach_m(views, tallest.unwrap_or(0.0), prior, own))
}

/// How far walls of the cloud lie from its middle at most.
pub fn reach_m(views: &[View], tallest_m: f64, prior: &PlacePrior, limits: &PlaceSearchLimits) -> f64 {
    let reach = |view: &View| scale_range(&view.cloud, tallest_m, prior, limits)[1] * view.cloud.reach();
    views.iter().map(reach).fold(0.0, f64::max)
}
