//! Both forms of control points, and what is wrong with them.

use std::path::Path;

use super::read::parse;
use super::{ControlFile, PointRole, PointSight};
use crate::format::positions::Frame;

fn read(text: &str) -> ControlFile {
    parse(text, Path::new("points.txt")).unwrap_or_else(|error| panic!("{text}: {error}"))
}

const COUPLES: &str = "# x y z X Y Z sigma name\n6.47 -40.7 61.0 90890.5 435728.3 13.13 0.03 gcp1\n1 2 3 4 5 6\n1 2 3 4 5 6 0.1 corner check\n";
const GCP: &str = "EPSG:28992\n90890.5 435728.3 13.1 549.81 48.02 p018.jpg gcp1\n90890.5 435728.3 13.1 299.72 25.85 my photo.jpg gcp1\n\
                   1 2 3 10 20 p001.jpg gcp2 check\n7 8 9 10 20 p001.jpg\n7 8 9 30 40 p002.jpg\n";

#[test]
fn couples_have_the_reconstruction_first_then_the_city_then_sigma_and_name() {
    let file = read(COUPLES);
    assert_eq!((file.format, file.frame, file.points.len()), ("control points", Frame::OfTheCity, 3));
    let first = &file.points[0];
    assert_eq!((first.name.as_str(), first.sigma_m, first.role), ("gcp1", Some(0.03), PointRole::Control));
    assert_eq!((first.east_north, first.height_m), ([90890.5, 435728.3], 13.13));
    assert_eq!(first.sight, PointSight::At([6.47, -40.7, 61.0]));
    assert_eq!((file.points[1].name.as_str(), file.points[1].sigma_m), ("point 2", None));
    assert_eq!((file.points[2].name.as_str(), file.points[2].role), ("corner", PointRole::Check));
}

#[test]
fn sights_of_one_point_are_joined_by_its_name_or_its_place() {
    let file = read(GCP);
    assert_eq!((file.format, file.frame, file.points.len()), ("control points in photographs", Frame::Epsg(28992), 3));
    let sights = |k: usize| match &file.points[k].sight {
        PointSight::In(sights) => sights.clone(),
        PointSight::At(_) => panic!("no pixels"),
    };
    assert_eq!(sights(0), [([549.81, 48.02], "p018.jpg".to_owned()), ([299.72, 25.85], "my photo.jpg".to_owned())]);
    assert_eq!((file.points[1].name.as_str(), file.points[1].role), ("gcp2", PointRole::Check));
    assert_eq!((sights(2).len(), file.points[2].name.as_str()), (2, "point 3"));
}

#[test]
fn what_is_no_control_point_is_told_with_its_line() {
    for (text, says) in [
        ("", "it holds no point"),
        ("EPSG:28992\n", "it holds no point"),
        ("1 2 3 4 5\n", "line 1: 5 words"),
        ("1 2 3 4 5 6\n1 2 x 4 5 6\n", "line 2: x is no number"),
        ("1 2 3 4 5 inf\n", "line 1: inf is no number"),
        ("1 2 3 4 5 6 -1\n", "line 1: a sigma of -1"),
        ("1 2 NaN 4 5 a.jpg g\n", "line 1: NaN is no number"),
        ("1 2 3 4 5 a.jpg g\n1 2 9 4 5 b.jpg g\n", "line 2: g stands at another place"),
    ] {
        let message = parse(text, Path::new("points.txt")).unwrap_err().to_string();
        assert!(message.contains(says) && message.ends_with("points.txt"), "{text:?}: {message}");
    }
}

#[test]
fn a_file_that_is_cut_or_altered_anywhere_is_an_error_or_points_with_finite_numbers() {
    for text in [COUPLES, GCP] {
        for cut in 0..text.len() {
            for altered in [text[..cut].to_owned(), [&text[..cut], "e", &text[cut + 1..]].concat()] {
                let Ok(file) = parse(&altered, Path::new("p")) else { continue };
                assert!(
                    file.points.iter().all(|p| p.height_m.is_finite() && p.east_north.iter().all(|v| v.is_finite()))
                );
            }
        }
    }
}
