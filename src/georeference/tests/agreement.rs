//! Several sources of one place.

use crate::geometry::{Point3, Rotation3, Similarity, Start, StartSigmas, Vector3};
use crate::georeference::{Estimate, agreed};

const SIGMAS: StartSigmas =
    StartSigmas { position_m: 3.0, height_m: 10.0, heading_rad: 0.03, tilt_rad: 0.02, log_scale: 0.02 };

fn estimate(name: &str, shift: [f64; 3], turn: Rotation3<f64>, scale: f64, sigmas: StartSigmas) -> Estimate {
    let base = Rotation3::from_euler_angles(0.5, 1.0, -2.0);
    let middle = Point3::new(10.0, 20.0, 30.0);
    let image = Point3::new(1000.0, 2000.0, 5.0) + Vector3::from(shift);
    let pose = Similarity::about(&middle, &image, 2.0 * scale, turn * base);
    Estimate::given(Start::new(pose, sigmas).unwrap(), &[middle], name.into())
}

fn heading(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

#[test]
fn sources_that_agree_are_averaged_by_what_each_knows() {
    let fine = StartSigmas { position_m: 1.0, height_m: 10.0, heading_rad: 0.01, tilt_rad: 0.02, log_scale: 0.02 };
    let first = estimate("positions", [0.0; 3], heading(0.0), 1.0, SIGMAS);
    let second = estimate("start", [4.0, 0.0, 6.0], heading(0.04), 1.02, fine);
    let both = agreed(vec![first, second]).unwrap().unwrap();
    let place = both.start.city_from_sfm().apply(&both.middle) - Point3::new(1000.0, 2000.0, 5.0);
    assert!((place - Vector3::new(3.6, 0.0, 3.0)).norm() < 1e-9, "{place}");
    let turn = both.start.city_from_sfm().rotation * Rotation3::from_euler_angles(0.5, 1.0, -2.0).inverse();
    assert!((turn.angle() - 0.036).abs() < 1e-9);
    assert!((both.start.city_from_sfm().scale / 2.0 - 1.02f64.sqrt()).abs() < 1e-9);
    assert!((both.start.sigmas().position_m - 0.9f64.sqrt()).abs() < 1e-9);
    assert_eq!(both.source, "positions; start");
}

#[test]
fn sources_that_disagree_are_both_named_with_what_differs() {
    let lean = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.3);
    for (shift, turn, scale, says) in [
        ([240.0, 0.0, 0.0], heading(0.0), 1.0, "place by 240.00 m (one sigma of both is 4.24 m)"),
        ([0.0, 0.0, 80.0], heading(0.0), 1.0, "height by 80.00 m"),
        ([0.0; 3], heading(0.5), 1.0, "heading by 28.65 degrees"),
        ([0.0; 3], lean, 1.0, "tilt by 17.19 degrees"),
        ([0.0; 3], heading(0.0), 1.5, "scale by 50.0 %"),
    ] {
        let sources = vec![
            estimate("positions", [0.0; 3], heading(0.0), 1.0, SIGMAS),
            estimate("start", shift, turn, scale, SIGMAS),
        ];
        let message = agreed(sources).unwrap_err().to_string();
        assert!(message.contains("positions and start do not agree: ") && message.contains(says), "{message}");
    }
}

#[test]
fn a_source_that_leaves_the_heading_open_contradicts_none() {
    let open = StartSigmas { heading_rad: std::f64::consts::PI, ..SIGMAS };
    let sources =
        vec![estimate("a", [0.0; 3], heading(0.0), 1.0, SIGMAS), estimate("b", [0.0; 3], heading(2.5), 1.0, open)];
    let both = agreed(sources).unwrap().unwrap();
    let turn = both.start.city_from_sfm().rotation * Rotation3::from_euler_angles(0.5, 1.0, -2.0).inverse();
    assert!(turn.angle() < 0.001, "{}", turn.angle());
}

#[test]
fn no_source_is_no_start_and_one_is_itself() {
    assert!(agreed(Vec::new()).unwrap().is_none());
    let one = estimate("a", [1.0, 2.0, 3.0], heading(0.1), 1.1, SIGMAS);
    assert_eq!(agreed(vec![one.clone()]).unwrap().unwrap().start, one.start);
}
