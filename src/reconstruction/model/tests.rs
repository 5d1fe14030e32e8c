use super::*;

#[test]
fn tracks_are_the_stretches_of_their_points_and_empty_where_none_are_known() {
    let element = |k: u32| (ImageIndex(k), 10 * k);
    let r = Reconstruction {
        points: vec![Point3::origin(); 3],
        track_starts: vec![0, 2, 2, 3],
        track_elements: (0..3).map(element).collect(),
        ..Reconstruction::default()
    };
    assert_eq!(r.track(PointIndex(0)), [element(0), element(1)]);
    assert!(r.track(PointIndex(1)).is_empty());
    assert_eq!(r.track(PointIndex(2)), [element(2)]);
    assert!(r.track(PointIndex(3)).is_empty());
    let cloud = Reconstruction { points: vec![Point3::origin(); 3], ..Reconstruction::default() };
    assert!(cloud.track(PointIndex(1)).is_empty());
}

#[test]
fn a_camera_sees_its_own_centre_at_its_origin() {
    let mut random = crate::random::Random::stream(111, 0);
    for _ in 0..20 {
        let image = Image {
            cam_from_sfm_rotation: random.rotation(),
            cam_from_sfm_translation: random.normal_vector(),
            ..Image::default()
        };
        assert!(image.cam_from_sfm(&image.center()).coords.norm() < 1e-12);
        let ahead = image.center() + image.cam_from_sfm_rotation.inverse() * Vector3::z() * 3.0;
        assert!((image.cam_from_sfm(&ahead) - Point3::new(0.0, 0.0, 3.0)).norm() < 1e-12);
    }
}
