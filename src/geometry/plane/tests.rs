use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn distance_is_positive_on_the_side_of_the_normal() {
    let plane = Plane::through(&Point3::new(0.0, 0.0, 2.0), &Vector3::new(0.0, 0.0, 5.0)).unwrap();
    assert_eq!(plane.signed_distance(&Point3::new(7.0, -3.0, 3.5)), 1.5);
    assert_eq!(plane.flipped().signed_distance(&Point3::new(7.0, -3.0, 3.5)), -1.5);
}

#[test]
fn refuses_a_normal_without_direction() {
    assert!(Plane::through(&Point3::origin(), &Vector3::zeros()).is_none());
    assert!(Plane::through(&Point3::origin(), &Vector3::new(f64::NAN, 0.0, 1.0)).is_none());
}

fn numbers() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-9.0..9.0f64).prop_map(Vector3::from)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(12), failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn the_foot_of_a_point_is_on_the_plane_and_nearest_to_it(on in numbers(), normal in numbers(), x in numbers(), aside in numbers()) {
        prop_assume!(normal.norm() > 0.1);
        let plane = Plane::through(&Point3::from(on), &normal).unwrap();
        let foot = plane.project(&Point3::from(x));
        prop_assert!(plane.signed_distance(&foot).abs() < 1e-12);
        prop_assert!(((x - foot.coords).norm() - plane.signed_distance(&Point3::from(x)).abs()).abs() < 1e-12);
        let other = plane.project(&Point3::from(foot.coords + aside));
        prop_assert!((x - other.coords).norm() > (x - foot.coords).norm() - 1e-12);
    }

    #[test]
    fn the_derivative_is_that_of_the_motion(y in numbers(), normal in numbers(), omega in numbers(), tau in numbers(), sigma in -1.0..1.0f64) {
        prop_assume!(normal.norm() > 0.1);
        let n = normal.normalize();
        let moved = y + omega.cross(&y) + tau + sigma * y;
        let unknowns = [omega.x, omega.y, omega.z, tau.x, tau.y, tau.z, sigma];
        let predicted: f64 = distance_derivative(&y, &n).iter().zip(unknowns).map(|(d, u)| d * u).sum();
        prop_assert!((predicted - n.dot(&(moved - y))).abs() < 1e-10);
    }
}
