use super::*;
use crate::correspondence::line_search::{planes_with_points, search_free_directions};
use crate::correspondence::test_scene::{Made, all, patch_points, walls_alone, with_points};
use crate::geometry::Vector3;
use crate::synthetic::{Block, CloudOptions, House, Offset};

/// From the width of a search's ranking to that of the score, units.
const GATES: [f64; 10] = [5.0, 5.0, 4.0, 3.3, 2.7, 2.3, 2.0, 1.7, 1.3, 1.0];

fn refined(refiner: &PoseRefiner, pose: &Similarity) -> RefinedPose {
    let scene = refiner.scene;
    refiner.refine(&patch_points(scene), pose, &GATES.map(|gate| gate * scene.gate_unit_m))
}

#[test]
fn converges_to_the_truth_from_offsets_within_the_gates_and_finds_the_scale() {
    let made = Made::four_houses();
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let refiner = PoseRefiner::new(&scene);
    for (shift_m, heading_deg, tilt_deg, scale) in [
        ([0.6, -0.5, 0.4], 0.0, [0.0, 0.0], 1.0f64),
        ([-0.5, 0.5, -0.5], 1.5, [0.0, 0.0], 1.0),
        ([0.3, 0.3, 0.3], -1.0, [0.5, -0.5], 1.015),
        ([0.0, 0.0, 0.0], 0.0, [0.0, 0.0], 0.97),
    ] {
        let (heading_rad, tilt_rad) = (f64::to_radians(heading_deg), tilt_deg.map(f64::to_radians));
        let off = Offset { shift_m, heading_rad, tilt_rad, scale };
        let found = refined(&refiner, &made.pose(&scene, &off)).city_from_level;
        let error = made.error(&scene, &found);
        // 2 cm of noise over some thousand points, and the clutter beside the walls.
        assert!(error.level_m < 0.02 && error.up_m < 0.02, "{error:?} from {off:?}");
        let scale_error = found.scale / made.truth(&scene).scale - 1.0;
        assert!(scale_error.abs() < 5e-4, "{scale_error} from {off:?}");
    }
}

#[test]
fn a_given_scale_is_kept_to_the_bit_where_poses_are_refined_sharpened_and_settled() {
    let made = Made::four_houses();
    for (k, shift_m) in [[0.6, -0.5, 0.4], [-0.5, 0.5, -0.5], [0.1, 0.2, 0.9]].into_iter().enumerate() {
        // The given scale is wrong by some per cent, so that a free one would leave it.
        let start = Offset { shift_m, heading_rad: 0.02, scale: 0.97 + 0.03 * k as f64, ..Offset::default() };
        let scene = made.scene(&start, Motion::Rigid);
        let refiner = PoseRefiner::new(&scene);
        let first = refined(&refiner, &scene.prior.expected());
        let sharp = refiner.sharpen(&patch_points(&scene), &first.city_from_level, scene.gate_unit_m);
        let refined_to_end = search_free_directions(&refiner, &all(&scene), sharp.clone(), scene.gate_unit_m, 1.0);
        for pose in [&first, &sharp, &refined_to_end].map(|refined| refined.city_from_level) {
            assert_eq!(pose.scale.to_bits(), 1f64.to_bits(), "{pose:?}");
            let given = scene.level_cloud.level_from_sfm.scale;
            assert_eq!(scene.city_from_sfm(&pose).scale.to_bits(), given.to_bits());
        }
        let free = refined(&refiner.with_free_scale(), &scene.prior.expected()).city_from_level;
        let scale_error = free.scale * start.scale - 1.0;
        assert!(scale_error.abs() < 1e-3, "a free scale is found: {scale_error} from {start:?}");
    }
}

#[test]
fn a_height_that_no_plane_holds_stays_where_it_was() {
    let made = Made::walls();
    for motion in [Motion::Rigid, Motion::Similarity] {
        let scene = made.scene(&Offset::default(), motion);
        let off = Offset { shift_m: [0.4, -0.3, 0.35], heading_rad: 0.01, ..Offset::default() };
        let refined = refined(&PoseRefiner::new(&scene), &made.pose(&scene, &off));
        let level_m = made.error(&scene, &refined.city_from_level).level_m;
        assert!(level_m < 0.02, "{level_m}");
        // A tilt and a scale that are good to some 1e-4 move the middle, up to 20 m from the cloud's, by millimetres.
        let rise_m = made.rise_m(&scene, &refined.city_from_level);
        assert!((rise_m - 0.35).abs() < 0.01, "{motion:?}: {rise_m}");
        let loosest = refined.parameters.spectrum(&refined.equations.full()).directions()[0];
        assert!(loosest.unit[5].abs() > 0.99 && loosest.sigma_m > 1.0, "{loosest:?}");
    }
}

