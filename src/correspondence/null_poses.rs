//! Poses fitted to the city by chance: what a wrong answer of the search looks like.
//!
//! Question     how well do poses lie on the city that were found as the answer was, but at other places?
//! Input        a scene whose prior reaches beyond the search's, over places where the cloud does not stand
//! Output       poses at distinct places, each the best of a batch of minimal samples, refined
//! Method       the search's own samples, scores and refinement, in batches of fixed size; each batch gives one pose. A place counts once
//!              however often it is found: a search takes the best of all places, and where the model is one house most samples meet it
//! Why          poses at random places lie on far fewer planes than poses that were fitted; a chance taken from them makes every
//!              fitted pose look right

use rayon::prelude::*;

use super::pose_search::PoseSearch;
use super::refine::{PoseRefiner, RefinedPose};
use super::sampler::Sampler;
use super::search::sought;
use super::solver_choice::{cheapest, solver_costs};
use crate::geometry::Similarity;
use crate::limits::NullPoseLimits;
use crate::robust::{Direction, MotionParameters, Problem, Random};

/// So many poses at distinct places, none of which is that of `answer`; fewer where the samples allow no more.
pub fn null_poses(refiner: &PoseRefiner, answer: &Basin, seed: u64, limits: &NullPoseLimits) -> Vec<RefinedPose> {
    let scene = refiner.scene;
    let (sampler, sought, point_subset) =
        (Sampler::new(scene), sought(scene), scene.level_cloud.point_subset(limits.ranking_points));
    let with =
        |configuration| PoseSearch { scene, sampler: &sampler, sought, configuration, point_subset: &point_subset };
    let searches: Vec<PoseSearch> = sought.configurations().iter().map(with).collect();
    let Some(configuration) = cheapest(&solver_costs(&searches, &scene.limits.search), &scene.limits.search) else {
        return Vec::new();
    };
    let search = with(&configuration);
    let refining = scene.level_cloud.point_subset(limits.refining_points);
    let gates_m: Vec<f64> = limits.gates_units.iter().map(|gate| gate * scene.gate_unit_m).collect();
    let is_elsewhere = |pose: &Similarity| !answer.has(pose);
    let of_batch = |batch: u64| {
        let best = best_of(&search, seed, batch, limits.samples, is_elsewhere)?;
        let refined = refiner.refine(&refining, &best, &gates_m);
        is_elsewhere(&refined.city_from_level).then_some(refined)
    };
    let mut places: Vec<Basin> = Vec::with_capacity(limits.count);
    let mut found: Vec<RefinedPose> = Vec::with_capacity(limits.count);
    for round in 0..limits.most_rounds {
        let first = round * limits.count as u64;
        let batches = first..first + limits.count as u64;
        let round: Vec<Option<RefinedPose>> = batches.into_par_iter().map(of_batch).collect();
        for refined in round.into_iter().flatten() {
            if found.len() < limits.count && !places.iter().any(|place| place.has(&refined.city_from_level)) {
                places.push(Basin::around(refiner, &refined.city_from_level));
                found.push(refined);
            }
        }
        if found.len() >= limits.count {
            break;
        }
    }
    found
}

/// The best pose elsewhere of so many samples; the first of equals.
fn best_of(
    search: &PoseSearch,
    seed: u64,
    batch: u64,
    samples: usize,
    is_elsewhere: impl Fn(&Similarity) -> bool,
) -> Option<Similarity> {
    let mut random = Random::stream(seed, STREAMS_OF_SEARCH + batch);
    let mut poses = Vec::new();
    let mut best: Option<(f64, Similarity)> = None;
    for _ in 0..samples {
        poses.clear();
        search.hypothesize(&mut random, &mut poses);
        for pose in poses.iter().filter(|pose| is_elsewhere(pose)) {
            let score = search.score(pose);
            if score.is_finite() && best.as_ref().is_none_or(|(most, _)| score > *most) {
                best = Some((score, *pose));
            }
        }
    }
    best.map(|(_, pose)| pose)
}

/// Streams of the seed that a search may have drawn from.
const STREAMS_OF_SEARCH: u64 = 1 << 32;

/// The place of an answer, as far as the data hold it: what leads there is no other place.
pub struct Basin<'a> {
    pose: Similarity,
    parameters: MotionParameters,
    /// The directions along which nothing holds the answer.
    open: Vec<Direction>,
    limits: &'a NullPoseLimits,
}

impl<'a> Basin<'a> {
    /// The place of a refined pose; directions that are held worse than `most_sigma_m` are open.
    pub fn of(answer: &RefinedPose, most_sigma_m: f64, limits: &'a NullPoseLimits) -> Basin<'a> {
        let spectrum = answer.parameters.spectrum(&answer.equations.full());
        let open = spectrum.directions().iter().filter(|d| d.sigma_m > most_sigma_m).copied().collect();
        Basin { pose: answer.city_from_level, parameters: answer.parameters, open, limits }
    }

    /// The place of a pose of which nothing is open.
    pub fn around(refiner: &PoseRefiner<'a>, pose: &Similarity) -> Basin<'a> {
        let RefinedPose { parameters, .. } = refiner.assess(&[], pose, 0.0);
        Basin { pose: *pose, parameters, open: Vec::new(), limits: &refiner.scene.limits.null_poses }
    }

    pub fn pose(&self) -> &Similarity {
        &self.pose
    }

    /// Whether refinement leads a pose there, but for what is open.
    pub fn has(&self, pose: &Similarity) -> bool {
        let mut apart = self.parameters.between(&self.pose, pose);
        for direction in &self.open {
            apart -= direction.unit * direction.unit.dot(&apart);
        }
        let part = |first: usize| apart.fixed_rows::<3>(first).norm();
        let r = self.parameters.radius;
        part(0) < self.limits.basin_rad * r
            && part(3) < self.limits.basin_m
            && apart[6].abs() < self.limits.basin_log_scale * r
    }
}
