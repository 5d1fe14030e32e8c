//! Coordinate systems and heights.

use super::scene::{Held, ring};
use crate::format::positions::{Frame, GEOGRAPHIC};
use crate::geometry::Vector3;
use crate::georeference::from_positions;
use crate::georeference::projection::ToCity;

const RD: Frame = Frame::Epsg(28992);

fn placed(from: &Frame, to: &Frame, place: [f64; 2], height_m: f64) -> ([f64; 2], f64) {
    let found = ToCity::new(from, Some(to), "x").unwrap().place(place, Some(height_m)).unwrap();
    (found.east_north, found.height_m.unwrap())
}

fn near(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) < tolerance
}

#[test]
fn degrees_come_out_where_proj_puts_them_with_their_height_kept() {
    // By PROJ 9.5: Rotterdam in the Dutch grid, Munich in UTM 32, Zurich in LV95.
    let (place, height) = placed(&GEOGRAPHIC, &RD, [4.45607299, 51.90592763], 73.284);
    assert!(near(place, [90924.547, 435679.817], 0.1) && height == 73.284, "{place:?}");
    assert!(near(placed(&GEOGRAPHIC, &Frame::Epsg(25832), [9.0, 48.0], 0.0).0, [500_000.0, 5_316_300.0], 1000.0));
    let compound = placed(&GEOGRAPHIC, &Frame::Epsg(7415), [4.45607299, 51.90592763], 1.0);
    assert!(near(compound.0, place, 0.02));
}

#[test]
fn a_plane_at_a_reference_is_that_of_the_ellipsoid_there() {
    let tangent = Frame::Tangent { latitude_deg: 51.9, longitude_deg: 4.45, height_m: 10.0 };
    let (middle, height) = placed(&tangent, &RD, [0.0, 0.0], 5.0);
    assert!(near(middle, placed(&GEOGRAPHIC, &RD, [4.45, 51.9], 0.0).0, 1e-3) && (height - 15.0).abs() < 1e-6);
    let (east, height) = placed(&tangent, &RD, [1000.0, 0.0], 5.0);
    // A plane leaves the Earth by d^2 / 2 R: 78 mm at a kilometre. The Dutch grid's scale is within 1e-4 here.
    assert!((east[0] - middle[0] - 1000.0).abs() < 1.0 && (height - 15.078).abs() < 2e-3, "{height}");
    let (north, _) = placed(&tangent, &RD, [0.0, 1000.0], 5.0);
    assert!((north[1] - middle[1] - 1000.0).abs() < 1.0);
}

#[test]
fn systems_that_are_not_known_are_named() {
    let unknown = |from: &Frame| ToCity::new(from, Some(&RD), "x").err().unwrap().to_string();
    assert!(unknown(&Frame::Epsg(999_999)).contains("EPSG:999999"));
    assert!(unknown(&Frame::Proj("+proj=nonsense".into())).contains("nonsense"));
    // Heights alone are no system to stand in.
    assert!(unknown(&Frame::Epsg(5709)).contains("EPSG:5709"));
}

#[test]
fn heights_are_read_above_the_ellipsoid_or_the_sea_as_the_city_tells() {
    let capture = ring(Held::Level);
    // The geoid is 43.6 m above the ellipsoid in Rotterdam.
    for (shift_m, says) in [(43.6, "above the ellipsoid"), (0.0, "above the sea")] {
        let mut file = capture.positions(0.0, Vector3::new(0.0, 0.0, shift_m), 1);
        let back = ToCity::new(&RD, Some(&GEOGRAPHIC), "x").unwrap();
        for position in &mut file.positions {
            position.east_north = position.east_north.map(|place| back.place(place, None).unwrap().east_north);
        }
        file.frame = GEOGRAPHIC;
        let found = from_positions(&file, "x", &capture.sfm, &capture.city, Some(&RD)).unwrap();
        let place = found.start.city_from_sfm().apply(&found.middle);
        let distance = (place - capture.truth.apply(&found.middle)).norm();
        assert!(distance < 0.5 && found.source.contains(says), "{distance} m, {}", found.source);
        assert!(found.start.sigmas().height_m >= 10.0);
    }
}

#[test]
fn a_file_in_the_systems_own_coordinates_is_taken_as_it_stands() {
    let place = [90_924.5, 435_679.8];
    for (from, city) in [
        (Frame::OfTheCity, Some(RD)),
        (RD, Some(RD)),
        (Frame::OfTheCity, None),
        (RD, None),
        (RD, Some(Frame::OfTheCity)),
    ] {
        let way = ToCity::new(&from, city.as_ref(), "x").unwrap();
        assert_eq!(way.place(place, Some(3.0)).unwrap().east_north, place, "{from:?} {city:?}");
        assert!(way.keeps_heights() && !way.is_geographic() && way.geographic(place).is_none());
    }
    assert!(ToCity::new(&GEOGRAPHIC, None, "x").is_err());
    let projected = ToCity::new(&Frame::Epsg(32631), Some(&RD), "x").unwrap();
    assert!(!projected.keeps_heights() && !projected.is_geographic());
}

#[test]
fn a_place_beyond_a_projection_is_an_error_with_both_systems() {
    let way = ToCity::new(&GEOGRAPHIC, Some(&Frame::Epsg(25832)), "geo.txt").unwrap();
    // Latitude and longitude exchanged, at a latitude that no place has.
    let Err(error) = way.place([51.9, 104.4], None) else { panic!("104 degrees of latitude are a place") };
    let message = error.to_string();
    assert!(
        message.contains("EPSG:4326") && message.contains("EPSG:25832") && message.ends_with("geo.txt"),
        "{message}"
    );
}

#[test]
fn a_projected_system_that_is_no_code_is_taken_by_its_own_words() {
    let utm = Frame::Proj("+proj=utm +zone=31 +datum=WGS84 +units=m +no_defs".into());
    let (by_words, _) = placed(&GEOGRAPHIC, &utm, [4.45, 51.9], 0.0);
    assert!(near(by_words, placed(&GEOGRAPHIC, &Frame::Epsg(32631), [4.45, 51.9], 0.0).0, 1e-3));
    // There and back.
    let (back, _) = placed(&utm, &GEOGRAPHIC, by_words, 0.0);
    assert!(near(back, [4.45, 51.9], 1e-9), "{back:?}");
}
