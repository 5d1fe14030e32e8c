//! The robust search for poses: minimal samples over patch-plane pairs, scored on facets.

use super::economy::{cheapest, prospects};
use super::sampler::{Pair, Sample, Sampler};
use super::scene::Scene;
use super::votes::LevelPatch;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::robust::{Motion, Problem, Random, Ranked, RansacOptions, ransac};
use crate::solvers::{Configuration, Row, Sought, Up, solve_minimal};

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

/// Searches a scene with the configuration that is expected to cost least; `progress` is told how many samples of how many.
pub fn search(scene: &Scene, seed: u64, progress: &(dyn Fn(usize, usize) + Sync)) -> Hypotheses {
    let limits = &scene.limits.search;
    let (sampler, sought, panel) = (Sampler::new(scene), sought(scene), scene.votes.panel(limits.ranking_probes));
    let with = |configuration| PoseSearch { scene, sampler: &sampler, sought, configuration, panel: &panel };
    let searches: Vec<PoseSearch> = sought.configurations().iter().map(with).collect();
    let Some(configuration) = cheapest(&prospects(&searches, limits), limits) else {
        return Hypotheses { ranked: Vec::new(), solver: NO_SOLVER.to_owned(), samples: 0 };
    };
    let options = RansacOptions {
        seed,
        keep: limits.keep,
        fewest_samples: limits.fewest_samples,
        most_samples: limits.most_samples,
        enough_hits: limits.enough_hits,
    };
    let (ranked, samples) = ransac(&with(&configuration), &options, |n| progress(n, options.most_samples));
    Hypotheses { ranked, solver: format!("{} {configuration}", sought.name()), samples }
}

/// What is unknown of the pose in the level frame.
fn sought(scene: &Scene) -> Sought {
    let up = Up::new(&Vector3::z(), &Vector3::z()).filter(|_| scene.prior.up_is_known);
    match (up, scene.prior.motion) {
        (Some(up), Motion::Similarity) => Sought::UprightSimilarity(up),
        (Some(up), Motion::Rigid) => Sought::UprightRigid(up),
        (None, Motion::Similarity) => Sought::Similarity,
        (None, Motion::Rigid) => Sought::Rigid,
    }
}

/// The alignment as the robust loop sees it. Poses are `city_from_level`.
pub struct PoseSearch<'a> {
    scene: &'a Scene<'a>,
    sampler: &'a Sampler<'a>,
    sought: Sought,
    /// How many points the samples take from each pair, the first pair's first.
    pub configuration: &'a Configuration,
    /// Probes that rank hypotheses.
    panel: &'a [u32],
}

impl Problem for PoseSearch<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        self.sample(random, poses);
    }

    fn score(&self, pose: &Similarity) -> f64 {
        // Wide: a minimal sample extrapolates the noise of a few patches over the whole scene.
        self.scene.score(self.panel, pose, self.scene.limits.search.gate_units * self.scene.unit_m)
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        largest_shift(a, b, self.scene.votes.radius_m) < self.scene.limits.search.same_place_m
    }
}

impl PoseSearch<'_> {
    /// Draws one sample and appends its poses within the start's reach. Tells the chance that the sample is right; `None` where
    /// its patches fit nothing or cannot give the points.
    pub fn sample(&self, random: &mut Random, poses: &mut Vec<Similarity>) -> Option<f64> {
        let points_per_plane = self.configuration.points_per_plane;
        let sample = self.sampler.draw(points_per_plane.len(), random)?;
        let rows = self.rows(&sample)?;
        let solved = solve_minimal(&self.sought, points_per_plane, &rows);
        let right_way_up = |pose: &&Similarity| self.faces_its_planes(&sample, pose);
        poses.extend(solved.iter().filter(right_way_up).filter(|pose| self.scene.prior.reaches(pose)));
        Some(sample.chance)
    }

    /// So many points of each pair on its plane; then what completes the sample, one row for each plane that is left.
    fn rows(&self, sample: &Sample) -> Option<Vec<Row>> {
        let mut rows = Vec::with_capacity(self.sought.unknowns());
        let mut completion = sample.completion.iter();
        for (k, &points) in self.configuration.points_per_plane.iter().enumerate() {
            match sample.pairs.get(k) {
                Some(pair) => {
                    let patch = &self.scene.votes.patches[pair.patch as usize];
                    let places = places(patch, points, &self.across(sample, k));
                    rows.extend(places[..points].iter().map(|place| row(place, pair)));
                }
                None if points == 1 => rows.push(*completion.next()?),
                None => return None,
            }
        }
        Some(rows)
    }

    /// What two points of the pair's patch must stand across, to tell most: the direction that is known already. Known up holds
    /// its vertical; else a patch is turned about the normal of the pair before it.
    fn across(&self, sample: &Sample, k: usize) -> Vector3<f64> {
        if self.sampler.up_is_known() {
            return Vector3::z();
        }
        let count = sample.pairs.len();
        sample.pairs[(k + count - 1) % count].normal
    }

    /// Three points of a patch lie as well on their plane when the patch is turned over.
    fn faces_its_planes(&self, sample: &Sample, pose: &Similarity) -> bool {
        let wholes = self.configuration.points_per_plane.iter().take_while(|points| **points == 3).count();
        let mut pairs = sample.pairs.iter().take(wholes);
        pairs.all(|pair| (pose.rotation * pair.normal).dot(&pair.target.normal) > 0.0)
    }
}

