use super::*;
use crate::random::Random;

fn tilted(u: f64, v: f64, off: f64) -> Point3<f64> {
    let n = Vector3::new(1.0, 2.0, 2.0) / 3.0;
    let a = Vector3::new(2.0, -2.0, 1.0) / 3.0;
    Point3::new(10.0, -4.0, 3.0) + a * u + n.cross(&a) * v + n * off
}

#[test]
fn finds_the_plane_of_exact_points() {
    let points = [tilted(0.0, 0.0, 0.0), tilted(4.0, 0.0, 0.0), tilted(0.0, 1.0, 0.0), tilted(4.0, 1.0, 0.0)];
    let fit = fit_plane(points.iter().copied()).unwrap();
    assert!(fit.plane.normal.cross(&Vector3::new(1.0, 2.0, 2.0)).norm() < 1e-12);
    assert!(fit.rms < 1e-7 && (fit.spread[0] - 2.0).abs() < 1e-12 && (fit.spread[1] - 0.5).abs() < 1e-12);
}

#[test]
fn gives_nothing_for_points_on_a_line() {
    assert!(fit_plane((0..5).map(|i| tilted(i as f64, 0.0, 0.0))).is_none());
    assert!(fit_plane((0..5).map(|_| tilted(1.0, 1.0, 0.0))).is_none());
}

#[test]
fn leaves_out_points_off_the_plane() {
    let mut points: Vec<_> = (0..20).map(|i| tilted(f64::from(i % 5), f64::from(i / 5), 0.0)).collect();
    points.extend((0..9).map(|i| tilted(f64::from(i), 2.0, 1.0 + f64::from(i))));
    let (fit, inside) = fit_plane_robustly(&points, 0.05).unwrap();
    assert_eq!(inside, (0..20).collect::<Vec<_>>());
    assert!(fit.rms < 1e-7);
}

/// Points on a random plane, with noise across it.
fn plane_of_points(random: &mut Random, count: usize, noise: f64) -> (Plane, Vec<Point3<f64>>) {
    let normal = random.direction();
    let axes = crate::geometry::Axes::about(&normal);
    let middle = Point3::from(10.0 * random.normal_vector());
    let point = |_| middle + axes.vector(3.0 * random.normal(), random.normal(), noise * random.normal());
    let points = (0..count).map(point).collect();
    (Plane::through(&middle, &normal).unwrap(), points)
}

#[test]
fn no_plane_beside_it_is_nearer_to_the_points() {
    let mut random = Random::stream(81, 0);
    for _ in 0..40 {
        let (_, points) = plane_of_points(&mut random, 25, 0.3);
        let fit = fit_plane(points.iter().copied()).unwrap();
        let loss = |plane: &Plane| points.iter().map(|p| plane.signed_distance(p).powi(2)).sum::<f64>();
        assert!((loss(&fit.plane) / 25.0 - fit.rms * fit.rms).abs() < 1e-10);
        for _ in 0..20 {
            let normal = fit.plane.normal + 0.05 * random.normal_vector();
            let aside = fit.center + 0.05 * random.normal_vector();
            assert!(loss(&Plane::through(&aside, &normal).unwrap()) >= loss(&fit.plane) - 1e-9);
        }
    }
}

#[test]
fn spreads_and_axes_are_those_of_the_points_in_the_plane() {
    let mut random = Random::stream(82, 0);
    let (_, points) = plane_of_points(&mut random, 400, 0.01);
    let fit = fit_plane(points.iter().copied()).unwrap();
    for k in 0..2 {
        let along = points.iter().map(|p| fit.axes[k].dot(&(p - fit.center)).powi(2)).sum::<f64>() / 400.0;
        assert!((along.sqrt() - fit.spread[k]).abs() < 1e-9);
        assert!(fit.axes[k].dot(&fit.plane.normal).abs() < 1e-9);
    }
    assert!(fit.spread[0] > fit.spread[1] && fit.axes[0].dot(&fit.axes[1]).abs() < 1e-9);
}

#[test]
fn a_third_of_the_points_anywhere_does_not_move_a_robust_plane() {
    let mut random = Random::stream(83, 0);
    for _ in 0..20 {
        let (truth, mut points) = plane_of_points(&mut random, 40, 0.005);
        let middle = points[0];
        points.extend((0..20).map(|_| middle + 6.0 * random.normal_vector()));
        let (fit, inside) = fit_plane_robustly(&points, 0.02).unwrap();
        assert!(fit.plane.normal.dot(&truth.normal).abs() > 0.9999, "{}", fit.plane.normal.dot(&truth.normal));
        assert!(inside.iter().filter(|i| **i < 40).count() >= 38 && inside.len() < 46);
    }
}

#[test]
fn points_on_a_line_and_fewer_than_three_have_no_plane() {
    let on_line = (0..9).map(|k| Point3::new(f64::from(k), 2.0 * f64::from(k), -1.0));
    assert!(fit_plane(on_line).is_none());
    assert!(fit_plane([Point3::origin(), Point3::new(1.0, 0.0, 0.0)].into_iter()).is_none());
    assert!(fit_plane_robustly(&[Point3::origin(); 2], 0.1).is_none());
}
