use super::*;
use nalgebra::{Complex, SMatrix};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Coefficients of the product of (w_i x - x_i w) over the given roots, times (x^2 + k^2 w^2) up to degree 8.
fn with_roots(roots: &[[f64; 2]], k: f64) -> [f64; 9] {
    let mut c = [0.0; 9];
    c[0] = 1.0;
    let mut times = |low: f64, middle: f64, high: f64| {
        let old = c;
        for i in 0..9 {
            c[i] = low * old[i]
                + middle * if i > 0 { old[i - 1] } else { 0.0 }
                + high * if i > 1 { old[i - 2] } else { 0.0 };
        }
    };
    for r in roots {
        times(-r[0], r[1], 0.0);
    }
    for _ in 0..(8 - roots.len()) / 2 {
        times(k * k, 0.0, 1.0);
    }
    c
}

fn angle(r: &[f64; 2]) -> f64 {
    r[0].atan2(r[1]).rem_euclid(std::f64::consts::PI)
}

#[test]
fn finds_every_root_of_octics_with_known_roots() {
    let mut random = crate::solvers::scene::Random::stream(7, 0);
    let mut uniform = || random.unit();
    for case in 0..20_000 {
        let number = [0, 2, 4, 6, 8][case % 5];
        let known: Vec<[f64; 2]> = (0..number).map(|_| (std::f64::consts::PI * uniform()).sin_cos().into()).collect();
        let mut gap = 1.0f64;
        for i in 0..number {
            for j in 0..i {
                gap = gap.min((known[i][0] * known[j][1] - known[i][1] * known[j][0]).abs());
            }
        }
        if gap < 1e-3 {
            continue;
        }
        let found = real_roots(&with_roots(&known, 0.5 + uniform()));
        assert_eq!(found.len(), number, "case {case}: {known:?}");
        for k in &known {
            let miss = found.iter().map(|f| (angle(f) - angle(k)).abs()).fold(9.0, f64::min);
            assert!(miss < 1e-7 || (miss - std::f64::consts::PI).abs() < 1e-7, "case {case}: {miss}");
        }
    }
}

#[test]
fn finds_roots_at_zero_at_infinity_and_on_the_border_of_the_charts() {
    let known = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
    let found = real_roots(&with_roots(&known, 1.0));
    assert_eq!(found.len(), 4, "{found:?}");
}

#[test]
fn a_double_root_is_handed_up() {
    for k in 0..1000 {
        let double = [-0.9995 + 0.002 * f64::from(k), 1.0];
        let known = [double, double, [-2.0, 1.0], [0.9, 0.3]];
        let found = real_roots(&with_roots(&known, 1.0));
        assert!(found.iter().any(|r| (r[0] - double[0] * r[1]).abs() < 1e-5), "{double:?}: {found:?}");
    }
}

#[test]
fn a_double_root_on_the_border_of_the_charts_is_handed_up_twice() {
    for double in [[1.0, 1.0], [-1.0, 1.0], [0.0, 1.0]] {
        for off in [0.0, 3e-17, -3e-17] {
            let mut octic = with_roots(&[double, double], 1.0);
            octic[0] += off;
            let found = real_roots(&octic);
            let near = found.iter().filter(|r| (r[0] - double[0] * r[1]).abs() < 1e-5).count();
            assert!(near >= 2, "{double:?} {off}: {found:?}");
        }
    }
}

#[test]
fn noise_and_nan_end_without_roots_beyond_the_limit() {
    assert!(real_roots(&[f64::NAN; 9]).is_empty());
    assert!(real_roots(&[0.0; 9]).len() <= MOST_ROOTS);
}

/// Roots of `c[0] + c[1] t + .. + c[8] t^8` over the complex numbers: eigenvalues of the companion matrix.
fn by_companion_matrix(c: &[f64; 9]) -> Vec<Complex<f64>> {
    let companion = SMatrix::<f64, 8, 8>::from_fn(|i, j| match (i, j) {
        (i, 7) => -c[i] / c[8],
        (i, j) if i == j + 1 => 1.0,
        _ => 0.0,
    });
    companion.complex_eigenvalues().iter().copied().collect()
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn the_real_roots_are_the_real_eigenvalues_of_the_companion_matrix(c in prop::array::uniform9(-1.0..1.0f64)) {
        prop_assume!(c[8].abs() > 0.05);
        let all = by_companion_matrix(&c);
        // A root that is nearly double is real or complex as rounding will have it.
        let clear = |k: usize| {
            let apart = (0..8).filter(|&i| i != k).all(|i| (all[i] - all[k]).norm() > 1e-3 * (1.0 + all[k].norm()));
            apart && (all[k].im.abs() < 1e-9 || all[k].im.abs() > 1e-4)
        };
        prop_assume!((0..8).all(clear));
        let real: Vec<f64> = all.iter().filter(|root| root.im.abs() < 1e-9).map(|root| root.re).collect();
        let found = real_roots(&c);
        prop_assert_eq!(found.len(), real.len());
        for root in real {
            let miss = found.iter().map(|&[x, w]| (x - root * w).abs() / root.hypot(1.0)).fold(f64::INFINITY, f64::min);
            prop_assert!(miss < 1e-6, "{} is missed by {}", root, miss);
        }
    }
}
