//! The robust search for poses: which minimal samples, and how many of them.

use super::pose_search::PoseSearch;
use super::prior::Vertical;
use super::refine::PoseRefiner;
use super::sampler::Sampler;
use super::scene::Scene;
use super::solver_choice::{cheapest, solver_costs};
use crate::geometry::{Similarity, Vector3};
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::robust::{Motion, Problem, Random, Ranked, RansacOptions, ransac};
use crate::solvers::{Sought, Up};

/// What a search found and how.
#[derive(Clone, Debug)]
pub struct Hypotheses {
    /// Poses `city_from_level`, best first.
    pub ranked: Vec<Ranked<Similarity>>,
    /// Which configuration of the minimal family drew the samples, or [`NO_SOLVER`].
    pub solver: String,
    pub samples: usize,
}

/// What a result names where the data feed no solver.
pub const NO_SOLVER: &str = "none";

/// Searches a scene with the configuration that is expected to cost least; the observer is told of samples.
pub fn search(scene: &Scene, seed: u64, observer: &dyn Observer) -> Result<Hypotheses, Cancelled> {
    let limits = &scene.limits.search;
    let (sampler, sought, point_subset) =
        (Sampler::new(scene), sought(scene), scene.level_cloud.point_subset(limits.ranking_points));
    let with =
        |configuration| PoseSearch { scene, sampler: &sampler, sought, configuration, point_subset: &point_subset };
    let searches: Vec<PoseSearch> = sought.configurations().iter().map(with).collect();
    let Some(configuration) = cheapest(&solver_costs(&searches, limits), limits) else {
        return Ok(Hypotheses { ranked: Vec::new(), solver: NO_SOLVER.to_owned(), samples: 0 });
    };
    let options = RansacOptions {
        seed,
        keep: limits.keep,
        best_of_block: limits.best_of_block,
        fewest_samples: limits.fewest_samples,
        most_samples: limits.most_samples,
        enough_hits: limits.enough_hits,
    };
    let improving = Improving::new(scene, with(&configuration));
    let (ranked, samples) = ransac(&improving, &options, |n| {
        observer.progress(Stage::Search, n, options.most_samples);
        !observer.is_cancelled()
    });
    check_cancelled(observer)?;
    Ok(Hypotheses { ranked, solver: format!("{} {configuration}", sought.name()), samples })
}

/// A search whose better poses are refined before they are ranked: a minimal sample is off by metres at the rim of a scene, where a gate
/// wide enough for it lets many wrong poses score as well as a right one. Where the model knows a twentieth of what was seen, the right pose
/// is one of a few among tens of thousands, and stands out only once it is sharp.
///
/// Source: local optimisation in random consensus (Chum, Matas and Kittler 2003)
struct Improving<'a> {
    search: PoseSearch<'a>,
    refiner: PoseRefiner<'a>,
    point_subset: Vec<u32>,
    gates_m: Vec<f64>,
    ranking_gate_m: f64,
}

impl<'a> Improving<'a> {
    fn new(scene: &'a Scene<'a>, search: PoseSearch<'a>) -> Improving<'a> {
        let limits = &scene.limits.search;
        Improving {
            search,
            refiner: PoseRefiner::new(scene),
            point_subset: scene.level_cloud.point_subset(limits.local_optimization_points),
            gates_m: limits.local_optimization_gates_units.iter().map(|gate| gate * scene.gate_unit_m).collect(),
            ranking_gate_m: limits.ranking_gate_units * scene.gate_unit_m,
        }
    }
}

impl Problem for Improving<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        self.search.hypothesize(random, poses);
    }

    fn score(&self, pose: &Similarity) -> f64 {
        self.search.score(pose)
    }

    fn score_from(&self, pose: &Similarity, least: f64) -> Option<f64> {
        self.search.score_from(pose, least)
    }

    fn improve(&self, _: f64, pose: Similarity) -> (f64, Similarity) {
        let scene = self.search.scene;
        let refined = self.refiner.refine(&self.point_subset, &pose, &self.gates_m).city_from_level;
        let better = if scene.prior.reaches(&refined) { refined } else { pose };
        (scene.score(&self.point_subset, &better, self.ranking_gate_m), better)
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        self.search.same(a, b)
    }
}

