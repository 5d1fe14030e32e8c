use super::*;

/// Made by `tests/data/reconstruction/make_camera_models.py`.
const REFERENCE: &str = include_str!("../../../tests/data/reconstruction/camera_models.json");

/// Pixels; COLMAP's own series for small angles leave this much.
const REFERENCE_TOLERANCE_PX: f64 = 1e-6;

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// A point in the camera frame, and its pixel by COLMAP.
type Case = (Point3<f64>, [f64; 2]);

fn reference() -> Vec<(Camera, Vec<Case>)> {
    let json: serde_json::Value = serde_json::from_str(REFERENCE).unwrap();
    let models = json["models"].as_array().unwrap().iter().map(|model| {
        let id = i32::try_from(model["id"].as_i64().unwrap()).unwrap();
        let camera = Camera {
            model: CameraModel::from_colmap_id(id).unwrap(),
            width_px: 1024,
            height_px: 768,
            params: numbers(&model["params"]),
        };
        let cases = model["cases"].as_array().unwrap().iter().map(|case| {
            let (x, pixel) = (numbers(&case["x_in_cam"]), numbers(&case["pixel"]));
            (Point3::new(x[0], x[1], x[2]), [pixel[0], pixel[1]])
        });
        (camera, cases.collect())
    });
    models.collect()
}

