use super::super::test_scene::{RADIUS, scene, truth};
use super::*;
use crate::geometry::Matrix3;

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