/// What is unknown of the pose in the level frame.
pub(super) fn sought(scene: &Scene) -> Sought {
    let up = Up::new(&Vector3::z(), &Vector3::z()).filter(|_| scene.prior.vertical == Vertical::Known);
    match (up, scene.prior.motion) {
        (Some(up), Motion::Similarity) => Sought::UprightSimilarity(up),
        (Some(up), Motion::Rigid) => Sought::UprightRigid(up),
        (None, Motion::Similarity) => Sought::Similarity,
        (None, Motion::Rigid) => Sought::Rigid,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::pose_search::largest_shift;
    use crate::correspondence::test_scene::Made;
    use crate::solvers::Configuration;
    use crate::synthetic::{Offset, Survey};

    /// Of the poses kept, the nearest to the truth: how far it moves the scene, metres.
    fn nearest_m(made: &Made, scene: &Scene, ranked: &[Ranked<Similarity>]) -> f64 {
        let truth = made.truth(scene);
        ranked.iter().map(|r| largest_shift(&r.pose, &truth, scene.level_cloud.radius_m)).fold(f64::INFINITY, f64::min)
    }

    /// The poses that samples of one configuration lead to.
    fn searched(scene: &Scene, configuration: &Configuration, seed: u64) -> Vec<Ranked<Similarity>> {
        let (sampler, point_subset) = (Sampler::new(scene), scene.level_cloud.point_subset(200));
        let search =
            PoseSearch { scene, sampler: &sampler, sought: sought(scene), configuration, point_subset: &point_subset };
        let options = RansacOptions {
            seed,
            keep: 60,
            best_of_block: 60,
            fewest_samples: 2048,
            most_samples: MOST_SAMPLES,
            enough_hits: 3,
        };
        ransac(&search, &options, |_| true).0
    }

    const MOST_SAMPLES: usize = 32_768;

    /// Starts that are off by as much as their sigmas say, and one by twice that.
    fn starts() -> [Offset; 3] {
        let turned = |shift_m, heading_rad, scale| Offset { shift_m, heading_rad, scale, ..Offset::default() };
        [
            turned([6.0, -5.0, 1.5], 0.15, 1.12),
            turned([-8.0, 4.0, -2.0], -0.2, 0.9),
            turned([14.0, 12.0, 4.0], 0.3, 1.2),
        ]
    }

    #[test]
    fn every_configuration_of_a_known_vertical_keeps_the_truth_among_its_poses() {
        let made = Made::four_houses();
        for motion in [Motion::Rigid, Motion::Similarity] {
            for (seed, start) in (0..).zip(starts()) {
                let scale = if motion == Motion::Rigid { 1.0 } else { start.scale };
                let scene = made.scene(&Offset { scale, ..start }, motion);
                for configuration in sought(&scene).configurations() {
                    let ranked = searched(&scene, configuration, seed);
                    let off_m = nearest_m(&made, &scene, &ranked);
                    // One place of the search: what refinement converges from.
                    assert!(off_m < made.limits.search.same_place_m, "{motion:?} {configuration} {seed}: {off_m}");
                    let rigid = ranked.iter().all(|r| r.pose.scale.to_bits() == 1f64.to_bits());
                    assert_eq!(rigid, motion == Motion::Rigid);
                    assert!(ranked.iter().all(|r| scene.prior.reaches(&r.pose)));
                }
            }
        }
    }

    #[test]
    fn every_configuration_that_turns_freely_keeps_the_truth_among_its_poses() {
        let made = Made::four_houses();
        for motion in [Motion::Rigid, Motion::Similarity] {
            let leaning = Offset { tilt_rad: [0.08, -0.05], ..starts()[0] };
            let scale = if motion == Motion::Rigid { 1.0 } else { leaning.scale };
            let scene = made.leaning_scene(&Offset { scale, ..leaning }, motion);
            for configuration in sought(&scene).configurations() {
                let ranked = searched(&scene, configuration, 1);
                let off_m = nearest_m(&made, &scene, &ranked);
                assert!(off_m < made.limits.search.same_place_m, "{motion:?} {configuration}: {off_m}");
                let rigid = ranked.iter().all(|r| r.pose.scale.to_bits() == 1f64.to_bits());
                assert_eq!(rigid, motion == Motion::Rigid);
            }
        }
    }

    #[test]
    fn the_search_names_its_configuration_and_ranks_the_best_first() {
        let made = Made::four_houses();
        for (seed, start) in (5..).zip(starts()) {
            let scene = made.scene(&start, Motion::Similarity);
            let found = search(&scene, seed, &()).unwrap();
            assert_eq!(found.solver, "upright similarity (2,1,1,1)");
            assert!(found.samples >= made.limits.search.fewest_samples, "{}", found.samples);
            assert!(found.ranked.is_sorted_by(|a, b| a.score >= b.score) && found.ranked.len() <= 60);
            assert!(
                nearest_m(&made, &scene, &found.ranked[..found.ranked.len().min(10)]) < made.limits.search.same_place_m
            );
        }
    }

    #[test]
    fn patches_that_feed_no_solver_are_not_searched() {
        let Made { block, mut survey, .. } = Made::four_houses();
        // The front of the first house alone: no second normal tells how it turns.
        survey.sfm.points.truncate(150);
        survey.face_of_point.truncate(150);
        let made = Made::new(block, Survey { ..survey });
        let found = search(&made.leaning_scene(&Offset::default(), Motion::Similarity), 0, &()).unwrap();
        assert_eq!((found.solver.as_str(), found.samples, found.ranked.len()), (NO_SOLVER, 0, 0));
    }

    #[test]
    fn one_seed_gives_the_same_poses_for_any_number_of_threads_and_another_seed_others() {
        let made = Made::four_houses();
        let with = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| search(&made.scene(&starts()[0], Motion::Similarity), seed, &()).unwrap());
            let told = |r: &Ranked<Similarity>| (r.pose, r.score.to_bits(), r.hits);
            (found.ranked.iter().map(told).collect::<Vec<_>>(), found.samples)
        };
        let one = with(1, 4);
        assert_eq!(one, with(3, 4));
        assert_ne!(one, with(3, 5));
    }
}