fn row(place: &Vector3<f64>, pair: &Pair) -> Row {
    Row { point: *place, normal: pair.target.normal, offset: pair.target.offset }
}

/// One, two or three points for a patch, as far apart as its own points are: its middle; a pair at right angles to `across`; a
/// triangle.
fn places(patch: &LevelPatch, points: usize, across: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let middle = patch.center.coords;
    match points {
        1 => [middle; 3],
        2 => {
            let along = in_plane(patch, across);
            [middle + along, middle - along, middle]
        }
        _ => {
            let [long, short] = [patch.axes[0] * patch.spread[0], patch.axes[1] * patch.spread[1]];
            let (back, aside) = (-0.5 * long, 0.75f64.sqrt() * short);
            [middle + long, middle + back + aside, middle + back - aside]
        }
    }
}

/// The direction in a patch's plane at right angles to `across`, as long as the patch.
fn in_plane(patch: &LevelPatch, across: &Vector3<f64>) -> Vector3<f64> {
    let direction = across.cross(&patch.normal).try_normalize(0.0).unwrap_or_default();
    let [a, b] = [0, 1].map(|k| patch.axes[k].dot(&direction) * patch.spread[k]);
    direction * (a * a + b * b).sqrt().max(f64::MIN_POSITIVE)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::Made;
    use crate::synthetic::{Offset, Survey};

    /// Of the poses kept, the nearest to the truth: how far it moves the scene, metres.
    fn nearest_m(made: &Made, scene: &Scene, ranked: &[Ranked<Similarity>]) -> f64 {
        let truth = made.truth(scene);
        ranked.iter().map(|r| largest_shift(&r.pose, &truth, scene.votes.radius_m)).fold(f64::INFINITY, f64::min)
    }

    /// The poses that samples of one configuration lead to.
    fn searched(scene: &Scene, configuration: &Configuration, seed: u64) -> Vec<Ranked<Similarity>> {
        let (sampler, panel) = (Sampler::new(scene), scene.votes.panel(200));
        let search = PoseSearch { scene, sampler: &sampler, sought: sought(scene), configuration, panel: &panel };
        let options =
            RansacOptions { seed, keep: 60, fewest_samples: 2048, most_samples: MOST_SAMPLES, enough_hits: 3 };
        ransac(&search, &options, |_| ()).0
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
            let found = search(&scene, seed, &|_, _| ());
            assert_eq!(found.solver, "upright similarity (2,1,1,1)");
            assert!(found.samples >= made.limits.search.fewest_samples, "{}", found.samples);
            assert!(found.ranked.is_sorted_by(|a, b| a.score >= b.score) && found.ranked.len() <= 60);
            assert!(nearest_m(&made, &scene, &found.ranked[..10]) < made.limits.search.same_place_m);
        }
    }

    #[test]
    fn patches_that_feed_no_solver_are_not_searched() {
        let Made { block, mut survey, .. } = Made::four_houses();
        // The front of the first house alone: no second normal tells how it turns.
        survey.sfm.points.truncate(150);
        survey.face_of_point.truncate(150);
        let made = Made::new(block, Survey { ..survey });
        let found = search(&made.leaning_scene(&Offset::default(), Motion::Similarity), 0, &|_, _| ());
        assert_eq!((found.solver.as_str(), found.samples, found.ranked.len()), (NO_SOLVER, 0, 0));
    }

    #[test]
    fn one_seed_gives_the_same_poses_for_any_number_of_threads_and_another_seed_others() {
        let made = Made::four_houses();
        let with = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| search(&made.scene(&starts()[0], Motion::Similarity), seed, &|_, _| ()));
            let told = |r: &Ranked<Similarity>| (r.pose, r.score.to_bits(), r.hits);
            (found.ranked.iter().map(told).collect::<Vec<_>>(), found.samples)
        };
        let one = with(1, 4);
        assert_eq!(one, with(3, 4));
        assert_ne!(one, with(3, 5));
    }
}
