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

/// Height of the highest triangle over a place, by barycentric coordinates seen from above.
fn naive_height(triangles: &[[Point3<f64>; 3]], x: f64, y: f64) -> Option<f64> {
    let over = |[a, b, c]: &[Point3<f64>; 3]| {
        let area =
            |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let [a2, b2, c2] = [a, b, c].map(|p| [p.x, p.y]);
        let whole = area(a2, b2, c2);
        let shares = [area([x, y], b2, c2), area(a2, [x, y], c2), area(a2, b2, [x, y])].map(|part| part / whole);
        let inside = shares.iter().all(|share| *share >= 0.0);
        inside.then(|| shares[0] * a.z + shares[1] * b.z + shares[2] * c.z)
    };
    triangles.iter().filter_map(over).reduce(f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(16), failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn a_ray_from_above_ends_at_the_height_of_the_highest_triangle(
        triangles in prop::collection::vec(prop::array::uniform3(point()), 1..30),
        x in -5.0..5.0f64,
        y in -5.0..5.0f64,
    ) {
        let rays = RayCaster::new(triangles.iter().copied());
        let hit = rays.first_hit(&Point3::new(x, y, 9.0), &-Vector3::z(), f64::INFINITY).map(|hit| 9.0 - hit.distance);
        match (hit, naive_height(&triangles, x, y)) {
            (Some(found), Some(expected)) => prop_assert!((found - expected).abs() < 1e-6, "{} {}", found, expected),
            (found, expected) => prop_assert_eq!(found, expected),
        }
    }

    #[test]
    fn what_is_not_counted_is_as_if_it_were_not_there(
        triangles in prop::collection::vec(prop::array::uniform3(point()), 1..30),
        from in point(),
        towards in point(),
    ) {
        let direction = (towards - from).normalize();
        let rays = RayCaster::new(triangles.iter().copied());
        let even: Vec<_> = triangles.iter().copied().step_by(2).collect();
        let some = rays.first_hit_of(|triangle| triangle % 2 == 0, &from, &direction, 20.0);
        let alone = RayCaster::new(even.into_iter()).first_hit(&from, &direction, 20.0);
        prop_assert_eq!(some.map(|hit| (hit.distance, hit.triangle / 2)), alone.map(|hit| (hit.distance, hit.triangle)));
    }
}
