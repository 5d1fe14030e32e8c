//! All sources of two parts in one estimate: point pairs, camera poses and planes of superpixels.
//!
//! Question     what do the planes add to the pairs and poses, and does each source say the same by itself?
//! Input        the fit of pairs and cameras, and the planes
//! Output       [`Joint`]: the common fit; a note where a source was left out or disagrees; a contradiction where two sources are
//!              each sure of another place
//! Method       1. The planes alone are searched and settled; where they agree on nothing they are left out.
//!              2. Where they agree with each other elsewhere, and with the pairs' place much worse, nobody can tell who is right.
//!              3. Else both enter one robust least squares. The planes' weight against the pairs' is the ratio of their design
//!                 effects, and less by as much as their own answer is further from the pairs' than their sigmas allow: so a source
//!                 pulls the less, the less it can be right.
//!              4. Once more in the same way, with all surfaces that both parts have in place of the superpixels.
//! Assumptions  the pairs are the firmer source, since they hold three directions each
//! Fails when   pairs and planes are wrong together; the cameras and the shape are checked apart from this ([`super::decision`])

use super::disagreement::difference;
use super::fit::{Fit, OwnFit, Sources, Term, own_fit};
use super::on_planes::{share_on_planes, too_few};
use super::plane_rows::{PlaneRows, settle_planes};
use super::plane_search::fit_planes;
use super::planes::SharedPlanes;
use super::shared_tracks::SharedTracks;
use super::track_fit::TrackFit;
use super::whole_planes::whole_planes;
use crate::merging::fault::PairFault;
use crate::merging::limits::MergeLimits;
use crate::merging::prepared::PreparedPart;

/// What all sources say together.
pub(super) struct Joint {
    pub fit: Fit,
    /// What is to be said of the sources although the parts are joined.
    pub note: Option<String>,
    /// Why the parts cannot be joined.
    pub contradiction: Option<PairFault>,
}

/// Pairs and cameras, to which planes are added.
#[derive(Clone, Copy)]
pub(super) struct TrackEstimate<'a> {
    pub tracks: &'a SharedTracks,
    pub found: &'a TrackFit,
    pub limits: &'a MergeLimits,
}

