//! Starts from positions of photographs.

use super::scene::{Capture, Held, ring, street};
use crate::format::positions::{Frame, PositionsFile};
use crate::geometry::{Point3, Vector3};
use crate::georeference::{Estimate, GeoreferenceError, from_positions};

fn estimate(capture: &Capture, file: &PositionsFile) -> Result<Estimate, GeoreferenceError> {
    from_positions(file, "positions.txt", &capture.sfm, &capture.city, None)
}

/// How far a start is off, in its own sigmas: place, height, heading, tilt and scale; and its tilt in degrees.
fn off(capture: &Capture, found: &Estimate) -> ([f64; 5], f64) {
    let (pose, s) = (found.start.city_from_sfm(), found.start.sigmas());
    let shift = pose.apply(&found.middle) - capture.truth.apply(&found.middle);
    let turn = pose.rotation * capture.truth.rotation.inverse();
    let r = turn.matrix();
    let heading = (r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)]);
    let tilt = (turn * Vector3::z()).angle(&Vector3::z());
    let scale = (pose.scale / capture.truth.scale).ln();
    let in_sigmas = [
        shift.xy().norm() / s.position_m,
        shift.z.abs() / s.height_m,
        heading.abs() / s.heading_rad,
        tilt / s.tilt_rad,
        scale.abs() / s.log_scale,
    ];
    (in_sigmas, tilt.to_degrees())
}

#[test]
fn exact_positions_give_the_place_whatever_way_cameras_are_held() {
    for capture in [ring(Held::Level), ring(Held::QuarterTurned), street(Held::Level), street(Held::QuarterTurned)] {
        let found = estimate(&capture, &capture.positions(0.0, Vector3::zeros(), 1)).unwrap();
        let pose = found.start.city_from_sfm();
        for p in &capture.sfm.points {
            let distance = (pose.apply(p) - capture.truth.apply(p)).norm();
            assert!(distance < 0.05, "{distance} m off");
        }
        assert!(found.source.starts_with("positions of 21 photographs") && found.warnings.is_empty());
    }
}

#[test]
fn the_positions_of_phones_give_a_start_within_three_of_its_sigmas_and_never_a_tilt() {
    for (what, capture) in [("ring", ring(Held::Level)), ("street", street(Held::Level))] {
        for seed in 0..40 {
            let shared = Vector3::new(
                3.0 * (seed as f64).sin(),
                3.0 * (seed as f64 * 1.7).cos(),
                8.0 * (seed as f64 * 0.9).sin(),
            );
            let found = estimate(&capture, &capture.positions(3.0, shared, seed)).unwrap();
            let (in_sigmas, tilt_deg) = off(&capture, &found);
            assert!(in_sigmas.iter().all(|sigmas| *sigmas < 3.5), "{what}, seed {seed}: {in_sigmas:?}");
            assert!(tilt_deg < 3.0, "{what}, seed {seed}: {tilt_deg} degrees");
        }
    }
}

