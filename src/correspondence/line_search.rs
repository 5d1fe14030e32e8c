//! Along the ways in which a pose may move: to the best of the places that lie there.
//!
//! Question     where along a direction does the pose explain most?
//! Method       the pose is moved by each offset along the direction and valued, in parallel; the best wins, the nearest of equals.
//!              Three walks use it: along what the data hold loosely, by the score ([`walk_weak_directions`]); along all directions at once into
//!              neighbouring basins, each place refined first ([`basin_hopping`]; basin hopping, Wales and Doye 1997, with fixed moves instead of random ones);
//!              and along what nothing holds, by the planes that find points ([`walk_free_directions`])
//! Why          a wall's top and foot tell the height softly, which says nothing to a least-squares step; a prior inside Gauss-Newton
//!              would drag the pose off its facets. And facades have several parallel planes some decimetres apart: a cloud may
//!              settle with some of its patches one plane off, held as firmly as at the right place

use rayon::prelude::*;

use super::prior::Prior;
use super::refine::{PoseRefiner, RefinedPose};
use super::scene::Scene;
use crate::geometry::Similarity;
use crate::robust::{Chart, Direction, Spectrum};

/// Places along a direction.
pub(super) struct Stride {
    pub direction: Direction,
    /// Metres at the chart's radius.
    pub offsets_m: Vec<f64>,
}

impl Stride {
    /// So many even steps to either side, the nearest first.
    pub fn even(step_m: f64, steps: i32) -> Vec<f64> {
        (1..=steps).flat_map(|k| [f64::from(k) * step_m, -f64::from(k) * step_m]).collect()
    }
}

/// A pose and what it is worth.
pub(super) type Valued = (f64, Similarity);

/// The best of `from` and the places of some strides from it; `value` gives what a place is worth and the pose to go on with from
/// there. Places beyond the prior's reach do not count.
pub(super) fn walk(
    prior: &Prior,
    chart: &Chart,
    from: Valued,
    strides: &[Stride],
    value: impl Fn(&Similarity) -> Valued + Sync,
) -> Valued {
    let place = |(direction, offset_m): (&Direction, f64)| {
        let moved = chart.moved(&from.1, &(direction.unit * offset_m));
        let valued = prior.reaches(&moved).then(|| value(&moved));
        valued.filter(|(_, pose)| prior.reaches(pose))
    };
    let all = strides.iter().flat_map(|s| s.offsets_m.iter().map(|offset_m| (&s.direction, *offset_m)));
    let places: Vec<Option<Valued>> = all.collect::<Vec<_>>().into_par_iter().map(place).collect();
    places.into_iter().flatten().fold(from, |best, place| if place.0 > best.0 { place } else { best })
}

/// The pose after a walk along each loose direction in turn, by the score of `point_subset` within `gate_m`.
pub fn walk_weak_directions(
    scene: &Scene,
    point_subset: &[u32],
    chart: &Chart,
    spectrum: &Spectrum,
    pose: &Similarity,
    gate_m: f64,
) -> Similarity {
    let limits = &scene.limits.walk;
    let step_m = limits.step_of_gate * gate_m;
    let value = |pose: &Similarity| (scene.score(point_subset, pose, gate_m), *pose);
    let mut loose = spectrum.directions().iter().filter(|d| d.sigma_m > limits.loose_m).peekable();
    if loose.peek().is_none() {
        return *pose;
    }
    let walked = loose.fold(value(pose), |best, direction| {
        // A loose direction that is held a little ends where its own sigmas end.
        let steps = (scene.limits.reach_sigmas * direction.sigma_m / step_m).min(f64::from(limits.most_steps)).ceil();
        let stride = Stride { direction: *direction, offsets_m: Stride::even(step_m, steps as i32) };
        walk(&scene.prior, chart, best, &[stride], value)
    });
    walked.1
}