impl TrackEstimate<'_> {
    /// The answer without planes.
    pub fn alone(&self, note: Option<String>) -> Joint {
        Joint { fit: self.found.fit.clone(), note, contradiction: None }
    }

    /// The answer with the planes of superpixels, where there are enough of them.
    pub fn with_planes(&self, planes: &SharedPlanes, seed: u64) -> Joint {
        let (by_pairs, limits) = (&self.found.fit, self.limits);
        if too_few(planes, &limits.decision).is_some() {
            return self.alone(None);
        }
        let Some(own) = fit_planes(planes, limits, seed) else { return self.alone(None) };
        let own_share = share_on_planes(planes, &own.fit.a_from_b, limits.sources.on_plane);
        if own_share < limits.decision.agreeing_share {
            return self.alone(Some(format!(
                "the planes of the superpixels were left out: only {:.0} % of the points on them agree with one similarity",
                100.0 * own_share
            )));
        }
        let share = share_on_planes(planes, &by_pairs.a_from_b, limits.sources.on_plane);
        let apart = difference(&own.fit, &by_pairs.a_from_b);
        let is_elsewhere = apart.is_disagreement(limits) && apart.share > limits.sources.elsewhere;
        if share < limits.sources.contradicted_share * own_share || is_elsewhere {
            let fault = PairFault::SourcesContradict { share, own_share, apart: apart.told() };
            return Joint { contradiction: Some(fault), ..self.alone(None) };
        }
        let fit = self.joint_fit(planes);
        let note = self.disagreement(&own, &fit);
        Joint { fit, note, contradiction: None }
    }

    /// The joint estimate once more, on all surfaces that both parts have instead of those in shared photographs alone.
    pub fn on_whole_parts(&self, joint: Joint, parts: [&PreparedPart<'_>; 2]) -> Joint {
        if joint.contradiction.is_some() {
            return joint;
        }
        match whole_planes(parts, &joint.fit.a_from_b, joint.fit.bend * self.tracks.radius_a, self.limits) {
            Some(planes) => Joint { fit: self.joint_fit(&planes), ..joint },
            None => joint,
        }
    }

    fn joint_fit(&self, planes: &SharedPlanes) -> Fit {
        let (limits, place) = (&self.limits.fit, &self.found.fit.a_from_b);
        let pairs = self.found.pairs(self.tracks, limits);
        let cameras = self.found.cameras(self.tracks, limits);
        let pairs_alone = own_fit(&pairs, Sources { lead: &pairs, others: &[] }.refine(place), limits);
        let near = settle_planes(planes, place, limits);
        let rows = PlaneRows { planes, bend: near.fit.bend, limits };
        let doubt = near.design_effect * difference(&near.fit, &pairs_alone.fit.a_from_b).birge();
        let others =
            [Term { rows: &cameras, factor: 1.0 }, Term { rows: &rows, factor: pairs_alone.design_effect / doubt }];
        let sources = Sources { lead: &pairs, others: &others };
        sources.finish(sources.refine(place), limits)
    }

    /// What is said where a source by itself is further from the joint estimate than its sigmas allow.
    fn disagreement(&self, planes: &OwnFit, joint: &Fit) -> Option<String> {
        let sources = [("planes of the superpixels", &planes.fit), ("point pairs and camera poses", &self.found.fit)];
        let told: Vec<String> = sources
            .into_iter()
            .map(|(name, own)| (name, difference(own, &joint.a_from_b)))
            .filter(|(_, apart)| apart.is_disagreement(self.limits))
            .map(|(name, apart)| {
                format!("the {name} by themselves put the parts {} off the joint estimate", apart.told())
            })
            .collect();
        (!told.is_empty()).then(|| told.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::super::shared_tracks::PointPair;
    use super::super::test_scene::{RADIUS, scene, truth};
    use super::super::track_fit::fit_tracks;
    use super::*;
    use crate::geometry::{Matrix3, Point3, Vector3};

    const NOISE: f64 = 0.002;

    /// Pairs that put part b where it is, but for a shift (a's units).
    fn pairs(shift: f64) -> SharedTracks {
        let pair = |k: usize| {
            let t = k as f64;
            let in_a = Point3::new((t * 0.7).sin() * 4.0, (t * 1.3).cos() * 3.0, (t * 0.31).sin() * 3.0);
            let noise = Vector3::new((t * 1.9).sin(), (t * 2.3).sin(), (t * 2.9).sin()) * NOISE;
            PointPair {
                in_a: in_a + Vector3::new(0.0, shift, 0.0) + noise,
                in_b: truth().inverse().apply(&in_a),
                covariance_a: Matrix3::identity() * (NOISE * NOISE),
                covariance_b: Matrix3::identity() * (NOISE * NOISE / 3.0),
            }
        };
        SharedTracks {
            photos: Vec::new(),
            pairs: (0..80).map(pair).collect(),
            cameras: Vec::new(),
            chance: 0.0,
            fewer_keypoints: 80,
            radius_a: RADIUS,
            own_error: [0.0; 2],
        }
    }

    fn joined(shift: f64, planes: &SharedPlanes) -> (Fit, Joint) {
        let tracks = pairs(shift);
        let limits = MergeLimits::default();
        let by_pairs = fit_tracks(&tracks, &limits, 1).unwrap();
        let estimate = TrackEstimate { tracks: &tracks, found: &by_pairs, limits: &limits };
        let joint = estimate.with_planes(planes, 1);
        (by_pairs.fit, joint)
    }

    #[test]
    fn sources_that_agree_are_joined_without_a_word() {
        let (by_pairs, joint) = joined(0.0, &scene(NOISE, |x| *x));
        assert!(joint.note.is_none() && joint.contradiction.is_none(), "{:?}", joint.note);
        // The planes add information.
        assert!(joint.fit.information.trace() > by_pairs.information.trace());
        let x = truth().inverse().apply(&Point3::new(2.0, 3.0, 1.0));
        assert!((joint.fit.a_from_b.apply(&x) - truth().apply(&x)).norm() < 3.0 * NOISE);
    }

    #[test]
    fn a_disagreement_beyond_the_sigmas_is_told_and_pulls_little() {
        let shift = 0.05;
        let (by_pairs, joint) = joined(shift, &scene(NOISE, |x| *x));
        assert!(joint.contradiction.is_none(), "{:?}", joint.contradiction);
        assert!(
            joint.note.as_ref().is_some_and(|note| note.contains("planes of the superpixels by themselves")),
            "{:?}",
            joint.note
        );
        let x = truth().inverse().apply(&Point3::origin());
        let pulled = (joint.fit.a_from_b.apply(&x) - by_pairs.a_from_b.apply(&x)).norm();
        assert!(pulled < 0.2 * shift, "{pulled}");
    }

    #[test]
    fn two_sources_that_are_sure_of_two_places_contradict_each_other() {
        let (_, joint) = joined(0.5, &scene(NOISE, |x| *x));
        assert!(matches!(joint.contradiction, Some(PairFault::SourcesContradict { .. })));
    }

    #[test]
    fn planes_that_agree_on_nothing_are_left_out() {
        let (by_pairs, joint) = joined(0.0, &scene(NOISE, |x| *x).shuffled());
        assert_eq!(joint.fit.a_from_b, by_pairs.a_from_b);
        assert!(joint.note.is_some_and(|note| note.contains("left out")));
    }
}
