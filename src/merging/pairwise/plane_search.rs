//! The similarity that superpixel planes agree on, without a start: minimal samples.
//!
//! Question     where does part b stand in part a, if only planes and points on them are known?
//! Input        the planes and points of both ways
//! Output       the pose with the best score, refined; `None` where there are too few rows for a sample
//! Method       a minimal sample is seven points on planes of one part; the family's similarity solvers give its poses, and both ways
//!              and all six configurations are drawn. Samples of noisy points a few pixels apart give rough poses, so the best
//!              distinct ones are all refined, with a gate that narrows, and compared after that.
//! Fails when   nearly all planes are parallel, or more than half of the points lie off their planes
//! Source       Ramalingam, Taguchi, Marks and Tuzel 2010, section 5

use super::fit::{OwnFit, Sources};
use super::plane_rows::{PlaneRows, settle_planes};
use super::planes::{PlaneGroup, PlaneOf, SharedPlanes};
use super::same_place::SamePlace;
use crate::geometry::{Point3, Similarity};
use crate::merging::extent::median_point;
use crate::merging::limits::MergeLimits;
use crate::merging::point_covariance::KnownPoint;
use crate::robust::{Motion, Problem, Random, RansacOptions, ransac};
use crate::solvers::{Row, SIMILARITY, Sought, solve_minimal};

/// Looks for a group with enough points.
const TRIES: usize = 20;

/// The pose that the planes agree on best, and their answer about it.
pub(super) fn fit_planes(planes: &SharedPlanes, limits: &MergeLimits, seed: u64) -> Option<OwnFit> {
    let pose = search(planes, limits, seed)?;
    Some(settle_planes(planes, &pose, &limits.fit))
}

struct Search<'a> {
    rows: PlaneRows<'a>,
    /// The groups whose planes a has, and those whose planes b has.
    sides: [Vec<&'a PlaneGroup>; 2],
    /// Groups that rank hypotheses, and which of their points: one in so many.
    scored: Vec<(&'a PlaneGroup, usize)>,
    same: SamePlace<'a>,
}

fn search(planes: &SharedPlanes, limits: &MergeLimits, seed: u64) -> Option<Similarity> {
    let search = &limits.search;
    let rows = |bend: f64| PlaneRows { planes, bend, limits: &limits.fit };
    let sides = [PlaneOf::A, PlaneOf::B].map(|of| side(planes, of));
    if sides.iter().all(Vec::is_empty) {
        return None;
    }
    let every = planes.groups.len().div_ceil(search.scored_groups);
    let scored = planes.groups.iter().step_by(every).map(|g| (g, g.points.len().div_ceil(search.scored_in_group)));
    let same = SamePlace { center_b: center_of_b(planes), radius_a: planes.radius[0], limits: search };
    let problem = Search { rows: rows(search.plane_bend), sides, scored: scored.collect(), same };
    let options = RansacOptions {
        seed,
        keep: search.kept_by_planes,
        best_of_block: search.kept_by_planes,
        fewest_samples: search.plane_samples,
        most_samples: search.plane_samples,
        enough_hits: usize::MAX,
    };
    let (ranked, _) = ransac(&problem, &options, |_| true);
    let narrowest = rows(search.narrowing_bends[2]);
    let refined = ranked.iter().map(|found| {
        let narrow = |pose: Similarity, bend: &f64| Sources { lead: &rows(*bend), others: &[] }.refine(&pose);
        let pose = search.narrowing_bends.iter().fold(found.pose, narrow);
        (narrowest.score(&pose), pose)
    });
    refined.max_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, pose)| pose)
}

/// The groups of one side, where they have enough points for a sample.
fn side(planes: &SharedPlanes, of: PlaneOf) -> Vec<&PlaneGroup> {
    let groups: Vec<&PlaneGroup> = planes.groups.iter().filter(|g| g.plane_of == of).collect();
    if groups.iter().map(|g| g.points.len()).sum::<usize>() < Motion::Similarity.unknowns() {
        Vec::new()
    } else {
        groups
    }
}

fn center_of_b(planes: &SharedPlanes) -> Point3<f64> {
    let in_b = |g: &PlaneGroup| match g.plane_of {
        PlaneOf::A => g.points[0].at,
        PlaneOf::B => g.plane.center,
    };
    let places: Vec<Point3<f64>> = planes.groups.iter().map(in_b).collect();
    median_point(places.iter()).unwrap_or_else(Point3::origin)
}

