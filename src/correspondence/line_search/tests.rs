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
    let spectrum = held.parameters.spectrum(&held.equations.full());
    search_weak_directions(scene, &scene.level_cloud.point_subset(1500), &held.parameters, &spectrum, pose, gate_m)
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
    let made = Made::cloud(Block::four_houses().with_ground(), &seen);
    let scene = made.scene(&Offset::default(), Motion::Rigid);
    // Beyond the gate, where the ground holds nothing.
    let found = slid(&PoseRefiner::new(&scene), &raised(&made, &scene, 1.0));
    let left_m = made.rise_m(&scene, &found);
    let step_m = made.limits.line_search.step_of_gate * scene.gate_unit_m;
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
    let made = Made::new(Block::new(boxes.to_vec()).with_ground(), survey);
    let scene = made.scene(&Offset::default(), Motion::Rigid);
    let refiner = PoseRefiner::new(&scene);
    let point_subset = scene.level_cloud.point_subset(1500);
    let shifted = made.pose(&scene, &Offset { shift_m: [0.0, 0.5, 0.0], ..Offset::default() });
    let stuck = refiner
        .refine(&point_subset, &shifted, &scene.limits.line_search.basin_gates_units.map(|g| g * scene.gate_unit_m))
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
fn a_line_search_goes_to_the_best_place_and_to_the_nearest_of_equals() {
    let made = Made::walls();
    let scene = made.scene(&Offset::default(), Motion::Rigid);
    let pose = scene.prior.expected();
    let parameters = PoseRefiner::new(&scene).assess(&[], &pose, 0.0).parameters;
    let up = Direction { unit: Vector7::from_fn(|i, _| if i == 5 { 1.0 } else { 0.0 }), sigma_m: 1.0 };
    let stride = || Stride { direction: up, offsets_m: Stride::even(0.5, 6) };
    let rise_m = |pose: &Similarity| pose.translation.z - scene.prior.center_in_city.z;
    let moved = |value: fn(f64) -> f64| {
        let valued = |pose: &Similarity| (value(rise_m(pose)), *pose);
        rise_m(&line_search(&scene.prior, &parameters, valued(&pose), &[stride()], valued).1)
    };
    assert!((moved(|z| -(z - 1.6).abs()) - 1.5).abs() < 1e-12);
    assert!((moved(|z| z.abs().min(1.2)).abs() - 1.5).abs() < 1e-12);
    assert_eq!(moved(|_| 0.0), 0.0);
}

#[test]
fn no_line_search_leaves_the_reach_of_what_is_known_beforehand() {
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
        let along = |k: usize| Direction { unit: Vector7::from_fn(|i, _| f64::from(u8::from(i == k))), sigma_m: 1.0 };
        let strides: Vec<Stride> =
            (3..6).map(|k| Stride { direction: along(k), offsets_m: Stride::even(0.4, 20) }).collect();
        let farthest = line_search(&scene.prior, &held.parameters, valued(&pose), &strides, valued);
        assert!((farthest.0 - 1.2).abs() < 1e-9, "{}", farthest.0);
        for (name, found) in [
            ("slide", slid(&refiner, &pose)),
            ("hop", basin_hopping(&refiner, &scene.level_cloud.point_subset(1000), &pose)),
            (
                "settle",
                search_free_directions(&refiner, &all(&scene), held.clone(), scene.gate_unit_m, 4.0).city_from_level,
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
            for found in [slid(&refiner, &pose), basin_hopping(&refiner, &scene.level_cloud.point_subset(1000), &pose)]
            {
                assert_eq!(found.scale.to_bits(), 1f64.to_bits(), "{found:?}");
            }
        }
    }
}
