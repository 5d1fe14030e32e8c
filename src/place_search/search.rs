//! The search on one page: walls of the cloud, plan of the city, scan, sharp poses, starts.

use rayon::prelude::*;

use super::city_plan::CityPlan;
use super::city_walls::tallest_m;
use super::cloud_walls::{CloudWalls, is_parallel};
use super::judged::{Judge, JudgedPose};
use super::outcome::{PlaceCandidate, PlaceObstacle, PlaceSearch};
use super::poses::{ScoredPose, distinct};
use super::prior::{Disc, PlacePrior};
use super::scales::{scale_range, scale_steps};
use super::scan::Scan;
use super::sight::Sights;
use crate::limits::{Limits, PlaceSearchLimits};
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::planes::{Patches, PreparedCity, Upright};

/// Finds the places in a city where a reconstruction may stand whose scale, heading and position are unknown, or known in part; under each up that
/// it may have.
pub fn search_places(
    city: &PreparedCity,
    patches: &Patches,
    uprights: &[Upright],
    prior: &PlacePrior,
    limits: &Limits,
    observer: &dyn Observer,
) -> Result<PlaceSearch, Cancelled> {
    let views = match views(patches, uprights, limits) {
        Ok(views) => views,
        Err(obstacle) => return Ok(PlaceSearch::refused(obstacle)),
    };
    observer.progress(Stage::City, 0, 0);
    let within = prior.near.map(|near| reached(&near, city, &views, prior, limits));
    let plan = CityPlan::new(city, within.as_ref(), limits);
    check_cancelled(observer)?;
    search_views(&plan, patches, &views, prior, limits, observer)
}

/// The walls of the cloud under one up.
struct View<'a> {
    upright: &'a Upright,
    cloud: CloudWalls,
}

/// The views under which a place can be told, or why it cannot be under the first.
fn views<'a>(patches: &Patches, uprights: &'a [Upright], limits: &Limits) -> Result<Vec<View<'a>>, PlaceObstacle> {
    let mut views = Vec::new();
    let mut first = None;
    for upright in uprights {
        let cloud = CloudWalls::new(patches, upright, limits);
        match obstacle(&cloud, &limits.place_search) {
            None => views.push(View { upright, cloud }),
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
fn reached(near: &Disc, city: &PreparedCity, views: &[View], prior: &PlacePrior, limits: &Limits) -> Disc {
    let own = &limits.place_search;
    let tallest = tallest_m(city, Some(&near.widened(own.most_radius_m)), own.tallest_share, limits);
    let reach = |view: &View| scale_range(&view.cloud, tallest.unwrap_or(0.0), prior, own)[1] * view.cloud.reach();
    near.widened(views.iter().map(reach).fold(0.0, f64::max))
}

fn search_views(
    plan: &CityPlan,
    patches: &Patches,
    views: &[View],
    prior: &PlacePrior,
    limits: &Limits,
    observer: &dyn Observer,
) -> Result<PlaceSearch, Cancelled> {
    let own = &limits.place_search;
    let near = prior.near.map(|near| near.widened(own.most_radius_m));
    let tallest_m = tallest_m(plan.city, near.as_ref(), own.tallest_share, limits);
    let Some(tallest_m) = tallest_m.filter(|_| !plan.walls().is_empty()) else {
        return Ok(PlaceSearch::refused(PlaceObstacle::NoCityWalls));
    };
    let mut found = PlaceSearch::default();
    for View { upright, cloud } in views {
        let scales = scale_steps(scale_range(cloud, tallest_m, prior, own), cloud, own);
        let scan = Scan { plan, cloud, scales: &scales, prior, limits: own };
        let scanned = scan.run(&cloud.anchors(own), observer)?;
        let sights = Sights::new(patches, cloud, limits);
        let judge = Judge { plan, cloud, sights: &sights, limits };
        let judged: Vec<JudgedPose> = scanned.poses.par_iter().filter_map(|s| judge.judged(&s.pose)).collect();
        let candidate = |judged: &JudgedPose| PlaceCandidate::new(judged, &cloud.level_from_sfm, upright, own);
        found.candidates.extend(at_distinct_places(&judged, cloud.radius, own).iter().filter_map(candidate));
        found.poses_scanned += scanned.count;
    }
    found.keep_comparable(own.comparable_share);
    Ok(found)
}

/// Sharp poses at distinct places, the best first.
fn at_distinct_places(judged: &[JudgedPose], radius: f64, limits: &PlaceSearchLimits) -> Vec<JudgedPose> {
    let scored: Vec<ScoredPose> = judged.iter().map(|j| ScoredPose { pose: j.pose, z: j.z }).collect();
    let kept = distinct(scored, limits.keep, limits.apart_m, radius);
    let of = |s: &ScoredPose| judged.iter().find(|j| j.pose == s.pose && j.z == s.z).copied();
    kept.iter().take_while(|s| s.z > 0.0).filter_map(of).collect()
}

#[cfg(test)]
mod tests;
