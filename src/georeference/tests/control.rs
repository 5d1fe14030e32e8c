//! Starts from control points.

use super::scene::{Capture, Held, ring};
use crate::format::control::{ControlFile, PointRole, PointSight, StoredPoint};
use crate::format::positions::Frame;
use crate::geometry::Point3;
use crate::georeference::{ControlUse, Estimate, GeoreferenceError, from_control_points};

/// Corners of a box about the middle of the capture, absolute.
fn corners(capture: &Capture, count: usize) -> Vec<Point3<f64>> {
    let middle = capture.truth.apply(&capture.sfm.points[0]);
    let corner = |k: usize| {
        let t = k as f64;
        Point3::new(middle.x + 20.0 * (t * 2.1).sin(), middle.y + 15.0 * (t * 1.3).cos(), 1.0 + 8.0 * (t * 0.9).sin())
    };
    (0..count).map(corner).collect()
}

fn couples(capture: &Capture, count: usize) -> ControlFile {
    let sfm_from_city = capture.truth.inverse();
    let point = |(k, p): (usize, &Point3<f64>)| StoredPoint {
        name: format!("g{k}"),
        east_north: [p.x, p.y],
        height_m: p.z,
        sigma_m: Some(0.02),
        role: PointRole::Control,
        sight: PointSight::At(sfm_from_city.apply(p).into()),
    };
    let points = corners(capture, count).iter().enumerate().map(point).collect();
    ControlFile { format: "control points", frame: Frame::OfTheCity, points }
}

/// The same points seen in all photographs that show them.
fn seen(capture: &Capture, count: usize) -> ControlFile {
    let mut file = couples(capture, count);
    for point in &mut file.points {
        let PointSight::At(place) = point.sight else { continue };
        let sights = capture.sfm.images.iter().filter_map(|image| {
            let pixel = capture.sfm.cameras[0].project(&image.cam_from_sfm(&Point3::from(place)))?;
            Some((pixel, image.name.to_uppercase()))
        });
        point.sight = PointSight::In(sights.collect());
        point.sigma_m = None;
    }
    file
}

fn estimate(capture: &Capture, file: &ControlFile) -> Result<Estimate, GeoreferenceError> {
    from_control_points(file, "points.txt", &capture.sfm, &capture.city, None)
}

fn distance(capture: &Capture, found: &Estimate) -> f64 {
    let pose = found.start.city_from_sfm();
    capture.sfm.points.iter().map(|p| (pose.apply(p) - capture.truth.apply(p)).norm()).fold(0.0, f64::max)
}

#[test]
fn exact_points_give_the_place_to_a_hair_by_coordinates_and_by_rays() {
    let capture = ring(Held::Level);
    for file in [couples(&capture, 3), couples(&capture, 6), seen(&capture, 6)] {
        let found = estimate(&capture, &file).unwrap();
        assert!(distance(&capture, &found) < 1e-4, "{}: {} m", file.format, distance(&capture, &found));
        assert!(found.points.iter().all(|p| p.use_of == ControlUse::Control) && found.warnings.is_empty());
        let sigmas = found.start.sigmas();
        // No source is believed better than a city stands in its own system.
        assert!(sigmas.position_m == 0.35 && sigmas.tilt_rad < 0.03, "{sigmas:?}");
    }
}

#[test]
fn check_points_take_no_part_and_are_told() {
    let capture = ring(Held::Level);
    let mut file = couples(&capture, 6);
    (file.points[2].role, file.points[2].height_m) = (PointRole::Check, file.points[2].height_m + 0.37);
    let found = estimate(&capture, &file).unwrap();
    assert!(distance(&capture, &found) < 1e-4);
    let check = found.points.iter().find(|p| p.use_of == ControlUse::Check).unwrap();
    let residual = check.in_city - found.start.city_from_sfm().apply(&check.in_sfm);
    assert!(check.name == "g2" && (residual.z - 0.37).abs() < 1e-4 && residual.xy().norm() < 1e-4, "{residual}");
}

#[test]
fn one_wrong_point_among_six_is_left_out_by_name() {
    let capture = ring(Held::Level);
    let mut file = couples(&capture, 6);
    file.points[4].east_north[0] += 5.0;
    let found = estimate(&capture, &file).unwrap();
    assert!(distance(&capture, &found) < 1e-4, "{}", distance(&capture, &found));
    assert_eq!(found.points[4].use_of, ControlUse::LeftOut);
    assert!(found.warnings[0].contains("g4 is 5.00 m from where the others put it"), "{:?}", found.warnings);
}

#[test]
fn one_wrong_sight_of_a_point_is_left_out() {
    let capture = ring(Held::Level);
    let mut file = seen(&capture, 4);
    let PointSight::In(sights) = &mut file.points[1].sight else { panic!("seen in photographs") };
    sights[3].0[0] += 150.0;
    let found = estimate(&capture, &file).unwrap();
    assert!(distance(&capture, &found) < 1e-3, "{}", distance(&capture, &found));
    assert!(found.warnings.iter().any(|w| w.contains("1 of 21 sights of g1")), "{:?}", found.warnings);
}

#[test]
fn residuals_beyond_the_stated_sigmas_widen_those_of_the_start() {
    let capture = ring(Held::Level);
    let mut file = couples(&capture, 4);
    let stated = estimate(&capture, &file).unwrap().start.sigmas().position_m;
    for (k, point) in file.points.iter_mut().enumerate() {
        point.height_m += if k % 2 == 0 { 6.0 } else { -6.0 };
    }
    let found = estimate(&capture, &file).unwrap();
    assert!(found.start.sigmas().position_m > 1.5 * stated, "{} {stated}", found.start.sigmas().position_m);
    let shift = found.start.city_from_sfm().apply(&found.middle) - capture.truth.apply(&found.middle);
    assert!(
        shift.xy().norm() < 3.0 * found.start.sigmas().position_m
            && shift.z.abs() < 3.0 * found.start.sigmas().height_m
    );
}

#[test]
fn points_that_fix_nothing_are_refused_with_the_reason() {
    let capture = ring(Held::Level);
    let two = estimate(&capture, &couples(&capture, 2)).unwrap_err().to_string();
    assert!(two.contains("2 control points are usable") && two.contains("points.txt"), "{two}");
    let mut line = couples(&capture, 4);
    for (k, point) in line.points.iter_mut().enumerate() {
        let p = Point3::new(90_800.0 + 10.0 * k as f64, 435_600.0, 3.0);
        (point.east_north, point.height_m) = ([p.x, p.y], p.z);
        point.sight = PointSight::At(capture.truth.inverse().apply(&p).into());
    }
    assert!(estimate(&capture, &line).unwrap_err().to_string().contains("not on a line"));
    let mut unseen = seen(&capture, 3);
    unseen.points[0].sight = PointSight::In(vec![([1.0, 2.0], "none.jpg".into())]);
    let message = estimate(&capture, &unseen).unwrap_err().to_string();
    assert!(message.contains("g0 is seen in 0 photographs"), "{message}");
    let mut twice = seen(&capture, 3);
    let PointSight::In(sights) = &mut twice.points[1].sight else { panic!("seen in photographs") };
    sights.truncate(1);
    sights.push(sights[0].clone());
    assert!(estimate(&capture, &twice).unwrap_err().to_string().contains("the 2 rays of g1 do not meet"));
}
