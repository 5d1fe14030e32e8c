//! What speaks for the best pose and holds it, and what its rivals have.

use rayon::prelude::*;

use crate::correspondence::{Basin, Candidate, PointPlaneMatch, PoseRefiner, Scene, refined_to_end};
use crate::evidence::{CandidateEvaluation, EvaluatedCandidate};
use crate::geometry::Similarity;
use crate::robust::{Matrix7, MotionParameters};
use crate::uncertainty::{Estimate, SystematicErrors, estimate};
use crate::verdict::{Evidence, GivenScale, PoseInformation, Rival, SearchSpace};

/// The evidence, and the points that it rests on.
pub(super) struct VerdictInput {
    pub evidence: Evidence,
    /// Which points lie on which planes in the best pose, sorted by plane.
    pub rows: Vec<PointPlaneMatch>,
    /// Points that belong to a patch.
    pub patch_points: usize,
    pub findings: SystematicErrors,
}

/// Candidates and sharpened null poses with their evidence, the best first, then by evidence and start together. The search's best stays
/// first unless another of its poses leads it by more than log2 of one over the false alarms.
pub(super) fn evaluated_candidates(
    evaluation: &CandidateEvaluation,
    scene: &Scene,
    candidates: &[Candidate],
) -> Vec<EvaluatedCandidate> {
    let of_search = |candidate: &Candidate| EvaluatedCandidate {
        weighed: evaluation.weigh(&candidate.refined.city_from_level),
        candidate: candidate.clone(),
        by_chance: false,
    };
    let likelihood = |c: &EvaluatedCandidate| c.weighed.bits + scene.prior.bits(&c.candidate.refined.city_from_level);
    let mut all: Vec<EvaluatedCandidate> = candidates.iter().map(of_search).collect();
    let margin = scene.limits.verdict.margin_bits();
    let best = (1..all.len()).fold(0, |best, i| {
        let lead = if best == 0 { margin } else { 0.0 };
        if likelihood(&all[i]) > likelihood(&all[best]) + lead { i } else { best }
    });
    all.swap(0, best);
    all.extend(evaluation.others.iter().cloned());
    if let [_, others @ ..] = &mut all[..] {
        others.sort_by(|a, b| likelihood(b).total_cmp(&likelihood(a)));
    }
    all
}

/// Gathers what the verdict reads of the poses that were compared; `given_scale` where the scale was given, `accuracy_m` where one is asked for.
pub(super) fn collect(
    refiner: &PoseRefiner,
    evaluation: Option<&CandidateEvaluation>,
    evaluated: &[EvaluatedCandidate],
    given_scale: Option<GivenScale>,
    accuracy_m: Option<f64>,
    space: SearchSpace,
) -> VerdictInput {
    let scene = refiner.scene;
    let best = evaluated.first().map(|best| estimate(refiner, &best.candidate.refined.city_from_level));
    let rows = best.as_ref().map_or(Vec::new(), |best| rows(refiner, &best.city_from_level));
    let hold = hold(refiner, best.as_ref(), given_scale, accuracy_m);
    let findings = best.as_ref().map_or(SystematicErrors::default(), |best| best.findings);
    let rivals = best.as_ref().map_or(Vec::new(), |best| rivals(refiner, evaluated, &best.city_from_level));
    let by_chance = evaluation.map_or(&[][..], |evaluation| &evaluation.by_chance);
    let speaks = |c: &EvaluatedCandidate| c.weighed.by_cloud_plane.iter().filter(|bits| **bits >= SPEAKS_BITS).count();
    let evidence = Evidence {
        space,
        rivals,
        hold,
        witnesses: evaluation.map_or(0, CandidateEvaluation::cloud_planes),
        speaking: evaluated.first().map_or(0, speaks),
        by_chance: by_chance.len(),
        most_by_chance: by_chance.first().copied().unwrap_or(0.0),
    };
    VerdictInput { evidence, rows, patch_points: scene.level_cloud.patch_points, findings }
}

