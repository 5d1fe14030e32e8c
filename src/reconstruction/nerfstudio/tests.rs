use super::*;

fn told() -> NerfstudioCamera {
    NerfstudioCamera { w: Some(80.0), h: Some(60.0), fl_x: Some(70.0), ..NerfstudioCamera::default() }
}

fn made(told: &NerfstudioCamera) -> Option<Camera> {
    camera(told, || None)
}

#[test]
fn what_is_left_out_is_in_the_middle_and_alike_across_and_down() {
    let camera = made(&told()).unwrap();
    assert_eq!((camera.model, camera.params), (CameraModel::Pinhole, vec![70.0, 70.0, 40.0, 30.0]));
}

#[test]
fn each_distortion_has_its_model() {
    let with = |change: fn(&mut NerfstudioCamera)| {
        let mut told = told();
        change(&mut told);
        made(&told)
    };
    let model = |change| with(change).map(|camera| camera.model);
    assert_eq!(model(|t| t.k1 = Some(0.1)), Some(CameraModel::Opencv));
    assert_eq!(model(|t| t.k3 = Some(0.1)), Some(CameraModel::FullOpencv));
    assert_eq!(model(|t| t.camera_model = Some("OPENCV_FISHEYE".into())), Some(CameraModel::OpencvFisheye));
    assert_eq!(model(|t| t.is_fisheye = Some(true)), Some(CameraModel::OpencvFisheye));
    assert_eq!(model(|t| t.camera_model = Some("EQUIRECTANGULAR".into())), Some(CameraModel::Equirectangular));
    assert_eq!(model(|t| t.k4 = Some(0.1)), None);
    assert_eq!(model(|t| t.camera_model = Some("ORTHOPHOTO".into())), None);
    assert_eq!(model(|t| t.fl_x = Some(f64::NAN)), None);
    let full = with(|t| (t.k1, t.k2, t.k3, t.p1) = (Some(1e-2), Some(2e-2), Some(3e-2), Some(4e-2))).unwrap();
    assert_eq!(full.params[4..9], [1e-2, 2e-2, 4e-2, 0.0, 3e-2]);
}

#[test]
fn the_angle_of_view_and_the_picture_stand_in_for_what_is_not_told() {
    let told = NerfstudioCamera { camera_angle_x: Some(std::f64::consts::FRAC_PI_2), ..NerfstudioCamera::default() };
    let camera = camera(&told, || Some((800, 400))).unwrap();
    assert_eq!((camera.width_px, camera.height_px), (800, 400));
    assert!((camera.params[0] - 400.0).abs() < 1e-9, "{:?}", camera.params);
    assert_eq!(made(&told), None);
    assert!(words(&told).contains("neither w and h"));
}

#[test]
fn transforms_that_are_none_are_refused() {
    let model = |rows: Vec<[f64; 4]>, scale: f64| NerfstudioModel {
        applied_transform: Some(rows),
        applied_scale: Some(scale),
        ..NerfstudioModel::default()
    };
    let turn = vec![[1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0]];
    let undone = sfm_from_file(&model(turn.clone(), 0.5)).unwrap();
    // x_file = 0.5 (R x + t).
    let back = undone.apply(&crate::geometry::Point3::new(0.5 * (3.0 + 2.0), 0.5 * 5.0, 0.5 * -4.0));
    assert!((back - crate::geometry::Point3::new(3.0, 4.0, 5.0)).norm() < 1e-12, "{back}");
    let mirrored = vec![[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
    assert!(sfm_from_file(&model(mirrored, 1.0)).is_none());
    for (rows, scale) in [(turn[..2].to_vec(), 1.0), (turn.clone(), 0.0), (turn.clone(), f64::NAN), (turn, -1.0)] {
        assert!(sfm_from_file(&model(rows, scale)).is_none());
    }
    let file = NerfstudioModel { frames: Vec::new(), ..model(vec![[f64::NAN; 4]; 3], 1.0) };
    let message = reconstruction(Path::new("transforms.json"), &file).unwrap_err().to_string();
    assert!(message.contains("applied_transform"), "{message}");
}