#[test]
fn a_third_of_wrong_positions_changes_nothing_and_the_farthest_is_named() {
    let capture = ring(Held::Level);
    let mut file = capture.positions(1.0, Vector3::zeros(), 5);
    for (k, position) in file.positions.iter_mut().enumerate().filter(|(k, _)| k % 3 == 0) {
        position.east_north =
            position.east_north.map(|[x, y]| [x + 80.0 + 37.0 * k as f64, y - 11.0 * (k * k % 7) as f64]);
    }
    let found = estimate(&capture, &file).unwrap();
    let (in_sigmas, _) = off(&capture, &found);
    assert!(in_sigmas.iter().all(|sigmas| *sigmas < 3.0), "{in_sigmas:?}");
    assert!(
        found.warnings.iter().any(|w| w.starts_with("7 of 21 positions") && w.contains("p018.jpg")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn gravity_is_believed_before_the_way_cameras_are_held() {
    let capture = street(Held::Rolled(0.4));
    let mut file = capture.positions(0.5, Vector3::zeros(), 2);
    let (_, tilt_deg) = off(&capture, &estimate(&capture, &file).unwrap());
    assert!(tilt_deg > 3.0, "rolled cameras mislead, or this test shows nothing: {tilt_deg}");
    let down_in_sfm = capture.truth.rotation.inverse() * -Vector3::z();
    for (position, image) in file.positions.iter_mut().zip(&capture.sfm.images) {
        position.gravity_in_cam = Some((image.cam_from_sfm_rotation * down_in_sfm * 9.81).into());
    }
    // One reading is that of a camera that was shaken.
    file.positions[4].gravity_in_cam = Some([1.0, 0.0, 0.0]);
    let (in_sigmas, tilt_deg) = off(&capture, &estimate(&capture, &file).unwrap());
    assert!(tilt_deg < 0.01 && in_sigmas.iter().all(|sigmas| *sigmas < 3.0), "{tilt_deg}, {in_sigmas:?}");
}

#[test]
fn sigmas_grow_with_the_noise_and_where_the_cloud_is_far_from_the_cameras() {
    let capture = ring(Held::Level);
    let sigmas = |noise| *estimate(&capture, &capture.positions(noise, Vector3::zeros(), 3)).unwrap().start.sigmas();
    let (quiet, noisy) = (sigmas(0.1), sigmas(20.0));
    assert!(noisy.heading_rad > 3.0 * quiet.heading_rad && noisy.log_scale > 3.0 * quiet.log_scale);
    let mut far = ring(Held::Level);
    let aside = far.truth.inverse().rotation * Vector3::new(100.0, 0.0, 0.0);
    far.sfm.points.iter_mut().for_each(|p| *p += aside);
    let found = estimate(&far, &far.positions(0.1, Vector3::zeros(), 3)).unwrap();
    assert!(found.start.sigmas().position_m > 2.0 * quiet.position_m);
}

#[test]
fn stated_accuracies_take_the_place_of_the_usual_ones() {
    let capture = ring(Held::Level);
    let mut file = capture.positions(0.02, Vector3::zeros(), 3);
    let usual = *estimate(&capture, &file).unwrap().start.sigmas();
    for position in &mut file.positions {
        (position.sigma_m, position.height_sigma_m) = (Some(0.02), Some(0.05));
    }
    let stated = *estimate(&capture, &file).unwrap().start.sigmas();
    assert!(stated.position_m < 0.5 * usual.position_m && stated.height_m < 0.5 * usual.height_m, "{stated:?}");
}

#[test]
fn positions_that_tell_nothing_are_refused_with_what_to_do() {
    let capture = ring(Held::Level);
    let whole = capture.positions(1.0, Vector3::zeros(), 3);
    let refused = |change: &dyn Fn(&mut PositionsFile)| {
        let mut file = whole.clone();
        change(&mut file);
        estimate(&capture, &file).unwrap_err().to_string()
    };
    let one_place = refused(&|file| {
        let scatter = |k: usize| [90_000.0 + (k as f64 * 7.1).sin() * 0.6, 435_000.0 + (k as f64 * 3.7).cos() * 0.6];
        file.positions.iter_mut().enumerate().for_each(|(k, p)| p.east_north = Some(scatter(k)));
    });
    let says = one_place.contains("neither heading nor scale") || one_place.contains("fit the cameras");
    assert!(says, "{one_place}");
    let same = refused(&|file| file.positions.iter_mut().for_each(|p| p.east_north = Some([90_000.0, 435_000.0])));
    assert!(same.contains("neither heading nor scale"), "{same}");
    let flat = refused(&|file| file.positions.iter_mut().for_each(|p| p.height_m = None));
    assert!(flat.contains("none of the positions has a height"), "{flat}");
    let others = refused(&|file| file.positions.iter_mut().for_each(|p| p.name = format!("other_{}", p.name)));
    assert!(
        others.contains("0 of 21 names") && others.contains("other_p000.jpg") && others.contains("flight/p000.jpg"),
        "{others}"
    );
    let degrees = refused(&|file| file.frame = Frame::Epsg(4326));
    assert!(degrees.contains("--crs EPSG:"), "{degrees}");
    let mut cloud = ring(Held::Level);
    cloud.sfm.images.clear();
    assert!(estimate(&cloud, &whole).unwrap_err().to_string().contains("has no cameras"));
}

#[test]
fn two_positions_are_enough_and_say_how_little_they_know() {
    let capture = street(Held::Level);
    let mut file = capture.positions(0.0, Vector3::zeros(), 1);
    file.positions = vec![file.positions[0].clone(), file.positions[20].clone()];
    let found = estimate(&capture, &file).unwrap();
    let place = found.start.city_from_sfm().apply(&found.middle);
    assert!((place - capture.truth.apply(&found.middle)).norm() < 0.05);
    assert!(found.start.sigmas().heading_rad > 0.08, "5 m over 50 m: {:?}", found.start.sigmas());
}

#[test]
fn names_are_matched_by_the_ending_of_their_path_then_by_their_stem() {
    let mut capture = ring(Held::Level);
    let mut file = capture.positions(0.0, Vector3::zeros(), 1);
    let given = ["FLIGHT\\P000.JPG", "/home/me/flight/p001.jpg", "p002.png", "p003"];
    for (position, name) in file.positions.iter_mut().zip(given) {
        position.name = name.into();
    }
    let found = estimate(&capture, &file).unwrap();
    assert!(found.source.starts_with("positions of 21"), "{}", found.source);
    capture.sfm.images[5].name = "second/p004.jpg".into();
    file.positions[4].name = "p004.jpg".into();
    let message = estimate(&capture, &file).unwrap_err().to_string();
    assert!(message.contains("p004.jpg may be flight/p004.jpg or second/p004.jpg"), "{message}");
    file.positions[4].name = "flight/p004.jpg".into();
    assert!(estimate(&capture, &file).is_ok());
}

#[test]
fn a_start_that_cannot_reach_the_city_says_how_far_it_is() {
    let capture = ring(Held::Level);
    let near = estimate(&capture, &capture.positions(1.0, Vector3::zeros(), 1)).unwrap();
    assert!(near.distance_to_city(&capture.sfm.points, &capture.city).unwrap() < 20.0);
    let far = estimate(&capture, &capture.positions(1.0, Vector3::new(0.0, 5200.0, 0.0), 1)).unwrap();
    let message = far.distance_to_city(&capture.sfm.points, &capture.city).unwrap_err().to_string();
    assert!(
        message.contains("the start is 5.2 km from the city's nearest facet") && message.contains("--crs"),
        "{message}"
    );
    let empty = crate::city::CityModel::default();
    assert_eq!(far.distance_to_city(&[Point3::origin()], &empty).unwrap(), 0.0);
}

#[test]
fn north_before_east_is_told_as_such() {
    let capture = ring(Held::Level);
    let mut file = capture.positions(1.0, Vector3::zeros(), 1);
    file.positions.iter_mut().filter_map(|p| p.east_north.as_mut()).for_each(|place| place.reverse());
    let message = estimate(&capture, &file).unwrap_err().to_string();
    assert!(message.contains("east and north are exchanged") && message.contains("positions.txt"), "{message}");
}

#[test]
fn positions_of_another_flight_are_refused_as_scattered_or_without_scale() {
    let capture = ring(Held::Level);
    for seed in 0..10 {
        let mut random = crate::robust::Random::stream(seed, 3);
        let mut file = capture.positions(0.0, Vector3::zeros(), seed);
        for position in &mut file.positions {
            position.east_north = Some([90_000.0 + 900.0 * random.unit(), 435_000.0 + 900.0 * random.unit()]);
        }
        let message = estimate(&capture, &file).map(|found| found.source).unwrap_err().to_string();
        assert!(message.contains("fit the cameras") || message.contains("neither heading nor scale"), "{message}");
    }
}

#[test]
fn two_positions_of_one_photograph_count_once_and_strangers_are_counted() {
    let capture = ring(Held::Level);
    let mut file = capture.positions(0.0, Vector3::zeros(), 1);
    let mut twice = file.positions[3].clone();
    twice.east_north = Some([0.0, 0.0]);
    file.positions.push(twice);
    let mut stranger = file.positions[0].clone();
    stranger.name = "elsewhere.jpg".into();
    file.positions.push(stranger);
    let found = estimate(&capture, &file).unwrap();
    assert!(found.source.starts_with("positions of 21 photographs"), "{}", found.source);
    assert_eq!(
        found.warnings,
        ["2 of 23 positions are of photographs that the reconstruction does not have, or has already"]
    );
}

#[test]
fn warnings_of_the_file_are_handed_on() {
    let capture = ring(Held::Level);
    let mut file = capture.positions(0.0, Vector3::zeros(), 1);
    file.warnings.push("3 photographs without a GPS position".into());
    assert_eq!(estimate(&capture, &file).unwrap().warnings, file.warnings);
}

#[test]
fn large_coordinates_lose_nothing() {
    let mut capture = ring(Held::Level);
    let aside = Vector3::new(500_000.0, 5_300_000.0, 0.0);
    capture.truth.translation += aside;
    capture.city.origin += aside;
    capture.centers.iter_mut().for_each(|center| *center += aside);
    let found = estimate(&capture, &capture.positions(0.0, Vector3::zeros(), 1)).unwrap();
    let place = found.start.city_from_sfm().apply(&found.middle);
    assert!((place - capture.truth.apply(&found.middle)).norm() < 0.05);
}
