use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn the_ends_of_an_interval_are_its_outer_coefficients() {
    let c = [0.3, -1.0, 2.0, 0.5, -0.7, 1.1, -2.0, 0.4, 0.9];
    let at = |t: f64| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let (left, right) = halves(&Interval::whole(&c));
    for (coefficient, t) in
        [(left.bernstein[0], -1.0), (left.bernstein[8], 0.0), (right.bernstein[0], 0.0), (right.bernstein[8], 1.0)]
    {
        assert!((coefficient - at(t)).abs() < 1e-14);
    }
}

fn at(c: &[f64; 9], t: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// The polynomial in Bernstein form at a share of the interval.
fn in_bernstein_form(b: &[f64; 9], share: f64) -> f64 {
    let binomial = [1.0, 8.0, 28.0, 56.0, 70.0, 56.0, 28.0, 8.0, 1.0];
    (0..9).map(|j| binomial[j] * share.powi(j as i32) * (1.0 - share).powi(8 - j as i32) * b[j]).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(21), failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn an_interval_and_its_halves_have_the_polynomials_values(c in prop::array::uniform9(-3.0..3.0f64), share in 0.0..=1.0f64) {
        let whole = Interval::whole(&c);
        let (left, right) = halves(&whole);
        let (_, quarter) = halves(&left);
        for interval in [whole, left, right, quarter] {
            let t = interval.at + share * interval.width;
            prop_assert!((in_bernstein_form(&interval.bernstein, share) - at(&c, t)).abs() < 1e-10);
            let mirrored = interval.mirrored();
            prop_assert!((in_bernstein_form(&mirrored.bernstein, 1.0 - share) - at(&c, t)).abs() < 1e-10);
        }
    }

    #[test]
    fn there_are_no_more_roots_in_an_interval_than_sign_changes_and_an_even_number_fewer(roots in prop::collection::vec(-2.0..2.0f64, 8)) {
        let mut c = [0.0; 9];
        c[0] = 1.0;
        for root in &roots {
            for i in (0..9).rev() {
                c[i] = -root * c[i] + if i > 0 { c[i - 1] } else { 0.0 };
            }
        }
        // Roots that two others or an end nearly meet are counted as rounding has it.
        prop_assume!(roots.iter().all(|r| (r.abs() - 1.0).abs() > 1e-2));
        let inside = roots.iter().filter(|r| r.abs() < 1.0).count() as u32;
        let changes = sign_changes(&Interval::whole(&c).bernstein);
        prop_assert!(changes >= inside && (changes - inside).is_multiple_of(2), "{changes} {inside}");
    }
}

#[test]
fn zeros_among_the_coefficients_change_no_sign() {
    assert_eq!(sign_changes(&[0.0; 9]), 0);
    assert_eq!(sign_changes(&[1.0, 0.0, 0.0, -1.0, 0.0, -2.0, 0.0, 3.0, 0.0]), 2);
    assert_eq!(sign_changes(&[1e-300, -1e-300, 1e-300, 0.0, 0.0, 0.0, 0.0, 0.0, -1e-300]), 3);
}
