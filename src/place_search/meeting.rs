//! What the walls of the cloud meet under a pose, looked at exactly.
//!
//! Question     which wall of the city does each place of a wall of the cloud lie on?
//! Method       of the walls within reach that face alike: the nearest for the plan's least squares, the tallest for heights

use super::city_walls::CityWall;
use super::cloud_walls::CloudWall;
use super::poses::PlanPose;
use super::wall_index::WallIndex;

/// Places of a wall, as shares of its length.
pub const PLACES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

/// What each place of a wall lies on.
pub type Met<'i> = [Option<&'i CityWall>; PLACES.len()];

/// Walls of the city that a place of a wall may lie on, with their distances.
pub fn candidates<'i>(
    index: &'i WallIndex,
    wall: &CloudWall,
    pose: &PlanPose,
    place: [f64; 2],
    reach_m: f64,
    min_cos: f64,
) -> impl Iterator<Item = (&'i CityWall, f64)> {
    let normal = pose.turned(wall.normal);
    let sided = wall.sided;
    let faces = move |city: &CityWall| {
        let cos = city.normal[0] * normal[0] + city.normal[1] * normal[1];
        (if sided { cos } else { cos.abs() }) > min_cos
    };
    // The cheapest question first: most walls of a block are too far across.
    let near = index.near(place).filter(move |city| city.across_m(place).abs() <= reach_m && faces(city));
    near.map(move |city| (city, city.distance_m(place))).filter(move |(_, distance)| *distance <= reach_m)
}

/// For each wall and place of a cloud under a pose the tallest wall that it lies on.
pub fn met<'i>(index: &'i WallIndex, walls: &[CloudWall], pose: &PlanPose, reach_m: f64, min_cos: f64) -> Vec<Met<'i>> {
    let tallest = |wall: &CloudWall, share: f64| {
        let place = pose.apply(wall.at(share));
        let found = candidates(index, wall, pose, place, reach_m, min_cos);
        found.map(|(city, _)| city).max_by(|a, b| a.height_m().total_cmp(&b.height_m()))
    };
    walls.iter().map(|wall| PLACES.map(|share| tallest(wall, share))).collect()
}
