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
