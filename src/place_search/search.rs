//! The search on one page: walls of the cloud, walls of the city, scan of its districts, sharp poses, lines of sight, starts.

use rayon::prelude::*;

use super::chance::{CellCounts, Chance};
use super::city_walls::{CityWall, city_walls, tallest_m};
use super::compared::{CityAt, Compared, Found};
use super::districts::{District, Districts};
use super::effort::Effort;
use super::judged::{Judge, JudgedPose};
use super::outcome::{PlaceObstacle, PlaceSearch};
use super::poses::ScoredPose;
use super::prior::PlacePrior;
use super::raster::Raster;
use super::scales::{scale_range, scale_steps};
use super::scan::Scan;
use super::views::{View, reach_m, reached, views};
use super::wall_index::WallIndex;
use crate::limits::{Limits, PlaceSearchLimits};
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::planes::{Patches, PreparedCity, Upright};
use crate::robust::quantile;

/// What is sought: a reconstruction whose scale, heading and position are unknown, or known in part; under each up that it may have.
pub struct PlaceTask<'a> {
    pub patches: &'a Patches,
    pub uprights: &'a [Upright],
    pub prior: &'a PlacePrior,
    pub limits: &'a Limits,
    /// Whether no more time is to be spent on the scan; asked again and again until it says so.
    pub is_over: &'a dyn Fn() -> bool,
    pub observer: &'a dyn Observer,
}

/// Finds the places in a city where a reconstruction may stand.
pub fn search_places(city: &PreparedCity, task: &PlaceTask) -> Result<PlaceSearch, Cancelled> {
    let PlaceTask { patches, uprights, prior, limits, observer, .. } = task;
    let views = match views(patches, uprights, limits) {
        Ok(views) => views,
        Err(obstacle) => return Ok(PlaceSearch::refused(obstacle)),
    };
    observer.progress(Stage::City, 0, 0);
    let within = prior.near.map(|near| reached(&near, city, &views, prior, limits));
    let walls = city_walls(city, within.as_ref(), limits);
    check_cancelled(*observer)?;
    let own = &limits.place_search;
    let around = prior.near.map(|near| near.widened(own.most_radius_m));
    let tallest_m = match &around {
        Some(around) => tallest_m(city, around, own.tallest_share, limits),
        None => tallest_of(&walls, own),
    };
    let mut whole = |_: &_, look: &mut dyn FnMut(&PreparedCity)| {
        look(city);
        Ok(())
    };
    search_views(task, walls, tallest_m, &views, &mut whole)
}

/// As [`search_places`], of a city that is not all there: its walls in plan are, and parts of it for those who ask.
pub fn search_places_by_walls<E: From<Cancelled>>(
    task: &PlaceTask,
    walls: Vec<CityWall>,
    city_at: &mut CityAt<E>,
) -> Result<PlaceSearch, E> {
    let views = match views(task.patches, task.uprights, task.limits) {
        Ok(views) => views,
        Err(obstacle) => return Ok(PlaceSearch::refused(obstacle)),
    };
    let tallest_m = tallest_of(&walls, &task.limits.place_search);
    search_views(task, walls, tallest_m, &views, city_at)
}

/// The height that nearly all walls do not exceed.
fn tallest_of(walls: &[CityWall], limits: &PlaceSearchLimits) -> Option<f64> {
    quantile(&mut walls.iter().map(CityWall::height_m).collect::<Vec<f64>>(), limits.tallest_share)
}

