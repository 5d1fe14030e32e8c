//! Which of the sharp poses may be right beside the best.
//!
//! Question     what do lines of sight leave of the scores, and which poses are then within reach of the best?
//! Method       a score without lines of sight is the most that it can be with them. Poses are looked at by that, the best first, some at a time,
//!              until no other can come within reach of the best: exact, and of a city in parts only those about good poses are needed
//! Fails when   very many poses are as good as the best: those beyond a number are counted, not compared

use rayon::prelude::*;

use super::judged::JudgedPose;
use super::outcome::{PlaceCandidate, PlaceSearch};
use super::poses::{ScoredPose, distinct};
use super::prior::Disc;
use super::views::View;
use crate::limits::Limits;
use crate::observer::Cancelled;
use crate::planes::PreparedCity;

/// A city of which some places are asked for: shows what stands there, to be looked at.
pub type CityAt<'a, E> = dyn FnMut(&[Disc], &mut dyn FnMut(&PreparedCity)) -> Result<(), E> + 'a;

/// A sharp pose of a view.
#[derive(Clone, Copy)]
pub struct Found {
    pub view: usize,
    pub judged: JudgedPose,
}

pub struct Compared<'a> {
    pub views: &'a [View<'a>],
    pub limits: &'a Limits,
}

/// Poses whose lines of sight are looked along together.
const TOGETHER: usize = 32;
/// Sharp poses that differ by less are one, metres over the cloud: most of the scan's slide to the same.
const SAME_M: f64 = 0.1;

impl Compared<'_> {
    /// The places within reach of the best, the best first.
    pub fn places<E: From<Cancelled>>(&self, sharp: Vec<Found>, city_at: &mut CityAt<E>) -> Result<PlaceSearch, E> {
        let own = &self.limits.place_search;
        let sharp = self.at_distinct_places(sharp, usize::MAX, SAME_M);
        let (mut seen, mut best): (Vec<Found>, f64) = (Vec::new(), 0.0);
        let mut rest = &sharp[..];
        loop {
            let comparable = rest.partition_point(|found| found.judged.z >= own.comparable_share * best);
            rest = &rest[..comparable];
            let (some, others) = rest.split_at(rest.len().min(TOGETHER));
            if some.is_empty() || seen.len() >= own.most_sighted {
                break;
            }
            let discs: Vec<Disc> = some.iter().map(|found| self.looked_through(found)).collect();
            let mut looked = Vec::new();
            city_at(&discs, &mut |city| looked = some.par_iter().map(|found| self.sighted(found, city)).collect())?;
            best = looked.iter().map(|found| found.judged.z).fold(best, f64::max);
            seen.extend(looked);
            rest = others;
        }
        let is_comparable = |found: &Found| found.judged.z > 0.0 && found.judged.z >= own.comparable_share * best;
        seen.retain(is_comparable);
        let mut places = self.at_distinct_places(seen, usize::MAX, own.apart_m);
        let unexamined = rest.len() + places.len().saturating_sub(own.most_places);
        places.truncate(own.most_places);
        let candidate = |found: &Found| {
            let View { cloud, upright, .. } = &self.views[found.view];
            PlaceCandidate::new(&found.judged, &cloud.level_from_sfm, upright, own)
        };
        Ok(PlaceSearch {
            candidates: places.iter().filter_map(candidate).collect(),
            unexamined,
            ..PlaceSearch::default()
        })
    }

    /// The pose with what lines of sight say.
    fn sighted(&self, found: &Found, city: &PreparedCity) -> Found {
        let judged = found.judged;
        let blocked = self.views[found.view].sights.blocked(&judged.pose, judged.height_m(), city, self.limits);
        let z = judged.z * (1.0 - self.limits.place_search.sight_weight * blocked);
        Found { judged: JudgedPose { z, ..judged }, ..*found }
    }

    /// What lines of sight of a pose pass through.
    fn looked_through(&self, found: &Found) -> Disc {
        let pose = &found.judged.pose;
        Disc { center: pose.center, radius_m: pose.scale * self.views[found.view].sights.reach() }
    }

    /// The best of each place under each view, the best first.
    fn at_distinct_places(&self, found: Vec<Found>, keep: usize, apart_m: f64) -> Vec<Found> {
        let mut kept: Vec<Found> = Vec::new();
        for (view, own) in self.views.iter().enumerate() {
            let of_view: Vec<&JudgedPose> = found.iter().filter(|f| f.view == view).map(|f| &f.judged).collect();
            let scored =
                of_view.iter().zip(0..).map(|(judged, tag)| ScoredPose { pose: judged.pose, z: judged.z, tag });
            let places = distinct(scored.collect(), keep, apart_m, own.cloud.radius);
            kept.extend(places.iter().map(|scored| Found { view, judged: *of_view[scored.tag as usize] }));
        }
        kept.sort_by(|a, b| b.judged.z.total_cmp(&a.judged.z));
        kept
    }
}
