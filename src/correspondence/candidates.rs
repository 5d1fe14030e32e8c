//! From many hypotheses to a few distinct poses, each as good as it can be made.
//!
//! Method       stages with more sample points and narrower gates refine poses, move them along weak directions and rank fewer and fewer of them. From the second stage on a
//!              pose also pays for every line of sight that it would block, and better poses in the basins beside join before the
//!              last. Distinct poses stay distinct to the end: the verdict reads the distance to the runner-up.

use rayon::prelude::*;

use super::line_search::{basin_hopping, search_free_directions, search_weak_directions};
use super::pose_search::largest_shift;
use super::refine::{PoseRefiner, RefinedPose};
use super::scene::Scene;
use super::search::Hypotheses;
use crate::geometry::Similarity;
use crate::limits::StageLimits;

/// A pose that survived to the end.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub refined: RefinedPose,
    /// Inlier share: weight of the sample points that lie on the city.
    pub share: f64,
    /// Weight of the sample points whose lines of sight the city would block.
    pub occluded: f64,
    /// What leaving the start costs.
    pub prior_cost: f64,
    /// Samples of the search that led here.
    pub hits: usize,
}

impl Candidate {
    /// What speaks for the pose less what speaks against it.
    pub fn total_score(&self) -> f64 {
        self.share - self.occluded - self.prior_cost
    }
}

/// The distinct poses that hypotheses lead to, best first.
pub fn candidates(refiner: &PoseRefiner, hypotheses: &Hypotheses) -> Vec<Candidate> {
    let scene = refiner.scene;
    let unranked =
        |ranked: &crate::robust::Ranked<Similarity>| Candidate { hits: ranked.hits, ..unjudged(refiner, &ranked.pose) };
    let mut candidates: Vec<Candidate> = hypotheses.ranked.iter().map(unranked).collect();
    for stage in &scene.limits.refinement.stages {
        if stage.basins {
            candidates.extend(beside(refiner, &candidates));
        }
        candidates = candidates.par_iter().map(|c| improved(refiner, stage, c)).collect();
        candidates.retain(|c| scene.prior.reaches(&c.refined.city_from_level));
        candidates = distinct(candidates, scene, stage.keep);
    }
    candidates.iter_mut().for_each(|c| c.refined = refined_to_end(refiner, &c.refined.city_from_level));
    candidates
}

/// A pose as a candidate of the last stage, not moved.
pub fn candidate_at(refiner: &PoseRefiner, pose: &Similarity) -> Candidate {
    let [.., last] = &refiner.scene.limits.refinement.stages;
    judged(refiner.scene, last, unjudged(refiner, pose))
}

/// Candidates of one view of a cloud, joined by those of another view (up taken otherwise): each of these with the map between the level
/// frames.
pub fn joined(refiner: &PoseRefiner, own: Vec<Candidate>, others: &[(Similarity, Candidate)]) -> Vec<Candidate> {
    let scene = refiner.scene;
    let seen_here = |(other_from_level, other): &(Similarity, Candidate)| {
        // Level frames of one start differ by a turn: the scale is the same to the bit.
        let pose = other.refined.city_from_level * *other_from_level;
        let pose = Similarity { scale: other.refined.city_from_level.scale, ..pose };
        Candidate { refined: refined_to_end(refiner, &pose), hits: other.hits, ..candidate_at(refiner, &pose) }
    };
    let all = own.into_iter().chain(others.iter().map(seen_here)).collect();
    let [.., last] = &scene.limits.refinement.stages;
    distinct(all, scene, last.keep)
}

/// A pose made sharp once more, with a gate as narrow as the residuals allow: what lies beyond is somebody else's facet.
pub fn refined_to_end(refiner: &PoseRefiner, pose: &Similarity) -> RefinedPose {
    let scene = refiner.scene;
    let (patch_points, all) =
        (sample_points(scene.level_cloud.patch_points), sample_points(scene.level_cloud.sample_points.len()));
    let sharp = refiner.sharpen(&patch_points, pose, scene.gate_unit_m);
    search_free_directions(
        refiner,
        &all,
        sharp,
        scene.gate_unit_m,
        scene.limits.line_search.settling_units * scene.gate_unit_m,
    )
}

