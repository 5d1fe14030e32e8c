use super::super::test_scene::{RADIUS, scene, truth};
use super::*;
use crate::geometry::Matrix3;
use crate::random::Random;

#[test]
fn both_ways_measure_the_same_distance_with_the_same_sense() {
    let planes = scene(1e-7, |x| *x);
    let moved = Similarity { translation: truth().translation + Vector3::new(0.01, 0.02, -0.01), ..truth() };
    for pair in planes.groups.chunks(2) {
        let measured = |g: &PlaneGroup| {
            let m = g.measured(&g.points[0], &moved, 0.0, planes.radius);
            // The fitted normals' senses are arbitrary.
            m.residual * m.normal
        };
        assert!((measured(&pair[0]) - measured(&pair[1])).norm() < 1e-5);
    }
}

#[test]
fn a_plane_is_known_worse_away_from_its_centre() {
    let planes = scene(0.002, |x| *x);
    let group = &planes.groups[0];
    let (center, plane) = (group.plane.center, &group.plane);
    let at_center = group.variance / group.plane_points as f64;
    assert!((group.plane_variance(&center) - at_center).abs() < 1e-15);
    // Two spreads along an axis: 1 + 4 times the variance at the centre.
    let beside = center + plane.axes[0] * 2.0 * plane.spread[0];
    assert!((group.plane_variance(&beside) - 5.0 * at_center).abs() < 1e-12);
    assert!(group.is_beside(&(center + plane.axes[0] * 7.0 * plane.spread[0])));
    assert!(RADIUS > 7.0 * plane.spread[0]);
}

#[test]
fn a_heap_of_points_and_a_plane_seen_edge_on_are_no_plane() {
    let at = |x: f64, y: f64, z: f64| KnownPoint { at: Point3::new(x, y, z), covariance: Matrix3::identity() * 1e-4 };
    let limits = MergeLimits::default();
    let group = |points: &[KnownPoint], eye: Point3<f64>| PlaneGroup::of(PlaneOf::A, points, points, &eye, &limits);
    let flat = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(1.0, 1.0, 0.0), at(0.4, 0.7, 0.0)];
    assert!(group(&flat, Point3::new(0.0, 0.0, 9.0)).is_some());
    assert!(group(&flat, Point3::new(9.0, 0.0, 0.1)).is_none());
    let heap = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.9), at(0.0, 1.0, 0.8), at(1.0, 1.0, 0.1), at(0.4, 0.7, -1.0)];
    assert!(group(&heap, Point3::new(0.0, 0.0, 9.0)).is_none());
}

#[test]
fn the_variance_of_a_plane_at_a_place_is_the_scatter_of_planes_fitted_there() {
    let mut random = Random::stream(131, 0);
    let limits = MergeLimits::default();
    let sigma = 0.01;
    let places: Vec<[f64; 2]> = (0..30).map(|_| [random.normal(), 0.5 * random.normal()]).collect();
    let at = Point3::new(1.2, -0.7, 0.0);
    let eye = Point3::new(0.0, 0.0, 9.0);
    let (mut stated, mut scatter, mut count) = (0.0, 0.0, 0.0);
    for _ in 0..3000 {
        let known = |p: &[f64; 2]| KnownPoint {
            at: Point3::new(p[0], p[1], sigma * random.normal()),
            covariance: crate::geometry::Matrix3::identity() * (sigma * sigma),
        };
        let own: Vec<KnownPoint> = places.iter().map(known).collect();
        let Some(group) = PlaneGroup::of(PlaneOf::A, &own, &[], &eye, &limits) else { continue };
        if group.plane_points < 30 {
            continue;
        }
        // The height of the fitted plane where the truth is zero.
        scatter += group.plane.plane.signed_distance(&at).powi(2);
        stated += group.plane_variance(&at);
        count += 1.0;
    }
    assert!(count > 2000.0, "{count}");
    let ratio = stated / scatter;
    // The foretold variance is in it where the measured one happens to be less: some per cent more.
    assert!((0.9..1.3).contains(&ratio), "{ratio}");
}

#[test]
fn few_points_a_heap_and_a_plane_seen_edge_on_are_none() {
    let mut random = Random::stream(132, 0);
    let limits = MergeLimits::default();
    let mut points = |across: f64, count: usize| -> Vec<KnownPoint> {
        let known =
            |at| KnownPoint { at, covariance: crate::geometry::Matrix3::identity() * (0.5 * across + 1e-3).powi(2) };
        (0..count).map(|_| known(Point3::new(random.normal(), random.normal(), across * random.normal()))).collect()
    };
    let above = Point3::new(0.0, 0.0, 9.0);
    let of = |own: &[KnownPoint], eye: &Point3<f64>| PlaneGroup::of(PlaneOf::B, own, &[], eye, &limits).is_some();
    let flat = points(0.001, 20);
    assert!(of(&flat, &above));
    assert!(!of(&flat[..limits.planes.fewest_points - 1], &above));
    assert!(!of(&flat, &Point3::new(9.0, 0.0, 0.1)), "from the side");
    assert!(!of(&points(1.0, 20), &above), "a heap");
}
