//! What point pairs say on whether two parts belong together.

use super::decision::{PairChecks, PairDecision, Stretch, Words, mirrored};
use super::fit::Fit;
use super::point_rows::PointRows;
use super::shared_tracks::{PointPair, SharedTracks};
use super::track_fit::consensus;
use crate::geometry::{Matrix3, Point3, Vector3};
use crate::merging::fault::PairFault;
use crate::merging::limits::MergeLimits;
use crate::robust::median;

pub(super) struct TrackChecks<'a> {
    pub tracks: &'a SharedTracks,
    pub fit: Option<&'a Fit>,
    pub limits: &'a MergeLimits,
    pub seed: u64,
}

impl PairChecks for TrackChecks<'_> {
    fn words(&self) -> Words {
        Words { holds: "point pairs", counted: "point pairs" }
    }

    fn shortage(&self) -> Option<PairDecision> {
        let limits = &self.limits.decision;
        let SharedTracks { chance, fewer_keypoints, ref pairs, ref photos, .. } = *self.tracks;
        let (pairs, photos) = (pairs.len(), photos.len());
        let needed = (limits.chance_factor * chance).max(chance + limits.chance_sigmas * chance.sqrt());
        let is_chance = pairs as f64 <= needed || pairs < limits.fewest_pairs;
        let fault = PairFault::OtherPhotographs { photos, pairs, keypoints: fewer_keypoints, chance };
        is_chance.then_some(PairDecision::Rejected(fault))
    }

    fn fit(&self) -> Result<&Fit, PairFault> {
        self.fit.ok_or(PairFault::NoSimilarityOfPairs { pairs: self.tracks.pairs.len() })
    }

    fn disagreement(&self, fit: &Fit) -> Option<PairDecision> {
        let limits = &self.limits.decision;
        let (pairs, inliers) = (self.tracks.pairs.len(), fit.inlier_count());
        if (inliers as f64) < limits.agreeing_share * pairs as f64 || inliers < limits.fewest_pairs {
            return Some(PairDecision::Rejected(PairFault::FewPairsAgree { inliers, pairs }));
        }
        if fit.bend > limits.most_bend {
            return Some(PairDecision::Rejected(PairFault::Bent { bend: fit.bend }));
        }
        mirrored(self.mirror_gain(fit), limits)
    }

    /// The affine map of the inliers alone. Directions in which the pairs do not spread say nothing of stretch: they are
    /// held at that of the similarity.
    fn stretch(&self, fit: &Fit) -> Option<Stretch> {
        let inliers: Vec<&PointPair> =
            self.tracks.pairs.iter().zip(&fit.inliers).filter(|(_, i)| **i).map(|(p, _)| p).collect();
        let count = inliers.len() as f64;
        let moved: Vec<Vector3<f64>> = inliers.iter().map(|p| fit.a_from_b.apply(&p.in_b).coords).collect();
        let mean_x = moved.iter().sum::<Vector3<f64>>() / count;
        let mean_y = inliers.iter().map(|p| p.in_a.coords).sum::<Vector3<f64>>() / count;
        let (mut xx, mut yx) = (Matrix3::zeros(), Matrix3::zeros());
        for (x, p) in moved.iter().zip(&inliers) {
            let (dx, dy) = (x - mean_x, p.in_a.coords - mean_y);
            xx += dx * dx.transpose();
            yx += dy * dx.transpose();
        }
        let hold = xx.trace() * self.limits.decision.stretch_hold * Matrix3::identity();
        let affine = (yx + hold) * (xx + hold).try_inverse()?;
        let off = |(x, p): (&Vector3<f64>, &&PointPair)| (affine * (x - mean_x) - (p.in_a.coords - mean_y)).norm();
        let mut by_affine: Vec<f64> = moved.iter().zip(&inliers).map(off).collect();
        let mut by_similarity: Vec<f64> = moved.iter().zip(&inliers).map(|(x, p)| (x - p.in_a.coords).norm()).collect();
        let values = affine.singular_values();
        let rest = median(&mut by_affine)? / median(&mut by_similarity)?.max(f64::MIN_POSITIVE);
        Some(Stretch { ratio: values.max() / values.min(), rest })
    }
}

impl TrackChecks<'_> {
    /// How many times more of the pairs a similarity explains where part b is mirrored.
    fn mirror_gain(&self, fit: &Fit) -> f64 {
        let pairs = &self.tracks.pairs;
        let rows = PointRows { bend: fit.bend, ..PointRows::new(pairs, self.tracks.radius_a, &self.limits.fit) };
        let in_the_mirror: Vec<PointPair> =
            pairs.iter().map(|p| PointPair { in_b: Point3::from(-p.in_b.coords), ..p.clone() }).collect();
        consensus(&PointRows { pairs: &in_the_mirror, ..rows }, self.limits, self.seed) / rows.votes(&fit.a_from_b)
    }
}