fn apart_px(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn every_model_gives_the_pixels_that_colmap_gives() {
    let reference = reference();
    assert_eq!(reference.len(), CameraModel::ALL.len());
    for (camera, cases) in reference {
        assert!(cases.len() >= 8);
        for (x_in_cam, expected) in cases {
            let pixel = camera.project(&x_in_cam).unwrap();
            assert!(apart_px(pixel, expected) < REFERENCE_TOLERANCE_PX, "{:?} {x_in_cam} {pixel:?}", camera.model);
        }
    }
}

#[test]
fn every_model_leads_back_from_the_pixel_to_the_direction() {
    for (camera, cases) in reference() {
        for (x_in_cam, pixel) in cases {
            let own_pixel = camera.project(&x_in_cam).unwrap();
            let ray = camera.ray(own_pixel).unwrap();
            let angle = ray.cross(&x_in_cam.coords.normalize()).norm();
            assert!(angle < 1e-12 && ray.dot(&x_in_cam.coords) > 0.0, "{:?} {x_in_cam} {angle:e}", camera.model);
            assert!(camera.ray(pixel).is_some());
        }
    }
}

#[test]
fn pixels_all_over_the_picture_have_rays_that_project_back() {
    for (camera, _) in reference() {
        let pixels = (0..=32).flat_map(|x| (0..=24).map(move |y| [32.0 * f64::from(x), 32.0 * f64::from(y)]));
        // The fisheyes of the reference reach 90 degrees off the axis at 590 pixels or more from the centre.
        for pixel in pixels.filter(|p| apart_px(*p, [512.0, 384.0]) < 570.0 && p[0] > 0.0 && p[0] < 1024.0) {
            let ray = camera.ray(pixel).unwrap_or_else(|| panic!("{:?} {pixel:?}", camera.model));
            let back = camera.project(&Point3::from(ray.into_inner())).unwrap();
            assert!(apart_px(back, pixel) < 1e-9, "{:?} {pixel:?} {back:?}", camera.model);
        }
    }
}

#[test]
fn what_is_behind_the_camera_is_in_no_picture_but_a_panorama() {
    for (camera, _) in reference() {
        let is_panorama = camera.model == CameraModel::Equirectangular;
        for x in [Point3::new(0.1, 0.2, -1.0), Point3::new(0.1, 0.2, 0.0)] {
            assert_eq!(camera.project(&x).is_some(), is_panorama, "{:?}", camera.model);
        }
        assert_eq!(camera.project(&Point3::origin()), None);
        assert_eq!(camera.project(&Point3::new(f64::NAN, 0.0, 1.0)), None);
        assert_eq!(camera.ray([f64::NAN, 0.0]), None);
    }
}

#[test]
fn points_beyond_the_fold_of_a_distortion_are_not_shown() {
    let params = vec![500.0, 320.0, 240.0, -0.25];
    let camera = Camera { model: CameraModel::SimpleRadial, width_px: 640, height_px: 480, params };
    // r (1 - 0.25 r^2) turns back at r = 2 / sqrt(3) = 1.1547, where it is 0.7698.
    assert!(camera.project(&Point3::new(1.15, 0.0, 1.0)).is_some());
    assert!(camera.project(&Point3::new(1.16, 0.0, 1.0)).is_none());
    assert!(camera.project(&Point3::new(5.0, 0.0, 1.0)).is_none());
    assert!(camera.ray([320.0 + 500.0 * 0.7697, 240.0]).is_some());
    assert!(camera.ray([320.0 + 500.0 * 0.7699, 240.0]).is_none());
}

#[test]
fn strong_distortions_are_inverted_up_to_their_fold() {
    for k in [-0.6, -0.3, 0.5, 3.0] {
        let params = vec![1.0, 0.0, 0.0, k];
        let camera = Camera { model: CameraModel::SimpleRadial, width_px: 2, height_px: 2, params };
        let fold = if k < 0.0 { (-3.0f64 * k).sqrt().recip() } else { 4.0 };
        for step in 1..100 {
            let r = 0.999 * fold * f64::from(step) / 100.0;
            let pixel = camera.project(&Point3::new(0.6 * r, 0.8 * r, 1.0)).unwrap();
            let ray = camera.ray(pixel).unwrap();
            assert!((ray.xy().norm() / ray.z - r).abs() < 1e-9 * (1.0 + r), "k {k} r {r}");
        }
    }
}

#[test]
fn a_wrong_number_of_parameters_shows_nothing() {
    for model in CameraModel::ALL {
        let camera = Camera { model, width_px: 10, height_px: 10, params: vec![1.0; 1] };
        assert_eq!(camera.project(&Point3::new(0.0, 0.0, 1.0)), None);
        assert_eq!(camera.focal_px(), None);
    }
}

#[test]
fn a_field_of_view_of_zero_is_a_pinhole() {
    for omega in [0.0, 1e-12, 1e-6] {
        let params = vec![500.0, 500.0, 320.0, 240.0, omega];
        let camera = Camera { model: CameraModel::Fov, width_px: 640, height_px: 480, params };
        let pixel = camera.project(&Point3::new(0.3, 0.4, 1.0)).unwrap();
        assert!(apart_px(pixel, [470.0, 440.0]) < 1e-9);
        assert!(
            (camera.ray(pixel).unwrap().xy() / camera.ray(pixel).unwrap().z - Vector2::new(0.3, 0.4)).norm() < 1e-12
        );
    }
}

/// A camera of each model with a usual lens.
fn usual_cameras() -> Vec<Camera> {
    let extra = |model: CameraModel| -> Vec<f64> {
        match model {
            CameraModel::SimplePinhole | CameraModel::SimpleFisheye => vec![800.0, 640.0, 480.0],
            CameraModel::Pinhole | CameraModel::Fisheye => vec![800.0, 810.0, 640.0, 480.0],
            CameraModel::SimpleRadial | CameraModel::SimpleRadialFisheye => vec![800.0, 640.0, 480.0, -0.03],
            CameraModel::Radial | CameraModel::RadialFisheye => vec![800.0, 640.0, 480.0, -0.03, 0.004],
            CameraModel::Opencv => vec![800.0, 810.0, 640.0, 480.0, -0.03, 0.004, 1e-3, -2e-3],
            CameraModel::OpencvFisheye => vec![800.0, 810.0, 640.0, 480.0, -0.01, 0.002, 1e-3, -1e-4],
            CameraModel::FullOpencv => {
                vec![800.0, 810.0, 640.0, 480.0, -0.03, 0.004, 1e-3, -2e-3, 1e-3, 0.01, -0.002, 1e-3]
            }
            CameraModel::Fov => vec![800.0, 810.0, 640.0, 480.0, 0.7],
            CameraModel::ThinPrismFisheye => {
                vec![800.0, 810.0, 640.0, 480.0, -0.01, 0.002, 1e-3, -2e-3, 1e-3, 1e-4, 1e-3, -1e-3]
            }
            CameraModel::RadTanThinPrismFisheye => {
                let mut params = vec![800.0, 810.0, 640.0, 480.0];
                params.extend([-0.01, 0.002, 1e-3, 1e-4, -1e-4, 1e-5, 1e-3, -1e-3, 1e-3, -1e-4, 1e-3, 1e-4]);
                params
            }
            CameraModel::SimpleDivision => vec![800.0, 640.0, 480.0, -0.1],
            CameraModel::Division => vec![800.0, 810.0, 640.0, 480.0, -0.1],
            CameraModel::Eucm => vec![800.0, 810.0, 640.0, 480.0, 0.6, 1.1],
            CameraModel::Equirectangular => vec![1280.0, 960.0],
        }
    };
    let camera = |model| Camera { model, width_px: 1280, height_px: 960, params: extra(model) };
    CameraModel::ALL.into_iter().map(camera).collect()
}

#[test]
fn the_ray_of_a_pixel_leads_to_what_is_seen_there_in_every_model() {
    for camera in usual_cameras() {
        for k in 0..400 {
            let (column, row) = (f64::from(k % 20), f64::from(k / 20));
            let pixel = [32.0 + 64.0 * column, 24.0 + 48.0 * row];
            let ray = camera.ray(pixel).unwrap_or_else(|| panic!("{:?} sees nothing at {pixel:?}", camera.model));
            for distance in [0.5, 40.0] {
                let [x, y] = camera.project(&Point3::from(ray.into_inner() * distance)).unwrap();
                let miss = (x - pixel[0]).hypot(y - pixel[1]);
                assert!(miss < 1e-5, "{:?} at {pixel:?}: {miss}", camera.model);
            }
        }
    }
}

#[test]
fn a_wrong_number_of_parameters_is_no_lens() {
    for camera in usual_cameras() {
        let ahead = Point3::new(0.1, 0.2, 2.0);
        assert!(camera.project(&ahead).is_some(), "{:?}", camera.model);
        let mut longer = camera.clone();
        longer.params.push(0.0);
        let mut shorter = camera.clone();
        shorter.params.pop();
        for wrong in [longer, shorter] {
            assert!(wrong.project(&ahead).is_none() && wrong.ray([600.0, 400.0]).is_none(), "{:?}", camera.model);
            assert!(wrong.focal_px().is_none());
        }
    }
}

#[test]
fn ids_of_models_lead_back_to_them() {
    for model in CameraModel::ALL {
        assert_eq!(CameraModel::from_colmap_id(model.colmap_id()), Some(model));
    }
    assert_eq!(CameraModel::from_colmap_id(-1), None);
    assert_eq!(CameraModel::from_colmap_id(CameraModel::ALL.len() as i32), None);
}
