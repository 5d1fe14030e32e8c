//! How well a pose explains the cloud: shares of the vote that lie on facets of the right side and direction.
//!
//! A vote is lost at a distance that shrinks and grows with the pose's scale, so that no shrinking of the cloud can gain
//! votes; and poses pay for leaving the start, so that where the data say nothing the start decides.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::field::{FacetField, Hit, Probe};
use super::votes::Votes;
use crate::geometry::{Point3, Similarity, Start, Vector3};
use crate::robust::vote;

/// What a pose is judged against.
pub struct Scorer<'a> {
    pub votes: &'a Votes,
    pub field: &'a FacetField,
    pub start: Start,
}

/// Cost of one squared sigma from the start, in shares of the vote: three sigmas in one freedom (9) cost as much as a small
/// house, 3 %.
const PRIOR_COST: f64 = 0.003;

/// Three sigmas, and some slack for the noise of the cloud itself.
const REACH_SIGMAS: f64 = 3.2;
/// Levelling by walls and floors is not better than this, whatever the start says.
const LEAST_TILT_RAD: f64 = 0.02;
/// Probes per task when a score is computed in parallel.
const CHUNK: usize = 512;

impl Scorer<'_> {
    /// Share of the vote explained within `gate_m` (metres of the start), by the probes of `panel` alike.
    pub fn panel_share(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        self.votes_of(panel, city_from_level, gate_m).sum::<f64>() / panel.len().max(1) as f64
    }

    /// The vote of each probe of `panel`, 0 to 1.
    pub fn panel_votes(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> Vec<f64> {
        self.votes_of(panel, city_from_level, gate_m).collect()
    }

    fn votes_of(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> impl Iterator<Item = f64> {
        let mover = Mover::new(city_from_level);
        let gate_m = gate_m * city_from_level.scale;
        panel.iter().map(move |&i| {
            let hit = self.field.nearest(&mover.probe(&self.votes.probes[i as usize]), gate_m);
            hit.map_or(0.0, |h| vote(h.distance_sq(), gate_m))
        })
    }

    /// Share of the vote explained within `gate_m`, by all probes with their weights.
    pub fn share(&self, city_from_level: &Similarity, gate_m: f64) -> f64 {
        let gate = gate_m * city_from_level.scale;
        let hits = self.hits(city_from_level, gate_m);
        hits.iter().zip(&self.votes.weights).map(|(h, w)| h.map_or(0.0, |h| w * vote(h.distance_sq(), gate))).sum()
    }

    /// Where each probe meets the city within `gate_m` (metres of the start).
    pub fn hits(&self, city_from_level: &Similarity, gate_m: f64) -> Vec<Option<Hit>> {
        let mover = Mover::new(city_from_level);
        let gate_m = gate_m * city_from_level.scale;
        let chunk = |probes: &[Probe]| -> Vec<Option<Hit>> {
            probes.iter().map(|p| self.field.nearest(&mover.probe(p), gate_m)).collect()
        };
        self.votes.probes.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().concat()
    }

    /// What leaving the start costs.
    pub fn prior_cost(&self, city_from_level: &Similarity) -> f64 {
        let off = self.offsets(city_from_level);
        PRIOR_COST * off.iter().map(|o| o * o).sum::<f64>()
    }

    /// True where a pose is within three sigmas of the start in every freedom.
    pub fn within_reach(&self, city_from_level: &Similarity) -> bool {
        let tilt = city_from_level.rotation.matrix()[(2, 2)].clamp(-1.0, 1.0).acos();
        tilt <= REACH_SIGMAS * self.start.tilt_sigma_rad.max(LEAST_TILT_RAD)
            && self.offsets(city_from_level).iter().all(|o| o.abs() <= REACH_SIGMAS)
    }

    /// How many sigmas a pose is from the start: heading, log scale, two horizontal axes, height.
    fn offsets(&self, city_from_level: &Similarity) -> [f64; 5] {
        let shift = city_from_level.translation - self.votes.center_in_city.coords;
        let r = city_from_level.rotation.matrix();
        let heading = if self.start.heading_is_unknown() {
            0.0
        } else {
            (r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)]) / self.start.heading_sigma_rad
        };
        let s = &self.start;
        [
            heading,
            city_from_level.scale.ln() / s.log_scale_sigma,
            shift.x / s.position_sigma_m,
            shift.y / s.position_sigma_m,
            shift.z / s.height_sigma_m,
        ]
    }
}

/// A similarity multiplied out for many points.
pub struct Mover {
    scaled: Matrix3<f64>,
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

impl Mover {
    pub fn new(pose: &Similarity) -> Mover {
        let rotation = *pose.rotation.matrix();
        Mover { scaled: rotation * pose.scale, rotation, translation: pose.translation }
    }

    #[inline]
    pub fn probe(&self, p: &Probe) -> Probe {
        let position = Point3::from(self.scaled * p.position.coords + self.translation);
        Probe { position, normal: self.rotation * p.normal, ..*p }
    }
}
