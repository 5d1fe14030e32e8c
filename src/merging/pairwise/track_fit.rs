//! The similarity that point pairs and camera poses agree on.
//!
//! Method       three pairs give a similarity in closed form ([`umeyama`]), each shared camera gives one alone; the best by consensus is
//!              refined with its bend by the pairs alone, and once more with the cameras that agree with it
//! Source       consensus: MSAC, Torr and Zisserman 2000

use super::camera_rows::CameraRows;
use super::fit::{Fit, Sources, Term, settle};
use super::point_rows::PointRows;
use super::same_place::SamePlace;
use super::shared_tracks::{CameraPair, PointPair, SharedTracks};
use crate::geometry::{Point3, Similarity, umeyama};
use crate::merging::extent::median_point;
use crate::merging::limits::MergeLimits;
use crate::merging::pair_limits::FitLimits;
use crate::robust::{Problem, Random, RansacOptions, ransac};

/// What pairs and cameras give.
#[derive(Clone, Debug)]
pub(super) struct TrackFit {
    pub fit: Fit,
    /// For each shared camera whether it agrees with the pairs.
    pub cameras_used: Vec<bool>,
}

impl TrackFit {
    /// The pairs that were fitted, as they bend.
    pub fn pairs<'a>(&self, tracks: &'a SharedTracks, limits: &'a FitLimits) -> PointRows<'a> {
        PointRows { bend: self.fit.bend, ..PointRows::new(&tracks.pairs, tracks.radius_a, limits) }
    }

    /// The cameras that were fitted.
    pub fn cameras<'a>(&self, tracks: &'a SharedTracks, limits: &'a FitLimits) -> CameraRows<'a> {
        cameras_among(tracks, &self.cameras_used, self.fit.bend, limits)
    }
}

/// Pairs alone first, then the cameras that agree with them.
pub(super) fn fit_tracks(tracks: &SharedTracks, limits: &MergeLimits, seed: u64) -> Option<TrackFit> {
    let mut pairs = PointRows::new(&tracks.pairs, tracks.radius_a, &limits.fit);
    let start = search(&pairs, &tracks.cameras, limits, seed)?;
    let pose = settle(&mut pairs, &start, &limits.fit);
    let all = cameras_among(tracks, &vec![true; tracks.cameras.len()], pairs.bend, &limits.fit);
    let cameras_used = all.agree(&pose);
    let cameras = cameras_among(tracks, &cameras_used, pairs.bend, &limits.fit);
    let sources = Sources { lead: &pairs, others: &[Term { rows: &cameras, factor: 1.0 }] };
    let fit = sources.finish(sources.refine(&pose), &limits.fit);
    Some(TrackFit { fit, cameras_used })
}

fn cameras_among<'a>(tracks: &'a SharedTracks, used: &[bool], bend: f64, limits: &'a FitLimits) -> CameraRows<'a> {
    let cameras = tracks.cameras.iter().zip(used).filter(|(_, used)| **used).map(|(camera, _)| camera).collect();
    CameraRows { cameras, bend: bend * tracks.radius_a, limits: &limits.cameras }
}

/// How much of the pairs the best similarity explains; for comparing with a mirrored part.
pub(super) fn consensus(pairs: &PointRows<'_>, limits: &MergeLimits, seed: u64) -> f64 {
    let Some(start) = search(pairs, &[], limits, seed) else { return 0.0 };
    pairs.votes(&Sources { lead: pairs, others: &[] }.refine(&start))
}

/// The best of three pairs, and of single cameras.
fn search(pairs: &PointRows<'_>, cameras: &[CameraPair], limits: &MergeLimits, seed: u64) -> Option<Similarity> {
    if pairs.pairs.len() < 3 {
        return None;
    }
    let step = pairs.pairs.len().div_ceil(limits.search.scored_pairs);
    let scored: Vec<PointPair> = pairs.pairs.iter().step_by(step).cloned().collect();
    let rows = PointRows::new(pairs.pairs, pairs.radius, pairs.limits);
    let search = Search {
        pairs: pairs.pairs,
        scored: PointRows { pairs: &scored, ..rows },
        same: SamePlace {
            center_b: median_point(pairs.pairs.iter().map(|p| &p.in_b))?,
            radius_a: pairs.radius,
            limits: &limits.search,
        },
    };
    let options = RansacOptions {
        seed,
        keep: limits.search.kept_by_pairs,
        best_of_block: limits.search.kept_by_pairs,
        fewest_samples: limits.search.fewest_pair_samples,
        most_samples: limits.search.most_pair_samples,
        enough_hits: limits.search.enough_hits,
    };
    let (ranked, _) = ransac(&search, &options, |_| true);
    let by_pairs = ranked.first().map(|best| (best.score, best.pose));
    let by_cameras = cameras.iter().filter_map(CameraPair::a_from_b).map(|pose| {
        let refined = Sources { lead: &rows, others: &[] }.refine(&pose);
        (search.score(&refined), refined)
    });
    by_pairs.into_iter().chain(by_cameras).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, pose)| pose)
}

struct Search<'a> {
    pairs: &'a [PointPair],
    scored: PointRows<'a>,
    same: SamePlace<'a>,
}

impl Problem for Search<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        let picked = [0; 3].map(|_| random.below(self.pairs.len()));
        if picked[0] != picked[1] && picked[1] != picked[2] && picked[0] != picked[2] {
            let couples: [(Point3<f64>, Point3<f64>); 3] = picked.map(|i| (self.pairs[i].in_a, self.pairs[i].in_b));
            poses.extend(umeyama(&couples));
        }
    }

    fn score(&self, pose: &Similarity) -> f64 {
        self.scored.votes(pose)
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        self.same.holds(a, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Matrix3, Rotation3, Vector3};

    fn truth() -> Similarity {
        Similarity {
            scale: 1.7,
            rotation: Rotation3::from_euler_angles(0.4, 2.0, -1.0),
            translation: Vector3::new(3.0, -8.0, 1.0),
        }
    }

    fn pair(k: usize) -> PointPair {
        let t = k as f64;
        let in_b = Point3::new((t * 0.7).sin() * 4.0, (t * 1.3).cos() * 3.0, (t * 0.31).sin() * 2.0);
        let covariance = Matrix3::identity() * 1e-6;
        PointPair { in_a: truth().apply(&in_b), in_b, covariance_a: covariance, covariance_b: covariance }
    }

    #[test]
    fn finds_the_similarity_among_as_many_wrong_pairs() {
        let mut pairs: Vec<PointPair> = (0..60).map(pair).collect();
        for k in 0..60 {
            let wrong = pair(k * 7 + 100).in_a;
            pairs.push(PointPair { in_a: wrong, ..pair(k + 200) });
        }
        let tracks = SharedTracks {
            photos: Vec::new(),
            pairs,
            cameras: Vec::new(),
            chance: 0.0,
            fewer_keypoints: 120,
            radius_a: 8.0,
            own_error: [0.0; 2],
        };
        let TrackFit { fit, .. } = fit_tracks(&tracks, &MergeLimits::default(), 1).unwrap();
        let p = Point3::new(1.0, 2.0, 3.0);
        assert!((fit.a_from_b.apply(&p) - truth().apply(&p)).norm() < 0.02, "{fit:?}");
    }
}
