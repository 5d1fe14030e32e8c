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
//! Fails when   pairs and planes are wrong together; the cameras and the shape are judged apart from this ([`super::judge`])

use super::Part;
use super::disagreement::{Apart, apart};
use super::evidence::Evidence;
use super::fit::{Fit, PlaneTerm, fit_of_pairs, fit_with_planes};
use super::plane_evidence::PlaneEvidence;
use super::plane_fit::{PlaneFit, settle, share_on_planes};
use super::plane_judge::{FEWEST_ON_PLANES, too_few};
use super::plane_search::fit_planes;
use super::whole_planes::whole_planes;

/// The planes contradict a place where less than this share of what agrees at their own place agrees ...
const CONTRADICTED: f64 = 0.5;
/// ... or where their own is further away than this share of the radius, and than their sigmas: no bend of a sound part does that.
const ELSEWHERE: f64 = 0.05;

pub(super) struct Joint {
    pub fit: Fit,
    /// What is to be said of the sources although the parts are joined.
    pub note: Option<String>,
    /// Why the parts cannot be joined.
    pub contradiction: Option<String>,
}

pub(super) fn with_planes(evidence: &Evidence, by_pairs: Fit, planes: &PlaneEvidence, seed: u64) -> Joint {
    let alone = |fit: Fit, note: Option<String>| Joint { fit, note, contradiction: None };
    if too_few(planes).is_some() {
        return alone(by_pairs, None);
    }
    let Some(own) = fit_planes(planes, seed) else { return alone(by_pairs, None) };
    let own_share = share_on_planes(planes, &own.fit.a_from_b);
    if own_share < FEWEST_ON_PLANES {
        let note = format!(
            "the planes of the superpixels were left out: only {:.0} % of the points on them agree with one similarity",
            100.0 * own_share
        );
        return alone(by_pairs, Some(note));
    }
    let share = share_on_planes(planes, &by_pairs.a_from_b);
    let apart = apart(&own.fit, &by_pairs.a_from_b);
    if share < CONTRADICTED * own_share || apart.disagree() && apart.share > ELSEWHERE {
        let contradiction = contradiction(&apart, share, own_share);
        return Joint { fit: by_pairs, note: None, contradiction: Some(contradiction) };
    }
    let fit = joint_fit(evidence, &by_pairs, planes);
    let note = disagreement(&own, &by_pairs, &fit);
    alone(fit, note)
}

/// The joint estimate once more, on all surfaces that both parts have instead of those in shared photographs alone.
pub(super) fn on_whole_parts(evidence: &Evidence, by_pairs: &Fit, joint: Joint, [a, b]: [&Part; 2]) -> Joint {
    if joint.contradiction.is_some() {
        return joint;
    }
    match whole_planes(a, b, &joint.fit.a_from_b, joint.fit.bend) {
        Some(planes) => Joint { fit: joint_fit(evidence, by_pairs, &planes), ..joint },
        None => joint,
    }
}

fn contradiction(apart: &Apart, share: f64, own_share: f64) -> String {
    format!(
        "the point pairs and the planes of the superpixels contradict each other: where the pairs put the parts {:.0} % of the points \
         lie on their planes, but {:.0} % do in a place that is {} away",
        100.0 * share,
        100.0 * own_share,
        apart.told()
    )
}

fn joint_fit(evidence: &Evidence, by_pairs: &Fit, planes: &PlaneEvidence) -> Fit {
    let (pairs_alone, pairs_effect) = fit_of_pairs(evidence, by_pairs);
    let near = settle(planes, &by_pairs.a_from_b);
    let doubt = near.design_effect * apart(&near.fit, &pairs_alone.a_from_b).birge();
    let term = PlaneTerm { evidence: planes, bend: near.fit.bend / planes.radius[0], factor: pairs_effect / doubt };
    fit_with_planes(evidence, by_pairs, term)
}

/// What is said where a source by itself is further from the joint estimate than its sigmas allow.
fn disagreement(planes: &PlaneFit, by_pairs: &Fit, joint: &Fit) -> Option<String> {
    let sources = [("planes of the superpixels", &planes.fit), ("point pairs and camera poses", by_pairs)];
    let told: Vec<String> = sources
        .into_iter()
        .map(|(name, own)| (name, apart(own, &joint.a_from_b)))
        .filter(|(_, apart)| apart.disagree())
        .map(|(name, apart)| format!("the {name} by themselves put the parts {} off the joint estimate", apart.told()))
        .collect();
    (!told.is_empty()).then(|| told.join("; "))
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Pair;
    use super::super::fit::fit;
    use super::super::plane_scene::{RADIUS, scene, truth};
    use super::*;
    use crate::geometry::{Matrix3, Point3, Vector3};

    const NOISE: f64 = 0.002;

    /// Pairs that put part b where it is, but for a shift (a's units).
    fn pairs(shift: f64) -> Evidence {
        let pair = |k: usize| {
            let t = k as f64;
            let in_a = Point3::new((t * 0.7).sin() * 4.0, (t * 1.3).cos() * 3.0, (t * 0.31).sin() * 3.0);
            let noise = Vector3::new((t * 1.9).sin(), (t * 2.3).sin(), (t * 2.9).sin()) * NOISE;
            Pair {
                in_a: in_a + Vector3::new(0.0, shift, 0.0) + noise,
                in_b: truth().inverse().apply(&in_a),
                covariance_a: Matrix3::identity() * (NOISE * NOISE),
                covariance_b: Matrix3::identity() * (NOISE * NOISE / 3.0),
            }
        };
        Evidence {
            photos: Vec::new(),
            pairs: (0..80).map(pair).collect(),
            cameras: Vec::new(),
            chance: 0.0,
            fewer_keypoints: 80,
            radius_a: RADIUS,
            own_error: [0.0; 2],
        }
    }

    fn joined(shift: f64, planes: &PlaneEvidence) -> (Fit, Joint) {
        let evidence = pairs(shift);
        let by_pairs = fit(&evidence, 1).unwrap();
        (by_pairs.clone(), with_planes(&evidence, by_pairs, planes, 1))
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
        assert!(joint.contradiction.is_some_and(|told| told.contains("contradict each other")));
    }

    #[test]
    fn planes_that_agree_on_nothing_are_left_out() {
        let (by_pairs, joint) = joined(0.0, &scene(NOISE, |x| *x).shuffled());
        assert_eq!(joint.fit.a_from_b, by_pairs.a_from_b);
        assert!(joint.note.is_some_and(|note| note.contains("left out")));
    }
}