/// The best pose about `pose` in its own basin and those beside it, by the score of `point_subset`.
pub fn basin_hopping(refiner: &PoseRefiner, point_subset: &[u32], pose: &Similarity) -> Similarity {
    let scene = refiner.scene;
    let (limits, gate_unit_m) = (&scene.limits.walk, scene.gate_unit_m);
    let gates_m = limits.basin_gates_units.map(|g| g * gate_unit_m);
    let refined = |pose: &Similarity| {
        let refined = refiner.refine(point_subset, pose, &gates_m);
        ((scene.score(point_subset, &refined.city_from_level, gate_unit_m), refined.city_from_level), refined)
    };
    let offsets_m = limits.basin_moves_units.map(|units| units * gate_unit_m).to_vec();
    let (mut best, mut from) = refined(pose);
    for _ in 0..limits.most_rounds {
        let begun = best;
        let spectrum = from.chart.spectrum(&from.equations.full());
        let stride = |direction: &Direction| Stride { direction: *direction, offsets_m: offsets_m.clone() };
        let strides: Vec<Stride> = spectrum.directions().iter().map(stride).collect();
        best = walk(&scene.prior, &from.chart, best, &strides, |pose| refined(pose).0);
        if best.1 == begun.1 {
            break;
        }
        from = refined(&best.1).1;
    }
    best.1
}

/// Moves `refined`, made without loose points, along what it leaves loose to where most planes find points, as far as `reach_m`, and
/// sharpens with all of `point_subset`.
///
/// The few points of a grazed roof that alone hold a height count for nothing among the points of the walls; but by the
/// root of its points every plane has a say, and at the right height several find theirs at once.
pub fn walk_free_directions(
    refiner: &PoseRefiner,
    point_subset: &[u32],
    refined: RefinedPose,
    gate_m: f64,
    reach_m: f64,
) -> RefinedPose {
    // A finer step than the gate of a loose point is wide: none may fall between.
    let step_m = refiner.point_sigma_m;
    let steps = (reach_m / step_m).ceil() as i32;
    let spectrum = refined.chart.spectrum(&refined.equations.full());
    let most_sigma_m = refiner.scene.limits.refinement.most_sigma_m;
    let mut pose = refined.city_from_level;
    for direction in spectrum.directions().iter().filter(|d| d.sigma_m > most_sigma_m) {
        let free = without_unmoved(refiner, point_subset, &refined.chart, &pose, direction, gate_m);
        let support = |pose: &Similarity| (planes_with_points(refiner, &free, pose, gate_m), *pose);
        let stride = Stride { direction: *direction, offsets_m: Stride::even(step_m, steps) };
        pose = walk(&refiner.scene.prior, &refined.chart, support(&pose), &[stride], support).1;
    }
    refiner.sharpen(point_subset, &pose, gate_m)
}

/// Points on planes, each plane counting by the root of its points.
pub(super) fn planes_with_points(refiner: &PoseRefiner, point_subset: &[u32], pose: &Similarity, gate_m: f64) -> f64 {
    let rows = refiner.point_plane_matches(point_subset, pose, gate_m);
    rows.chunk_by(|a, b| a.hit.plane == b.hit.plane).map(|p| p.iter().map(|r| r.weight).sum::<f64>().sqrt()).sum()
}

