use super::*;
use crate::correspondence::test_scene::{Made, walls_alone, with_points};
use crate::robust::Motion;
use crate::synthetic::{Block, CloudOptions, Offset};

#[test]
fn the_level_frame_stands_upright_about_the_cloud_in_metres_of_the_start() {
    let made = Made::four_houses();
    let start = Offset { heading_rad: 0.2, tilt_rad: [0.05, 0.1], scale: 1.1, ..Offset::default() };
    let level_cloud = made.scene(&start, Motion::Similarity).level_cloud;
    assert_eq!(level_cloud.level_from_sfm.apply(&made.patches.middle()), Point3::origin());
    let up = level_cloud.level_from_sfm.rotation * made.survey.city_from_sfm.rotation.inverse() * Vector3::z();
    assert!((up - Vector3::z()).norm() < 1e-12, "{up}");
    assert!((level_cloud.level_from_sfm.scale / (1.1 * made.survey.city_from_sfm.scale) - 1.0).abs() < 1e-12);
    // Axis by axis 2 cm, and the start's scale.
    assert!((level_cloud.noise_m / (1.1 * 0.02) - 1.0).abs() < 0.2, "{}", level_cloud.noise_m);
}

#[test]
fn weights_are_one_vote_together_and_little_ground_is_heard_beside_many_walls() {
    let seen = CloudOptions { points_on_ground: 60, ..walls_alone() };
    let made = Made::cloud(Block::four_houses().with_ground(), &seen);
    let level_cloud = made.scene(&Offset::default(), Motion::Rigid).level_cloud;
    assert!((level_cloud.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    let of_ground: f64 = level_cloud.patches.iter().filter(|p| p.normal.z > 0.9).map(|p| p.weight).sum();
    let share_of_points = 60.0 / level_cloud.patch_points as f64;
    assert!(of_ground > 2.0 * share_of_points, "{of_ground} {share_of_points}");
    for patch in &level_cloud.patches {
        let sum: f64 = level_cloud.weights[patch.sample_points.clone()].iter().sum();
        assert!((sum - patch.weight).abs() < 1e-12);
    }
}

#[test]
fn a_panel_gives_every_patch_its_share_and_loose_points_nothing() {
    let roof = |k: i32| (Point3::new(1.0 + f64::from(k), 4.0, 7.0), Vector3::z());
    let survey = with_points(Block::four_houses().cloud(&walls_alone()), &(0..5).map(roof).collect::<Vec<_>>());
    let made = Made::new(Block::four_houses(), survey);
    let level_cloud = made.scene(&Offset::default(), Motion::Rigid).level_cloud;
    assert_eq!(level_cloud.sample_points.len(), level_cloud.patch_points + 5);
    for count in [1, 200, 1500] {
        let point_subset = level_cloud.point_subset(count);
        assert_eq!(point_subset.len(), count);
        assert!(point_subset.iter().all(|i| (*i as usize) < level_cloud.patch_points));
        for patch in &level_cloud.patches {
            let drawn = point_subset.iter().filter(|i| patch.sample_points.contains(&(**i as usize))).count() as f64;
            assert!((drawn - patch.weight * count as f64).abs() <= 1.0, "{drawn} of {count}, {}", patch.weight);
        }
    }
}

#[test]
fn the_extent_holds_the_cloud_but_for_stray_points() {
    let made = Made::four_houses();
    let level_cloud = made.scene(&Offset::default(), Motion::Rigid).level_cloud;
    let extent = level_cloud.extent();
    let holds = |p: &OrientedPoint| {
        let z = p.position.z;
        p.position.coords.xy().norm() <= extent.radius_m && z >= extent.bottom_m && z <= extent.top_m
    };
    let held = level_cloud.sample_points[..level_cloud.patch_points].iter().filter(|p| holds(p)).count();
    // The radius of nine in ten, and a fifth more.
    assert!(held as f64 > 0.9 * level_cloud.patch_points as f64, "{held} of {}", level_cloud.patch_points);
    // The houses are up to 12 m high.
    assert!((extent.top_m - extent.bottom_m - 12.0).abs() < 1.0, "{extent:?}");
}