#[test]
fn one_plane_with_very_many_points_does_not_outweigh_many_planes() {
    let block = Block::four_houses().with_ground();
    // The front of the first house stands 10 cm before its place in the model, and has forty times the points of any other wall.
    let mut front = House { faces: block.houses[0].faces[..1].to_vec() };
    front = front.at([0.0, -0.1, 0.0]);
    let dense = CloudOptions { points_per_wall: 6000, ..walls_alone() };
    let seen = Block { houses: vec![front], ground: None }.cloud(&dense);
    let mut survey = block.cloud(&CloudOptions { points_per_roof: 100, ..CloudOptions::default() });
    survey.sfm.points.extend(&seen.sfm.points);
    survey.face_of_point.extend(vec![None; seen.sfm.points.len()]);
    let made = Made::new(block, survey);
    let pulled_m = |plane_sigma_m: f64| {
        let mut scene = made.scene(&Offset::default(), Motion::Rigid);
        let limits = crate::limits::Limits { plane_sigma_m, ..made.limits };
        scene.limits = &limits;
        made.error(&scene, &refined(&PoseRefiner::new(&scene), &made.truth(&scene)).city_from_level).level_m
    };
    let with_error_model = pulled_m(made.limits.plane_sigma_m);
    assert!(with_error_model < 0.03, "{with_error_model}");
    // Were points independent, they would have their way.
    assert!(pulled_m(0.0) > 0.05, "{}", pulled_m(0.0));
}

#[test]
fn noise_across_the_walls_does_not_make_the_scale_smaller() {
    // Ten centimetres of noise; a smaller cloud has less of it.
    let noisy = CloudOptions { noise_m: 0.1, points_per_roof: 100, outlier_share: 0.0, ..CloudOptions::default() };
    let made = Made::cloud(Block::four_houses().with_ground(), &noisy);
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let refiner = PoseRefiner::new(&scene);
    let rows = refiner.point_plane_matches(&patch_points(&scene), &made.truth(&scene), scene.gate_unit_m);
    let parameters = refiner.assess(&[], &made.truth(&scene), 0.0).parameters;
    let equations = refiner.equations(&parameters, &rows);
    let gradient: f64 = equations.gradient[6];
    let expected: f64 = rows
        .chunk_by(|a, b| a.hit.plane == b.hit.plane)
        .map(|plane| {
            let count: f64 = plane.iter().map(|row| row.weight).sum();
            let variance = refiner.point_sigma_m.powi(2) + count * scene.limits.plane_sigma_m.powi(2);
            let arm = |row: &PointPlaneMatch| {
                (row.hit.normal.dot(&(row.place - parameters.center)) - row.hit.across_m) / parameters.radius
            };
            plane.iter().map(|row| row.weight * arm(row) * row.hit.across_m).sum::<f64>() / variance
        })
        .sum();
    assert!((gradient - expected).abs() < 1e-6 * expected.abs().max(1.0), "{gradient} {expected}");
}

#[test]
fn settling_finds_the_height_by_a_handful_of_points_on_grazed_roofs() {
    let block = Block::four_houses();
    // Five points on each of the roofs (7, 10, 5.5 and 12 m high): too few for a patch.
    let on_roof = |house: usize, height_m: f64| {
        let roof = &block.houses[house].faces[4].corners;
        let middle = (roof[0].coords + roof[1].coords + roof[2].coords + roof[3].coords) / 4.0;
        (0..5).map(move |k| {
            let at = middle + (roof[k % 4].coords - middle) * (0.3 + 0.1 * k as f64);
            assert!((at.z - height_m).abs() < 1e-9);
            (Point3::from(at), Vector3::z())
        })
    };
    let heights = [7.0, 10.0, 5.5, 12.0].into_iter().enumerate();
    let seen: Vec<_> = heights.flat_map(|(house, height_m)| on_roof(house, height_m)).collect();
    let survey = with_points(block.cloud(&walls_alone()), &seen);
    let made = Made::new(block.clone(), survey);
    for motion in [Motion::Rigid, Motion::Similarity] {
        let scene = made.scene(&Offset::default(), motion);
        assert_eq!(
            scene.level_cloud.sample_points.len() - scene.level_cloud.patch_points,
            20,
            "all of the roofs' points are loose"
        );
        let refiner = PoseRefiner::new(&scene);
        for rise_m in [-0.7, 0.31, 0.9] {
            let off = made.pose(&scene, &Offset { shift_m: [0.0, 0.0, rise_m], ..Offset::default() });
            let sharp = refiner.sharpen(&patch_points(&scene), &off, scene.gate_unit_m);
            let left_m = made.rise_m(&scene, &sharp.city_from_level);
            assert!((left_m - rise_m).abs() < 0.02, "walls hold no height: {left_m}");
            let refined_to_end = search_free_directions(&refiner, &all(&scene), sharp, scene.gate_unit_m, 1.2);
            let error = made.error(&scene, &refined_to_end.city_from_level);
            assert!(error.up_m < 0.02 && error.level_m < 0.02, "{error:?} from {rise_m}");
        }
    }
}