fn search_views<E: From<Cancelled>>(
    task: &PlaceTask,
    walls: Vec<CityWall>,
    tallest_m: Option<f64>,
    views: &[View],
    city_at: &mut CityAt<E>,
) -> Result<PlaceSearch, E> {
    let own = &task.limits.place_search;
    let Some(tallest_m) = tallest_m.filter(|_| !walls.is_empty()) else {
        return Ok(PlaceSearch::refused(PlaceObstacle::NoCityWalls));
    };
    let scales = |view: &View| scale_steps(scale_range(&view.cloud, tallest_m, task.prior, own), &view.cloud, own);
    let sought = Sought {
        task,
        views,
        scales: views.iter().map(scales).collect(),
        reach_m: reach_m(views, tallest_m, task.prior, own),
        districts: Districts::new(walls, own),
    };
    let chance = sought.chance()?;
    let mut effort = Effort::new(sought.work(), task.is_over, task.observer);
    let scanned = sought.scanned(&chance, &mut effort)?;
    let sharp = sought.sharp(&chance, scanned)?;
    let mut found = Compared { views, limits: task.limits }.places(sharp, city_at)?;
    (found.poses_scanned, found.share_searched) = (effort.poses(), effort.share());
    Ok(found)
}

/// A search, ready to be made.
struct Sought<'a> {
    task: &'a PlaceTask<'a>,
    views: &'a [View<'a>],
    /// Of each view.
    scales: Vec<Vec<f64>>,
    reach_m: f64,
    districts: Districts,
}

/// Poses of a view that the scan found in a district.
struct Scanned {
    district: usize,
    view: usize,
    poses: Vec<ScoredPose>,
}

impl Sought<'_> {
    fn limits(&self) -> &PlaceSearchLimits {
        &self.task.limits.place_search
    }

    /// Walls that poses are tied to, for all views.
    fn work(&self) -> usize {
        let tied =
            |walls: &[CityWall]| walls.iter().filter(|wall| wall.length_m() >= self.limits().least_tied_m).count();
        self.views.len() * self.districts.own().map(tied).sum::<usize>()
    }

    /// What chance does in the city as a whole.
    fn chance(&self) -> Result<Chance, Cancelled> {
        let mut counts = CellCounts::none();
        for walls in self.districts.own() {
            check_cancelled(self.task.observer)?;
            counts = counts.with(CellCounts::of(&Raster::new(walls, self.limits()), walls, self.limits()));
        }
        Ok(counts.chance())
    }

    fn district(&self, number: usize) -> Option<District> {
        self.districts.with_reach(number, self.reach_m)
    }

    fn scanned(&self, chance: &Chance, effort: &mut Effort) -> Result<Vec<Scanned>, Cancelled> {
        let mut all = Vec::new();
        for number in 0..self.districts.count() {
            if effort.is_over() {
                break;
            }
            let Some(district) = self.district(number) else { break };
            let raster = Raster::new(&district.walls, self.limits());
            for (view, scales) in (0..).zip(&self.scales) {
                let cloud = &self.views[view].cloud;
                let (walls, prior, limits) = (district.own(), self.task.prior, self.limits());
                let scan = Scan { walls, raster: &raster, chance, cloud, scales, prior, limits };
                let poses = scan.run(&cloud.anchors(limits), effort)?;
                all.push(Scanned { district: number, view, poses });
            }
        }
        Ok(all)
    }

    /// The poses that may be among the best, made sharp.
    fn sharp(&self, chance: &Chance, scanned: Vec<Scanned>) -> Result<Vec<Found>, Cancelled> {
        let limits = self.limits();
        let best = scanned.iter().flat_map(|s| &s.poses).map(|scored| scored.z).fold(0.0, f64::max);
        let is_worth = |scored: &&ScoredPose| scored.z >= limits.sharpened_share * best;
        let mut found = Vec::new();
        for Scanned { district, view, poses } in &scanned {
            check_cancelled(self.task.observer)?;
            let poses: Vec<&ScoredPose> = poses.iter().filter(is_worth).collect();
            let Some(district) = self.district(*district).filter(|_| !poses.is_empty()) else { continue };
            let index = WallIndex::new(district.walls, limits.gates_m[0]);
            let judge = Judge { index: &index, chance, cloud: &self.views[*view].cloud, limits };
            let judged: Vec<JudgedPose> = poses.par_iter().filter_map(|scored| judge.judged(&scored.pose)).collect();
            found.extend(judged.into_iter().map(|judged| Found { view: *view, judged }));
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests;
