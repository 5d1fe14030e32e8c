use std::path::Path;

use super::*;
use crate::geometry::{Camera, Rotation3};
use crate::reconstruction::Observation;

const VIEW: PoseReading = PoseReading::AsGiven;

/// Four cameras about a block of points, each of which sees all of them where it should; poses written as `reading`.
fn capture(reading: PoseReading) -> Reconstruction {
    let camera =
        Camera { model: CameraModel::Pinhole, width_px: 800, height_px: 600, params: vec![500.0, 500.0, 400.0, 300.0] };
    let points: Vec<_> = (0..60)
        .map(|i| Point3::new(f64::from(i % 5) - 2.0, f64::from(i / 5 % 4) - 1.5, 0.7 * f64::from(i / 20)))
        .collect();
    let mut r = Reconstruction { cameras: vec![camera], camera_ids: vec![1], points, ..Reconstruction::default() };
    for number in 0..4 {
        let turn = Rotation3::from_euler_angles(0.1, 1.3 * f64::from(number), 0.05);
        let mut image = Image {
            id: number,
            name: format!("{number}.jpg"),
            cam_from_sfm_rotation: turn,
            cam_from_sfm_translation: Vector3::new(0.3, -0.2, 9.0),
            ..Image::default()
        };
        for (index, point) in (0..).zip(&r.points) {
            let [x_px, y_px] = r.cameras[0].project(&image.cam_from_sfm(point)).unwrap();
            image.observations.push(Observation { x_px, y_px, point: Some(PointIndex(index)) });
        }
        let flip = Rotation3::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
        if matches!(reading, PoseReading::OpenGl | PoseReading::InvertedOpenGl) {
            image.cam_from_sfm_rotation = flip * image.cam_from_sfm_rotation;
            image.cam_from_sfm_translation = flip * image.cam_from_sfm_translation;
        }
        if matches!(reading, PoseReading::Inverted | PoseReading::InvertedOpenGl) {
            let center = image.center();
            image.cam_from_sfm_rotation = image.cam_from_sfm_rotation.inverse();
            image.cam_from_sfm_translation = center.coords;
        }
        r.images.push(image);
    }
    r.track_starts = (0..=60).map(|i| 4 * i).collect();
    r.track_elements = (0..60).flat_map(|point| (0..4).map(move |image| (ImageIndex(image), point))).collect();
    r
}

#[test]
fn a_sound_reconstruction_is_left_alone() {
    let mut r = capture(VIEW);
    check(Path::new("sfm"), &mut r).unwrap();
    assert_eq!((r.warnings.len(), r.sight), (0, Sight::Believed));
}

#[test]
fn poses_written_the_wrong_way_round_are_refused_with_what_they_are() {
    for reading in [PoseReading::Inverted, PoseReading::OpenGl, PoseReading::InvertedOpenGl] {
        let mut r = capture(reading);
        let error = check(Path::new("sfm"), &mut r).unwrap_err();
        assert!(matches!(error, ReconstructionError::Contradiction { reading: found, .. } if found == reading));
        let message = error.to_string();
        assert!(message.contains("behind") && message.contains(&reading.to_string()), "{message}");
    }
}

#[test]
fn keypoints_elsewhere_deny_the_lines_of_sight_and_leave_the_tracks() {
    let mut r = capture(VIEW);
    r.images.iter_mut().flat_map(|image| &mut image.observations).for_each(|o| (o.x_px, o.y_px) = (0.0, 0.0));
    check(Path::new("sfm"), &mut r).unwrap();
    assert_eq!((r.warnings.len(), r.warnings[0].kind, r.sight), (1, WarningKind::SightDenied, Sight::Denied));
    assert!(r.warnings[0].to_string().contains("reprojection error"), "{}", r.warnings[0]);
    assert_eq!((r.track(PointIndex(3)).len(), r.seen_by(PointIndex(3)).len()), (4, 0));
}

#[test]
fn a_few_points_behind_cameras_are_told_and_believed() {
    let mut r = capture(VIEW);
    r.points[7] = Point3::new(0.0, 0.0, 400.0);
    r.points[8] = Point3::new(0.0, 400.0, -400.0);
    check(Path::new("sfm"), &mut r).unwrap();
    assert_eq!((r.warnings[0].kind, r.sight), (WarningKind::LooseFit, Sight::Believed));
}

#[test]
fn few_observations_say_nothing() {
    let mut r = capture(PoseReading::Inverted);
    r.track_starts = [0, 4].into_iter().chain([4; 59]).collect();
    r.track_elements.truncate(4);
    check(Path::new("sfm"), &mut r).unwrap();
    assert!(r.warnings.iter().all(|w| w.kind == WarningKind::BlindCameras));
    assert_eq!(r.sight, Sight::Believed);
}

#[test]
fn names_that_two_images_bear_are_counted() {
    let mut r = capture(VIEW);
    r.images[2].name = "0.jpg".into();
    r.images[3].name = "0.jpg".into();
    check(Path::new("sfm"), &mut r).unwrap();
    assert_eq!((r.warnings[0].kind, r.warnings[0].count), (WarningKind::NamesTwice, 2));
    assert!(r.warnings[0].to_string().contains("0.jpg"));
}

/// The capture without its tracks, about one direction alone, so that turned cameras see nothing.
fn without_tracks(reading: PoseReading) -> Reconstruction {
    let mut r = capture(reading);
    (r.track_starts, r.track_elements) = (Vec::new(), Vec::new());
    r.images.iter_mut().for_each(|image| image.observations.clear());
    r
}

#[test]
fn without_tracks_empty_pictures_tell_of_poses_written_the_wrong_way_round() {
    for reading in [PoseReading::OpenGl, PoseReading::InvertedOpenGl] {
        let mut r = without_tracks(reading);
        check(Path::new("sfm"), &mut r).unwrap();
        assert_eq!((r.warnings.len(), r.warnings[0].kind), (1, WarningKind::BlindCameras), "{reading:?}");
        assert!(r.warnings[0].to_string().contains("OpenGL"), "{}", r.warnings[0]);
    }
    let mut r = without_tracks(PoseReading::AsGiven);
    check(Path::new("sfm"), &mut r).unwrap();
    assert!(r.warnings.is_empty());
}