/// The poses as the verdict compares them: the best as estimated, and so those about it, since what the last estimate leads to the best
/// pose is no rival; the search's own gates leave some poses half-way.
fn rivals(refiner: &PoseRefiner, evaluated: &[EvaluatedCandidate], best: &Similarity) -> Vec<Rival> {
    let Some((first, others)) = evaluated.split_first() else { return Vec::new() };
    let place = Basin::around(refiner, best);
    let last = |c: &EvaluatedCandidate| {
        let pose = c.candidate.refined.city_from_level;
        if place.has(&pose) { estimate(refiner, &pose).city_from_level } else { pose }
    };
    let others: Vec<Rival> = others.par_iter().map(|c| rival(refiner, c, &last(c))).collect();
    std::iter::once(rival(refiner, first, best)).chain(others).collect()
}

/// Least evidence for a plane to be counted as supporting a pose, bits. Chosen: what chance gives to two in three.
const SPEAKS_BITS: f64 = 0.5;

fn hold(
    refiner: &PoseRefiner,
    best: Option<&Estimate>,
    given_scale: Option<GivenScale>,
    accuracy_m: Option<f64>,
) -> PoseInformation {
    let (scene, limits) = (refiner.scene, refiner.scene.limits);
    let parameters = best.map_or_else(|| parameters_of_prior(refiner), |best| best.parameters);
    PoseInformation {
        parameters: MotionParameters { center: parameters.center + scene.city.model.origin, ..parameters },
        information: best.map_or_else(Matrix7::zeros, |best| best.information),
        without: best.map_or(Vec::new(), |best| best.without.clone()),
        prior: scene.prior.information(&parameters),
        given_scale,
        accuracy_m: accuracy_m.unwrap_or(limits.verdict.accuracy_m(parameters.radius)),
        confirmed_times: limits.uncertainty.confirmed_times,
    }
}

fn rows(refiner: &PoseRefiner, pose: &Similarity) -> Vec<PointPlaneMatch> {
    let all: Vec<u32> = (0..refiner.scene.level_cloud.sample_points.len() as u32).collect();
    refiner.point_plane_matches(&all, pose, refiner.scene.gate_unit_m)
}

fn rival(refiner: &PoseRefiner, evaluated_candidate: &EvaluatedCandidate, city_from_level: &Similarity) -> Rival {
    let (scene, candidate) = (refiner.scene, &evaluated_candidate.candidate);
    let local = scene.city_from_sfm(city_from_level);
    Rival {
        city_from_sfm: Similarity { translation: local.translation + scene.city.model.origin, ..local },
        bits: evaluated_candidate.weighed.bits,
        prior_bits: scene.prior.bits(city_from_level),
        beyond_start: scene.prior.rules_out(&candidate.refined.city_from_level),
        by_chance: evaluated_candidate.by_chance,
    }
}

/// Where nothing was found: about the place that is expected.
fn parameters_of_prior(refiner: &PoseRefiner) -> MotionParameters {
    refiner.assess(&[], &refiner.scene.prior.expected(), 0.0).parameters
}

/// The scale that the data have, were it free, from a pose on.
pub(super) fn scale_of_data(
    refiner: &PoseRefiner,
    evaluation: &CandidateEvaluation,
    best: &EvaluatedCandidate,
) -> GivenScale {
    let (scene, free) = (refiner.scene, &refiner.with_free_scale());
    let patch_points: Vec<u32> = (0..scene.level_cloud.patch_points as u32).collect();
    let gates_m: Vec<f64> =
        scene.limits.verdict.scale_gates_units.iter().map(|gate| gate * scene.gate_unit_m).collect();
    let near = free.refine(&patch_points, &best.candidate.refined.city_from_level, &gates_m).city_from_level;
    let pose = &refined_to_end(free, &near).city_from_level;
    let found = estimate(free, pose);
    let (pose, parameters) = (&found.city_from_level, found.parameters);
    // What is known beforehand of all else keeps an open height from opening the scale.
    let mut information = scene.prior.information(&parameters);
    information[(6, 6)] = 0.0;
    information += found.information;
    let variance = information.try_inverse().map_or(0.0, |covariance| covariance[(6, 6)]);
    let given = scene.level_cloud.level_from_sfm.scale;
    GivenScale {
        given,
        of_data: given * pose.scale,
        log_sigma: if variance > 0.0 { variance.sqrt() / parameters.radius } else { f64::INFINITY },
        bits: evaluation.weigh(pose).bits,
    }
}