/// The point subset without the loose points on planes that a motion along `direction` does not leave: they are explained already, and
/// stray ones beside a wall would hold a roof that is not there.
fn without_unmoved(
    refiner: &PoseRefiner,
    point_subset: &[u32],
    chart: &Chart,
    pose: &Similarity,
    direction: &Direction,
    gate_m: f64,
) -> Vec<u32> {
    let unmoved = refiner.scene.limits.walk.unmoved_share;
    let mut stays = vec![false; refiner.scene.level_cloud.sample_points.len()];
    for row in refiner.point_plane_matches(point_subset, pose, gate_m) {
        stays[row.sample_point as usize] = chart.row(&row.place, &row.hit.normal).dot(&direction.unit).abs() < unmoved;
    }
    point_subset
        .iter()
        .copied()
        .filter(|&i| (i as usize) < refiner.scene.level_cloud.patch_points || !stays[i as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::{Made, all, patch_points, walls_alone};
    use crate::geometry::{StartSigmas, Vector3};
    use crate::planes::Upright;
    use crate::robust::{Motion, Vector7};
    use crate::synthetic::{Block, CloudOptions, House, Offset, Plinth, Surface};

    /// Walks a pose as a stage of the candidates does: along what the point subset leaves loose.
    fn slid(refiner: &PoseRefiner, pose: &Similarity) -> Similarity {
        let (scene, gate_m) = (refiner.scene, refiner.scene.gate_unit_m);
        let held = refiner.assess(&patch_points(scene), pose, gate_m);
        let spectrum = held.chart.spectrum(&held.equations.full());
        walk_weak_directions(scene, &scene.level_cloud.point_subset(1500), &held.chart, &spectrum, pose, gate_m)
    }

    fn raised(made: &Made, scene: &Scene, rise_m: f64) -> Similarity {
        made.pose(scene, &Offset { shift_m: [0.0, 0.0, rise_m], ..Offset::default() })
    }

    #[test]
    fn tops_and_feet_of_walls_tell_a_loose_height() {
        let made = Made::walls();
        for motion in [Motion::Rigid, Motion::Similarity] {
            let scene = made.scene(&Offset::default(), motion);
            for rise_m in [-3.0, -1.2, 0.5, 2.0] {
                let found = slid(&PoseRefiner::new(&scene), &raised(&made, &scene, rise_m));
                let left_m = made.rise_m(&scene, &found);
                // Within the gate of the score, which says little of its last part.
                assert!(left_m.abs() < scene.gate_unit_m, "{left_m} of {rise_m}");
            }
        }
    }

    #[test]
    fn a_loose_height_over_ground_is_found_by_the_ground() {
        let seen = CloudOptions { points_on_ground: 500, ..walls_alone() };
        let made = Made::cloud(Block::four_houses().with_ground(true), &seen);
        let scene = made.scene(&Offset::default(), Motion::Rigid);
        // Beyond the gate, where the ground holds nothing.
        let found = slid(&PoseRefiner::new(&scene), &raised(&made, &scene, 1.0));
        let left_m = made.rise_m(&scene, &found);
        let step_m = made.limits.walk.step_of_gate * scene.gate_unit_m;
        assert!(left_m.abs() < step_m, "{left_m}");
    }

    #[test]
    fn a_pose_that_is_held_in_every_direction_does_not_slide() {
        let made = Made::four_houses();
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let off = made.pose(&scene, &Offset { shift_m: [0.1, -0.1, 0.1], ..Offset::default() });
        assert_eq!(slid(&PoseRefiner::new(&scene), &off), off);
    }

    #[test]
    fn a_cloud_whose_plinth_lies_on_the_wall_hops_to_its_own_place() {
        // From the street: the facade above its plinth, the plinth, and the side that tells where along the street one is.
        let mut seen = Block::plinth_facade(Plinth { height_m: 4.0, depth_m: 0.5 });
        seen.houses.truncate(1);
        seen.houses[0].faces.retain(|f| f.surface == Surface::Wall && (f.normal().y < -0.9 || f.normal().x < -0.9));
        let survey = seen.cloud(&CloudOptions { points_on_ground: 300, seed: 2, ..walls_alone() });
        // In the city the wall goes on behind the plinth, as it does where models are made of boxes.
        let boxes = [House::flat([40.0, 10.0, 8.0]), House::flat([40.0, 0.5, 4.0]).at([0.0, -0.5, 0.0])];
        let made = Made::new(Block::new(boxes.to_vec()).with_ground(true), survey);
        let scene = made.scene(&Offset::default(), Motion::Rigid);
        let refiner = PoseRefiner::new(&scene);
        let point_subset = scene.level_cloud.point_subset(1500);
        let shifted = made.pose(&scene, &Offset { shift_m: [0.0, 0.5, 0.0], ..Offset::default() });
        let stuck = refiner
            .refine(&point_subset, &shifted, &scene.limits.walk.basin_gates_units.map(|g| g * scene.gate_unit_m))
            .city_from_level;
        let off = |pose: &Similarity| made.error(&scene, pose).level_m;
        assert!(off(&stuck) > 0.4, "{}", off(&stuck));
        let hopped = basin_hopping(&refiner, &point_subset, &stuck);
        assert!(off(&hopped) < 0.02, "{}", off(&hopped));
        // And from its own place it goes nowhere.
        let stayed = basin_hopping(&refiner, &point_subset, &hopped);
        assert!(off(&stayed) < 0.02, "{}", off(&stayed));
    }

    #[test]
    fn a_walk_goes_to_the_best_place_and_to_the_nearest_of_equals() {
        let made = Made::walls();
        let scene = made.scene(&Offset::default(), Motion::Rigid);
        let pose = scene.prior.expected();
        let chart = PoseRefiner::new(&scene).assess(&[], &pose, 0.0).chart;
        let up = Direction { unit: Vector7::from_fn(|i, _| if i == 5 { 1.0 } else { 0.0 }), sigma_m: 1.0 };
        let stride = || Stride { direction: up, offsets_m: Stride::even(0.5, 6) };
        let rise_m = |pose: &Similarity| pose.translation.z - scene.prior.center_in_city.z;
        let walked = |value: fn(f64) -> f64| {
            let valued = |pose: &Similarity| (value(rise_m(pose)), *pose);
            rise_m(&walk(&scene.prior, &chart, valued(&pose), &[stride()], valued).1)
        };
        assert!((walked(|z| -(z - 1.6).abs()) - 1.5).abs() < 1e-12);
        assert!((walked(|z| z.abs().min(1.2)).abs() - 1.5).abs() < 1e-12);
        assert_eq!(walked(|_| 0.0), 0.0);
    }

    #[test]
    fn no_walk_leaves_the_reach_of_what_is_known_beforehand() {
        let made = Made::walls();
        let up = made.survey.city_from_sfm.rotation.inverse() * Vector3::z();
        let upright = Upright { up, sigma_rad: 0.0, known: true };
        // The truth is out of reach: 3 m higher or lower, where no plane holds the height, with sigmas that reach 1.5 m.
        let sigmas = StartSigmas { position_m: 0.5, height_m: 0.5, ..StartSigmas::default() };
        for shift_m in [[0.0, 0.0, 3.0], [0.0, 0.0, -3.0], [1.2, -0.8, 2.0]] {
            let start = Offset { shift_m, ..Offset::default() };
            let scene = made.scene_with(&start, sigmas, Motion::Rigid, &upright);
            let refiner = PoseRefiner::new(&scene);
            let pose = scene.prior.expected();
            let held = refiner.assess(&patch_points(&scene), &pose, scene.gate_unit_m);
            let valued = |p: &Similarity| ((p.translation - pose.translation).norm(), *p);
            let along =
                |k: usize| Direction { unit: Vector7::from_fn(|i, _| f64::from(u8::from(i == k))), sigma_m: 1.0 };
            let strides: Vec<Stride> =
                (3..6).map(|k| Stride { direction: along(k), offsets_m: Stride::even(0.4, 20) }).collect();
            let farthest = walk(&scene.prior, &held.chart, valued(&pose), &strides, valued);
            assert!((farthest.0 - 1.2).abs() < 1e-9, "{}", farthest.0);
            for (name, found) in [
                ("slide", slid(&refiner, &pose)),
                ("hop", basin_hopping(&refiner, &scene.level_cloud.point_subset(1000), &pose)),
                (
                    "settle",
                    walk_free_directions(&refiner, &all(&scene), held.clone(), scene.gate_unit_m, 4.0).city_from_level,
                ),
            ] {
                assert!(scene.prior.reaches(&found), "{name}: {found:?} from {pose:?}");
                assert_eq!(found.scale.to_bits(), 1f64.to_bits());
            }
        }
    }

    #[test]
    fn a_given_scale_is_kept_to_the_bit_by_slides_and_hops() {
        for made in [Made::walls(), Made::four_houses()] {
            for (k, scale) in [0.96, 1.0, 1.03].into_iter().enumerate() {
                let start = Offset { shift_m: [0.4, -0.5, 0.6 * k as f64], scale, ..Offset::default() };
                let scene = made.scene(&start, Motion::Rigid);
                let refiner = PoseRefiner::new(&scene);
                let pose = scene.prior.expected();
                for found in
                    [slid(&refiner, &pose), basin_hopping(&refiner, &scene.level_cloud.point_subset(1000), &pose)]
                {
                    assert_eq!(found.scale.to_bits(), 1f64.to_bits(), "{found:?}");
                }
            }
        }
    }
}