fn sample_points(count: usize) -> Vec<u32> {
    (0..count as u32).collect()
}

/// Better poses in basins beside those of the candidates, which stay: one that is far enough off remains a rival.
fn beside(refiner: &PoseRefiner, candidates: &[Candidate]) -> Vec<Candidate> {
    let point_subset = refiner.scene.level_cloud.point_subset(refiner.scene.limits.line_search.basin_points);
    candidates
        .par_iter()
        .map(|c| unjudged(refiner, &basin_hopping(refiner, &point_subset, &c.refined.city_from_level)))
        .collect()
}

fn unjudged(refiner: &PoseRefiner, pose: &Similarity) -> Candidate {
    let refined = refiner.assess(&[], pose, 0.0);
    Candidate { refined, share: 0.0, occluded: 0.0, prior_cost: 0.0, hits: 0 }
}

fn improved(refiner: &PoseRefiner, stage: &StageLimits, candidate: &Candidate) -> Candidate {
    let scene = refiner.scene;
    let point_subset = point_subset(scene, stage);
    let gates_m: Vec<f64> = stage.gates_units.iter().map(|g| g * scene.gate_unit_m).collect();
    let first = refiner.refine(&point_subset, &candidate.refined.city_from_level, &gates_m);
    let spectrum = first.parameters.spectrum(&first.equations.full());
    let (scoring_points, gate_m) = (scoring_points(scene, stage), stage.ranking_gate_units * scene.gate_unit_m);
    let slid =
        search_weak_directions(scene, &scoring_points, &first.parameters, &spectrum, &first.city_from_level, gate_m);
    let refined = if slid == first.city_from_level { first } else { refiner.refine(&point_subset, &slid, &gates_m) };
    judged(scene, stage, Candidate { refined, ..candidate.clone() })
}

/// What speaks for and against the pose of a candidate, by the point subset of a stage.
fn judged(scene: &Scene, stage: &StageLimits, candidate: Candidate) -> Candidate {
    let pose = candidate.refined.city_from_level;
    let occluded = if stage.occlusion { blocked_share(scene, &pose) } else { 0.0 };
    let share = scene.inlier_share(&scoring_points(scene, stage), &pose, stage.ranking_gate_units * scene.gate_unit_m);
    Candidate { share, occluded, prior_cost: scene.prior.cost(&pose), ..candidate }
}

/// The sample points that refine.
fn point_subset(scene: &Scene, stage: &StageLimits) -> Vec<u32> {
    if stage.sample_points < scene.level_cloud.patch_points {
        scene.level_cloud.point_subset(stage.sample_points)
    } else {
        sample_points(scene.level_cloud.patch_points)
    }
}

/// Points of no patch have no weight in the score.
fn scoring_points(scene: &Scene, stage: &StageLimits) -> Vec<u32> {
    scene.level_cloud.point_subset(
        stage.sample_points.min(scene.level_cloud.patch_points).min(scene.limits.refinement.most_scoring_points),
    )
}

fn blocked_share(scene: &Scene, pose: &Similarity) -> f64 {
    let occluded = scene.occluded(&scene.level_cloud.point_subset(scene.limits.refinement.traced_points), pose);
    occluded.iter().filter(|b| **b).count() as f64 / occluded.len().max(1) as f64
}

/// The best `keep` of those that are truly different, best first.
fn distinct(mut candidates: Vec<Candidate>, scene: &Scene, keep: usize) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.total_score().total_cmp(&a.total_score()));
    let same_m = scene.limits.refinement.same_pose_units * scene.gate_unit_m;
    let mut kept: Vec<Candidate> = Vec::new();
    for c in candidates {
        let shift = |k: &Candidate| {
            largest_shift(&k.refined.city_from_level, &c.refined.city_from_level, scene.level_cloud.radius_m)
        };
        match kept.iter_mut().find(|k| shift(k) < same_m) {
            Some(same) => same.hits += c.hits,
            None => kept.push(c),
        }
    }
    kept.truncate(keep);
    kept
}

#[cfg(test)]
mod tests;
