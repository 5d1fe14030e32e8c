use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn axes_are_right_handed_and_orthonormal_for_every_third_axis() {
    for z in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [-1.0, 0.0, 0.0], [0.36, 0.48, 0.8]] {
        let axes = Axes::about(&Vector3::from(z));
        assert!((axes.x.cross(&axes.y) - axes.z).norm() < 1e-15);
        assert!((axes.x.norm() - 1.0).abs() < 1e-15 && axes.x.dot(&axes.y).abs() < 1e-15);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(14), failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn coordinates_and_vectors_are_each_others_inverse(v in prop::array::uniform3(-1.0..1.0f64), w in prop::array::uniform3(-9.0..9.0f64)) {
        let (v, w) = (Vector3::from(v), Vector3::from(w));
        prop_assume!(v.norm() > 1e-3);
        let axes = Axes::about(&v.normalize());
        let [x, y, z] = axes.coordinates(&w);
        prop_assert!((axes.vector(x, y, z) - w).norm() < 1e-13);
        prop_assert!((w.norm_squared() - (x * x + y * y + z * z)).abs() < 1e-11);
        prop_assert!((axes.x.cross(&axes.y) - axes.z).norm() < 1e-14);
    }
}

#[test]
fn along_coordinates_a_wall_has_a_level_and_an_upright_axis_exactly() {
    for step in 1..64 {
        let (s, c) = (f64::from(step) * 0.1).sin_cos();
        let wall = Axes::along_coordinates(&Vector3::new(c, s, 0.0));
        assert_eq!((wall.x.z, wall.y.x, wall.y.y), (0.0, 0.0, 0.0), "{wall:?}");
    }
    for z in [Vector3::new(0.48, -0.6, 0.64), Vector3::z(), -Vector3::x()] {
        let Axes { x, y, .. } = Axes::along_coordinates(&z);
        assert!((x.cross(&y) - z).norm() < 1e-15 && x.dot(&y).abs() < 1e-15 && (x.norm() - 1.0).abs() < 1e-15);
    }
}