impl Problem for Search<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        let side = random.below(2);
        let side = if self.sides[side].is_empty() { 1 - side } else { side };
        let configuration = SIMILARITY[random.below(SIMILARITY.len())].points_per_plane;
        let Some(rows) = self.sample(side, configuration, random) else { return };
        let found = solve_minimal(&Sought::Similarity, configuration, &rows);
        poses.extend(found.iter().filter(|p| p.scale > 0.0).map(|p| if side == 0 { *p } else { p.inverse() }));
    }

    fn score(&self, pose: &Similarity) -> f64 {
        let of_group =
            |(group, step): &(&PlaneGroup, usize)| self.rows.votes_of(group, group.points.iter().step_by(*step), pose);
        self.scored.iter().map(of_group).sum()
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        self.same.holds(a, b)
    }
}

impl Search<'_> {
    /// Distinct groups with as many points as the configuration asks of each.
    fn sample(&self, side: usize, configuration: &[usize], random: &mut Random) -> Option<Vec<Row>> {
        let groups = &self.sides[side];
        let mut used = Vec::with_capacity(configuration.len());
        let mut rows = Vec::with_capacity(configuration.iter().sum());
        for &wanted in configuration {
            let fits = |g: &usize| groups[*g].points.len() >= wanted && !used.contains(g);
            let picked = (0..TRIES).map(|_| random.below(groups.len())).find(fits)?;
            used.push(picked);
            let plane = &groups[picked].plane.plane;
            let row = |point: &KnownPoint| Row { point: point.at.coords, normal: plane.normal, offset: plane.offset };
            rows.extend(distinct(random, groups[picked].points.len(), wanted).map(|i| row(&groups[picked].points[i])));
        }
        Some(rows)
    }
}

/// `wanted` different numbers below `count`.
fn distinct(random: &mut Random, count: usize, wanted: usize) -> impl Iterator<Item = usize> {
    let mut picked = Vec::with_capacity(wanted);
    while picked.len() < wanted {
        let next = random.below(count);
        if !picked.contains(&next) {
            picked.push(next);
        }
    }
    picked.into_iter()
}

#[cfg(test)]
mod tests {
    use super::super::test_scene::{scene, truth};
    use super::*;
    use crate::robust::Matrix7;

    #[test]
    fn planes_alone_find_the_similarity() {
        let planes = scene(0.002, |x| *x);
        let found = fit_planes(&planes, &MergeLimits::default(), 3).unwrap();
        let x = truth().inverse().apply(&Point3::new(2.0, 3.0, 1.0));
        let off = (found.fit.a_from_b.apply(&x) - truth().apply(&x)).norm();
        assert!(off < 0.01, "{off}");
        assert!(found.fit.inlier_count() > planes.correspondences() * 9 / 10);
    }

    #[test]
    fn planes_find_the_similarity_among_a_third_of_wrong_superpixels() {
        let mut planes = scene(0.002, |x| *x);
        let wrong = planes.shuffled();
        for (k, (group, other)) in planes.groups.iter_mut().zip(wrong.groups).enumerate() {
            if k % 3 == 0 {
                *group = other;
            }
        }
        let found = fit_planes(&planes, &MergeLimits::default(), 3).unwrap();
        let x = truth().inverse().apply(&Point3::new(2.0, 3.0, 1.0));
        let off = (found.fit.a_from_b.apply(&x) - truth().apply(&x)).norm();
        assert!(off < 0.02, "{off}");
    }

    #[test]
    fn parallel_planes_fix_nothing() {
        let mut planes = scene(0.002, |x| *x);
        let first = planes.groups[0].plane.plane.normal;
        let is_alike = |g: &PlaneGroup| g.plane_of == PlaneOf::A && g.plane.plane.normal.dot(&first).abs() > 0.99;
        planes.groups.retain(is_alike);
        // One sigma of the freest motion against 0.15 % of the extent.
        let sigma = |information: &Matrix7| information.symmetric_eigenvalues().min().max(0.0).sqrt().recip();
        let held = fit_planes(&planes, &MergeLimits::default(), 3)
            .is_some_and(|f| sigma(&f.fit.information) < 0.003 * planes.radius[0]);
        assert!(!held);
    }

    #[test]
    fn finds_the_same_for_any_number_of_threads() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| fit_planes(&scene(0.002, |x| *x), &MergeLimits::default(), 3).unwrap().fit.a_from_b)
        };
        assert_eq!(run(1), run(3));
    }
}
