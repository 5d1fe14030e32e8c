use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn each_dual_vector_sees_its_own_vector_only() {
    let basis = [Vector3::new(0.6, 0.0, 0.8), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.36, 0.48, -0.8)];
    let dual = dual_basis(&basis, volume(&basis));
    for i in 0..3 {
        for k in 0..3 {
            assert!((basis[i].dot(&dual[k]) - f64::from(u8::from(i == k))).abs() < 1e-15);
        }
    }
    assert!(volume(&[basis[0], basis[1], basis[0] + basis[1]]).abs() < 1e-15);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(24), failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn the_dual_basis_solves_three_planes(
        basis in prop::array::uniform3(prop::array::uniform3(-2.0..2.0f64)),
        x in prop::array::uniform3(-5.0..5.0f64),
    ) {
        let (basis, x) = (basis.map(Vector3::from), Vector3::from(x));
        let spanned = volume(&basis);
        prop_assume!(spanned.abs() > 0.05);
        let matrix = nalgebra::Matrix3::from_rows(&basis.map(|v| v.transpose()));
        prop_assert!((spanned - matrix.determinant()).abs() < 1e-12);
        let dual = dual_basis(&basis, spanned);
        let found: Vector3<f64> = (0..3).map(|k| dual[k] * basis[k].dot(&x)).sum();
        prop_assert!((found - x).norm() < 1e-9);
    }
}
