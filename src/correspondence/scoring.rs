//! How well a pose explains the cloud: shares of the vote that lie on facets of the right side and direction.
//!
//! A vote is lost at a distance that shrinks and grows with the pose's scale, so that no shrinking of the cloud can gain
//! votes.

use nalgebra::Matrix3;

use super::scene::Scene;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::planes::Probe;
use crate::robust::vote;

impl Scene<'_> {
    /// Share of the vote explained within `gate_m` (metres of the start), by the probes of `panel` alike.
    pub fn panel_share(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        self.votes_of(panel, city_from_level, gate_m).sum::<f64>() / panel.len().max(1) as f64
    }

    /// That share less the cost of leaving what is known beforehand, so that where the data say nothing the start decides.
    pub fn score(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        self.panel_share(panel, city_from_level, gate_m) - self.prior.cost(city_from_level)
    }

    /// The vote of each probe of `panel`, 0 to 1.
    pub fn panel_votes(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> Vec<f64> {
        self.votes_of(panel, city_from_level, gate_m).collect()
    }

    fn votes_of(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> impl Iterator<Item = f64> {
        let mover = Mover::new(city_from_level);
        let gate_m = gate_m * city_from_level.scale;
        panel.iter().map(move |&i| {
            let hit = self.nearest(&mover.probe(&self.votes.probes[i as usize]), gate_m);
            hit.map_or(0.0, |h| vote(h.distance_sq(), gate_m))
        })
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
