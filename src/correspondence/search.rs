//! The robust search for poses: minimal samples over patch-plane pairs, scored on facets.

use super::pairing::{Pair, Pairing, Sample};
use super::scoring::Scorer;
use super::votes::LevelPatch;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::robust::{Problem, Random};
use crate::solvers::{Poses, Row, Up, upright_se3_4pt, upright_sim3_5pt};

/// The alignment as the robust loop sees it. Poses are `city_from_level`.
pub struct PoseSearch<'a> {
    pub pairing: Pairing<'a>,
    pub scorer: &'a Scorer<'a>,
    /// The vertical, common to both frames.
    pub up: Up,
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
        poses.extend(self.solve(&sample).iter().filter(|pose| self.scorer.within_reach(pose)));
    }

    fn score(&self, pose: &Similarity) -> f64 {
        self.scorer.panel_share(&self.panel, pose, self.gate_m) - self.scorer.prior_cost(pose)
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        largest_shift(a, b, self.scorer.votes.radius_m) < SAME_PLACE_M
    }
}

impl PoseSearch<'_> {
    /// The poses that lay the sample's patches on their planes. The first patch gives two points, since its plane fixes the
    /// heading; every other pair gives one; what they leave open is completed from the start.
    fn solve(&self, sample: &Sample) -> Poses {
        let patch = |pair: &Pair| &self.scorer.votes.patches[pair.patch as usize];
        let on = |point: Vector3<f64>, pair: &Pair| Row {
            point: point * self.pairing.scale().unwrap_or(1.0),
            normal: pair.target.normal,
            offset: pair.target.offset,
        };
        let Some(first) = sample.pairs.first() else { return Poses::none() };
        let along = first_axis(patch(first));
        let rows: Vec<Row> = [1.0, -1.0]
            .into_iter()
            .map(|side| on(patch(first).center.coords + along * side, first))
            .chain(sample.pairs[1..].iter().map(|pair| on(patch(pair).center.coords, pair)))
            .chain(sample.completion.iter().copied())
            .collect();
        match self.pairing.scale() {
            None => <&[Row; 5]>::try_from(&rows[..]).map_or(Poses::none(), |rows| upright_sim3_5pt(rows, &self.up)),
            Some(scale) => {
                let poses =
                    <&[Row; 4]>::try_from(&rows[..]).map_or(Poses::none(), |rows| upright_se3_4pt(rows, &self.up));
                let mut scaled = Poses::none();
                poses.iter().for_each(|pose| scaled.push(Similarity { scale, ..*pose }));
                scaled
            }
        }
    }
}

/// The level direction in a patch's plane, as long as the patch: two points along it have the heading of the plane.
fn first_axis(patch: &LevelPatch) -> Vector3<f64> {
    let level = Vector3::z().cross(&patch.normal).try_normalize(0.0).unwrap_or_default();
    let [a, b] = [0, 1].map(|k| patch.axes[k].dot(&level) * patch.spread[k]);
    level * (a * a + b * b).sqrt().max(f64::MIN_POSITIVE)
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
