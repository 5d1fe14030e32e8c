//! The search on one page: walls of the cloud, walls of the city, raster, scan, sharp poses, starts.

use rayon::prelude::*;

use super::city_walls::city_walls;
use super::cloud_walls::{CloudWalls, is_parallel};
use super::judged::{Judge, JudgedPose};
use super::outcome::{PlaceCandidate, PlaceObstacle, PlaceSearch};
use super::poses::{ScoredPose, distinct};
use super::prior::PlacePrior;
use super::raster::Raster;
use super::scales::scales;
use super::scan::Scan;
use super::sight::Sights;
use super::wall_index::WallIndex;
use crate::limits::{Limits, PlaceSearchLimits};
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::planes::{Patches, PreparedCity, Upright};

/// Finds the places in a city where a reconstruction may stand whose scale, heading and position are unknown, or known in part.
pub fn search_places(
    city: &PreparedCity,
    patches: &Patches,
    upright: &Upright,
    prior: &PlacePrior,
    limits: &Limits,
    observer: &dyn Observer,
) -> Result<PlaceSearch, Cancelled> {
    let own = &limits.place_search;
    let cloud = CloudWalls::new(patches, upright, limits);
    if let Some(obstacle) = obstacle(&cloud, own) {
        return Ok(PlaceSearch::refused(obstacle));
    }
    observer.progress(Stage::City, 0, 0);
    let walls = city_walls(city, None, limits);
    if walls.is_empty() {
        return Ok(PlaceSearch::refused(PlaceObstacle::NoCityWalls));
    }
    check_cancelled(observer)?;
    let raster = Raster::new(&walls, own);
    let scales = scales(&cloud, &walls, prior, own);
    let scan = Scan { raster: &raster, city: &walls, cloud: &cloud, scales: &scales, prior, limits: own };
    let scanned = scan.run(&cloud.anchors(own.anchors, own.one_direction_deg), observer)?;
    let index = WallIndex::new(&walls, own.gates_m[0]);
    let sights = Sights::new(patches, &cloud, limits);
    let judge = Judge { city, index: &index, chance: &raster.chance, cloud: &cloud, sights: &sights, limits };
    let judged: Vec<JudgedPose> = scanned.poses.par_iter().filter_map(|found| judge.judged(&found.pose)).collect();
    let candidates = comparable(&judged, cloud.radius, own);
    let candidate = |judged: &JudgedPose| PlaceCandidate::new(judged, &cloud.level_from_sfm, upright, own);
    Ok(PlaceSearch {
        candidates: candidates.iter().filter_map(candidate).collect(),
        poses_scanned: scanned.count,
        obstacle: None,
    })
}

/// Why a cloud has no place that walls could tell.
fn obstacle(cloud: &CloudWalls, limits: &PlaceSearchLimits) -> Option<PlaceObstacle> {
    let main = cloud.walls.first().map_or(Err(PlaceObstacle::NoWalls), Ok);
    let main = match main {
        Ok(wall) => wall,
        Err(none) => return Some(none),
    };
    if cloud.walls.len() < limits.fewest_walls {
        return Some(PlaceObstacle::TooFewWalls { found: cloud.walls.len(), needed: limits.fewest_walls });
    }
    let all: f64 = cloud.walls.iter().map(|wall| wall.length).sum();
    let across = cloud.walls.iter().filter(|wall| !is_parallel(main, wall, limits.one_direction_deg));
    let across: f64 = across.map(|wall| wall.length).sum();
    (across < limits.least_across * all).then_some(PlaceObstacle::OneDirection)
}

/// The poses that may be right, at distinct places, the best first.
fn comparable(judged: &[JudgedPose], radius: f64, limits: &PlaceSearchLimits) -> Vec<JudgedPose> {
    let scored: Vec<ScoredPose> = judged.iter().map(|j| ScoredPose { pose: j.pose, z: j.z }).collect();
    let best = scored.iter().map(|s| s.z).fold(0.0, f64::max);
    let kept = distinct(scored, limits.keep, limits.apart_m, radius);
    let told = kept.iter().take_while(|s| s.z > 0.0 && s.z >= limits.comparable_share * best);
    told.filter_map(|s| judged.iter().find(|j| j.pose == s.pose).copied()).collect()
}
