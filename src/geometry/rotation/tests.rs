use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn a_rotation_with_rounding_becomes_the_same_by_both_ways() {
    let exact = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let rough = exact.matrix() + Matrix3::new(1.0, -2.0, 0.5, 0.3, 1.0, -0.7, 2.0, 0.1, -1.0) * 1e-7;
    let (by_newton, by_svd) = (orthonormalised(&rough), nearest_rotation(&rough).unwrap());
    assert!((by_newton.matrix() - by_svd.matrix()).norm() < 1e-14);
    assert!((by_newton.matrix() * by_newton.matrix().transpose() - Matrix3::identity()).norm() < 1e-15);
    assert!((by_newton.matrix() - exact.matrix()).norm() < 1e-6);
}

#[test]
fn a_reflection_becomes_a_rotation() {
    let rotation = nearest_rotation(&Matrix3::from_diagonal(&nalgebra::Vector3::new(3.0, 2.0, -1.0))).unwrap();
    assert!((rotation.matrix() - Matrix3::identity()).norm() < 1e-15);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(13), failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn no_rotation_is_nearer_than_the_nearest(entries in prop::array::uniform9(-2.0..2.0f64), turns in prop::array::uniform3(-3.0..3.0f64)) {
        let matrix = Matrix3::from_row_slice(&entries);
        let nearest = nearest_rotation(&matrix).unwrap();
        let m = nearest.matrix();
        prop_assert!((m * m.transpose() - Matrix3::identity()).norm() < 1e-12 && m.determinant() > 0.0);
        // Rotations far off and close by.
        for share in [1.0, 0.1, 0.01] {
            let other = nearest * Rotation3::new(nalgebra::Vector3::from(turns) * share);
            prop_assert!((other.matrix() - matrix).norm() >= (m - matrix).norm() - 1e-12);
        }
    }
}
