use super::*;
use crate::geometry::Point3;

fn image(quaternion_wxyz: [f64; 4]) -> Image {
    let mut image = Image::default();
    image.set_pose(&PoseRecord { quaternion_wxyz, translation: [1.0, -2.0, 0.5] });
    image
}

#[test]
fn the_quaternion_that_was_read_is_kept_until_the_rotation_changes() {
    let mut image = image([-0.6, 0.0, 0.80001, 0.0]);
    assert_eq!(image.pose().quaternion_wxyz, [-0.6, 0.0, 0.80001, 0.0]);
    image.cam_from_sfm_rotation = Rotation3::from_euler_angles(0.0, 0.0, 0.5);
    let [w, x, y, z] = image.pose().quaternion_wxyz;
    assert!((w - 0.25f64.cos()).abs() < 1e-15 && x == 0.0 && y == 0.0 && (z - 0.25f64.sin()).abs() < 1e-15);
}

#[test]
fn a_moved_camera_sees_the_moved_points_larger_by_the_scale() {
    let city_from_sfm = Similarity {
        scale: 2.5,
        rotation: Rotation3::from_euler_angles(0.3, -0.4, 1.9),
        translation: Vector3::new(5.0, -7.0, 0.5),
    };
    let point = Point3::new(0.3, 0.7, 9.0);
    let before =
        Reconstruction { points: vec![point], images: vec![image([0.6, 0.0, 0.8, 0.0])], ..Default::default() };
    let after = before.transformed(&city_from_sfm);
    let x_in_cam = before.images[0].cam_from_sfm(&point);
    assert!((after.images[0].cam_from_sfm(&after.points[0]) - x_in_cam * 2.5).norm() < 1e-14);
}

#[test]
fn quaternions_without_direction_have_no_rotation() {
    assert_eq!(rotation_of(&[0.0; 4]), None);
    assert_eq!(rotation_of(&[f64::NAN, 0.0, 0.0, 1.0]), None);
    assert_eq!(rotation_of(&[f64::INFINITY, 0.0, 0.0, 1.0]), None);
    assert_eq!(rotation_of(&[-2.0, 0.0, 0.0, 0.0]), Some(Rotation3::identity()));
}

#[test]
fn the_largest_quaternions_have_their_rotation() {
    let turned = rotation_of(&[0.0, 1e308, -1e308, 0.0]).unwrap();
    assert_eq!(turned, rotation_of(&[0.0, 1.0, -1.0, 0.0]).unwrap());
    let most = rotation_of(&[f64::MAX; 4]).unwrap();
    assert_eq!(most, rotation_of(&[1.0; 4]).unwrap());
    assert_eq!(rotation_of(&[1e308, f64::INFINITY, 0.0, 0.0]), None);
}

fn small() -> Reconstruction {
    Reconstruction {
        points: vec![Point3::new(0.3, 0.7, 9.0), Point3::new(-2.0, 1.0, 5.0)],
        normals: vec![Vector3::x(), Vector3::new(0.0, 0.6, 0.8)],
        images: vec![image([0.6, 0.0, 0.8, 0.0]), image([0.5, -0.5, 0.5, 0.5])],
        ..Default::default()
    }
}

fn any(random: &mut crate::random::Random) -> Similarity {
    Similarity {
        scale: 0.3 + 2.0 * random.unit(),
        rotation: random.rotation(),
        translation: 5.0 * random.normal_vector(),
    }
}

fn assert_alike(one: &Reconstruction, other: &Reconstruction) {
    for (a, b) in one.points.iter().zip(&other.points) {
        assert!((a - b).norm() < 1e-11);
    }
    for (a, b) in one.normals.iter().zip(&other.normals) {
        assert!((a - b).norm() < 1e-12);
    }
    for (a, b) in one.images.iter().zip(&other.images) {
        assert!((a.center() - b.center()).norm() < 1e-10);
        assert!((a.cam_from_sfm_rotation.matrix() - b.cam_from_sfm_rotation.matrix()).norm() < 1e-12);
    }
}

#[test]
fn two_moves_are_their_product_and_a_move_back_undoes_one() {
    let mut random = crate::random::Random::stream(75, 0);
    for _ in 0..30 {
        let (a, b) = (any(&mut random), any(&mut random));
        assert_alike(&small().transformed(&a).transformed(&b), &small().transformed(&(b * a)));
        assert_alike(&small().transformed(&a).transformed(&a.inverse()), &small());
    }
}

#[test]
fn centres_of_cameras_move_as_points_do() {
    let mut random = crate::random::Random::stream(76, 0);
    for _ in 0..30 {
        let move_by = any(&mut random);
        for (before, after) in small().images.iter().zip(&small().transformed(&move_by).images) {
            assert!((after.center() - move_by.apply(&before.center())).norm() < 1e-10);
        }
    }
}

#[test]
fn a_skeleton_has_what_a_frame_changes_and_no_keypoints() {
    let mut r = small();
    r.images[0].observations.push(crate::reconstruction::Observation { x_px: 1.0, y_px: 2.0, point: None });
    let skeleton = r.skeleton();
    assert_eq!((&skeleton.points, skeleton.images.len()), (&r.points, 2));
    assert!(skeleton.images.iter().all(|image| image.observations.is_empty()));
    assert_eq!(skeleton.images[0].cam_from_sfm_translation, r.images[0].cam_from_sfm_translation);
    assert!(skeleton.track_elements.is_empty() && skeleton.normals.is_empty());
}

#[test]
fn quaternions_of_any_length_and_sign_have_the_same_rotation() {
    let mut random = crate::random::Random::stream(77, 0);
    for _ in 0..100 {
        let q: [f64; 4] = std::array::from_fn(|_| random.normal());
        let expected = rotation_of(&q).unwrap();
        for factor in [-1.0, 7.0, -1e-3, 1e90] {
            let found = rotation_of(&q.map(|v| factor * v)).unwrap();
            assert!((found.matrix() - expected.matrix()).norm() < 1e-13);
        }
        let back = quaternion_of(&expected);
        assert!((rotation_of(&back).unwrap().matrix() - expected.matrix()).norm() < 1e-13);
    }
}
