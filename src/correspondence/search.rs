//! The robust search for poses: minimal samples over patch-plane pairs, scored on facets.

use super::pairing::{Pairing, Sample};
use super::scoring::Scorer;
use crate::geometry::{Point3, Rotation3, Similarity, Vector3};
use crate::robust::{Problem, Random};

/// The alignment as the robust loop sees it. Poses are `city_from_level`.
pub struct PoseSearch<'a> {
    pub pairing: Pairing<'a>,
    pub scorer: &'a Scorer<'a>,
    /// Probes that rank hypotheses.
    pub panel: Vec<u32>,
    /// Within this distance a vote counts for a hypothesis, metres of the start: a minimal sample extrapolates the noise of a few
    /// patches over the whole scene.
    pub gate_m: f64,
}

/// Poses that move no corner of the scene by more than this are one place of the search: within the basin of refinement.
const SAME_PLACE_M: f64 = 1.5;

impl Problem for PoseSearch<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        let Some(sample) = self.pairing.draw(random) else { return };
        poses.extend(self.solve(&sample).into_iter().filter(|pose| self.scorer.within_reach(pose)));
    }

    fn score(&self, pose: &Similarity) -> f64 {
        self.scorer.panel_share(&self.panel, pose, self.gate_m) - self.scorer.prior_cost(pose)
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        largest_shift(a, b, self.scorer.votes.radius_m) < SAME_PLACE_M
    }
}

impl PoseSearch<'_> {
    fn solve(&self, sample: &Sample) -> Option<Similarity> {
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), sample.heading_rad);
        let e = &sample.expected;
        (e[0] > 0.0).then_some(Similarity { scale: e[0], rotation, translation: Vector3::new(e[1], e[2], e[3]) })
    }
}

/// The largest distance between the images of six places round the middle of the level frame.
pub fn largest_shift(a: &Similarity, b: &Similarity, radius_m: f64) -> f64 {
    let r = radius_m;
    let places =
        [[r, 0.0, 0.0], [-r, 0.0, 0.0], [0.0, r, 0.0], [0.0, -r, 0.0], [0.0, 0.0, r / 3.0], [0.0, 0.0, -r / 3.0]];
    places
        .iter()
        .map(|p| Point3::from(Vector3::from(*p)))
        .map(|p| (a.apply(&p) - b.apply(&p)).norm())
        .fold(0.0, f64::max)
}
