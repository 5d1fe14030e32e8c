use super::*;

fn wall(x: f64) -> [Point3<f64>; 3] {
    [Point3::new(x, -1.0, -1.0), Point3::new(x, 3.0, -1.0), Point3::new(x, -1.0, 3.0)]
}

#[test]
fn meets_the_nearest_of_several() {
    let rays = RayCaster::new([wall(5.0), wall(2.0), wall(9.0)].into_iter());
    let hit = rays.first_hit(&Point3::origin(), &Vector3::x(), 100.0).unwrap();
    assert_eq!((hit.triangle, hit.distance), (1, 2.0));
    assert_eq!(rays.first_hit(&Point3::new(2.0, 0.0, 0.0), &Vector3::x(), 100.0).unwrap().triangle, 0);
}

#[test]
fn tells_all_that_a_ray_meets() {
    let rays = RayCaster::new([wall(5.0), wall(2.0), wall(-9.0)].into_iter());
    let hits = |near| {
        let mut count = 0;
        rays.hits(&Point3::origin(), &Vector3::x(), near, |hit| {
            count += usize::from(hit.is_some());
            ControlFlow::Continue(())
        });
        count
    };
    assert_eq!((hits(0.0), hits(3.0), hits(5.0)), (2, 1, 0));
}

#[test]
fn ends_at_its_reach_and_passes_beside() {
    let rays = RayCaster::new([wall(5.0)].into_iter());
    assert_eq!(rays.first_hit(&Point3::origin(), &Vector3::x(), 4.9), None);
    assert_eq!(rays.first_hit(&Point3::origin(), &-Vector3::x(), 100.0), None);
    assert_eq!(rays.first_hit(&Point3::new(0.0, 2.9, 2.9), &Vector3::x(), 100.0), None);
    assert_eq!(RayCaster::new(std::iter::empty()).first_hit(&Point3::origin(), &Vector3::x(), 1.0), None);
}

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn point() -> impl Strategy<Value = Point3<f64>> {
    prop::array::uniform3(-5.0..5.0f64).prop_map(Point3::from)
}

/// Distance to a triangle by its plane and the signs of three volumes.
fn naive([a, b, c]: &[Point3<f64>; 3], from: &Point3<f64>, direction: &Vector3<f64>) -> Option<f64> {
    let normal = (b - a).cross(&(c - a));
    let distance = normal.dot(&(a - from)) / normal.dot(direction);
    let at = from + direction * distance;
    let inside = |p: &Point3<f64>, q: &Point3<f64>| normal.dot(&(q - p).cross(&(at - p))) >= 0.0;
    (distance > 0.0 && inside(a, b) && inside(b, c) && inside(c, a)).then_some(distance)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(4), failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn the_first_hit_is_that_of_asking_every_triangle(
        triangles in prop::collection::vec(prop::array::uniform3(point()), 1..40),
        from in point(),
        to in point(),
    ) {
        let along = to - from;
        prop_assume!(along.norm() > 0.1);
        let direction = along.normalize();
        let rays = RayCaster::new(triangles.iter().copied());
        let nearest = triangles.iter().filter_map(|t| naive(t, &from, &direction)).fold(f64::INFINITY, f64::min);
        let found = rays.first_hit(&from, &direction, 100.0).map_or(f64::INFINITY, |hit| hit.distance);
        prop_assert!(found == nearest || (found - nearest).abs() < 1e-6, "{} {}", found, nearest);
    }
}