#[test]
fn stray_points_beside_a_wall_hold_no_roof_that_is_not_there() {
    let block = Block::four_houses();
    // Behind the front of the first house, 7 m high, in a level row 6.9 m up: they would lie on the edge of its roof, were that
    // lower. Too far off the wall for its patch, and near enough to be taken for its own.
    let stray = |k: i32| (Point3::new(1.5 * f64::from(k), 0.018, 6.9), Vector3::new(0.0, -1.0, 1.0));
    let sharp = CloudOptions { noise_m: 0.004, ..walls_alone() };
    let survey = with_points(block.cloud(&sharp), &(1..8).map(stray).collect::<Vec<_>>());
    let made = Made::new(block, survey);
    let scene = made.scene(&Offset::default(), Motion::Rigid);
    assert_eq!(scene.level_cloud.sample_points.len() - scene.level_cloud.patch_points, 7, "all of them are loose");
    let refiner = PoseRefiner::new(&scene);
    let sharp = refiner.sharpen(&patch_points(&scene), &made.truth(&scene), scene.gate_unit_m);
    let on_roof = made.pose(&scene, &Offset { shift_m: [0.0, 0.0, 0.1], ..Offset::default() });
    let support = |pose: &Similarity| planes_with_points(&refiner, &all(&scene), pose, scene.gate_unit_m);
    assert!(support(&on_roof) > support(&sharp.city_from_level), "they tempt");
    let refined_to_end = search_free_directions(&refiner, &all(&scene), sharp, scene.gate_unit_m, 1.2);
    let rise_m = made.rise_m(&scene, &refined_to_end.city_from_level);
    // Far from the 10 cm that tempt.
    assert!(rise_m.abs() < 0.05, "{rise_m}");
}

#[test]
fn a_loose_point_lies_on_a_facet_only_within_its_noise() {
    let block = Block::four_houses();
    let roof = |k: i32| (Point3::new(1.0 + 2.0 * f64::from(k), 4.0, 7.0), Vector3::z());
    let made =
        Made::new(block.clone(), with_points(block.cloud(&walls_alone()), &(0..5).map(roof).collect::<Vec<_>>()));
    let scene = made.scene(&Offset::default(), Motion::Rigid);
    let loose: Vec<u32> = all(&scene).split_off(scene.level_cloud.patch_points);
    let gate_m = made.limits.refinement.unsegmented_gate_sigmas * scene.level_cloud.noise_m;
    let held = |rise_m: f64| {
        let pose = made.pose(&scene, &Offset { shift_m: [0.0, 0.0, rise_m], ..Offset::default() });
        PoseRefiner::new(&scene).point_plane_matches(&loose, &pose, scene.gate_unit_m).len()
    };
    assert_eq!([0.0, 0.9 * gate_m, 1.1 * gate_m].map(held), [5, 5, 0]);
}

#[test]
fn a_wall_that_leans_by_a_degree_holds_no_height() {
    let block = Block::four_houses();
    let survey = block.cloud(&walls_alone());
    // The front of the first house, as the city has it, hangs over by 15 cm at its top.
    let mut known = block;
    known.houses[0].faces[0].corners.iter_mut().filter(|c| c.z > 1.0).for_each(|c| c.y -= 0.15);
    let made = Made::new(known, survey);
    let scene = made.scene(&Offset::default(), Motion::Rigid);
    let refined = refined(&PoseRefiner::new(&scene), &made.truth(&scene));
    let rise_m = made.rise_m(&scene, &refined.city_from_level);
    // Least squares would lower the cloud by metres to make up for the centimetres.
    assert!(rise_m.abs() < 0.05, "{rise_m}");
    let loosest = refined.parameters.spectrum(&refined.equations.full()).directions()[0];
    assert!(loosest.sigma_m.is_finite() && loosest.sigma_m > made.limits.refinement.most_sigma_m, "{loosest:?}");
}

#[test]
fn what_lies_on_a_plane_is_told_plane_by_plane_and_only_within_the_gate() {
    let made = Made::four_houses();
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let rows =
        PoseRefiner::new(&scene).point_plane_matches(&patch_points(&scene), &made.truth(&scene), scene.gate_unit_m);
    assert!(rows.len() > 2000 && rows.is_sorted_by_key(|row| row.hit.plane), "{}", rows.len());
    let planes = &made.city.planes().planes;
    for row in &rows {
        let across_m = planes[row.hit.plane.0 as usize].plane.signed_distance(&row.place);
        assert!((across_m - row.hit.across_m).abs() < 1e-9 && across_m.abs() < scene.gate_unit_m, "{row:?}");
    }
}

#[test]
fn a_pose_that_finds_no_facet_stays_as_it_is_and_nothing_holds_it() {
    let made = Made::four_houses();
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let lost = made.pose(&scene, &Offset { shift_m: [0.0, 0.0, 500.0], ..Offset::default() });
    let refined = refined(&PoseRefiner::new(&scene), &lost);
    assert_eq!((refined.city_from_level, refined.equations.full().norm()), (lost, 0.0));
}
