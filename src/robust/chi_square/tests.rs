use super::*;

#[test]
fn gives_the_values_of_the_tables() {
    for (freedoms, tail, expected) in [
        (1, 0.001, 10.828),
        (1, 0.5, 0.4549),
        (2, 0.05, 5.991),
        (3, 0.5, 2.366),
        (3, 0.001, 16.266),
        (7, 0.001, 24.322),
    ] {
        let found = chi_square_beyond(freedoms, tail);
        assert!((found - expected).abs() < 6e-4, "{freedoms} {tail}: {found}");
    }
}

#[test]
fn ends_where_a_tail_is_smaller_than_rounding() {
    assert!(chi_square_beyond(7, 0.0).is_finite());
}

/// The share of squared sums below `sum`, by the trapezium rule over the density.
fn by_integration(freedoms: u32, sum: f64) -> f64 {
    let half = 0.5 * f64::from(freedoms);
    let steps = 200_000;
    // With s = u^2 the density of one and two freedoms has no pole at zero.
    let density = |u: f64| 2.0 * u.powf(2.0 * half - 1.0) * (-0.5 * u * u).exp();
    let width = |end: f64| end / f64::from(steps);
    let integral = |end: f64| {
        let inner: f64 = (1..steps).map(|k| density(f64::from(k) * width(end))).sum();
        (inner + 0.5 * (density(1e-300) + density(end))) * width(end)
    };
    integral(sum.sqrt()) / integral(40.0)
}

#[test]
fn the_share_below_is_the_integral_of_the_density() {
    for freedoms in 1..9 {
        for sum in [0.3, 1.0, 4.0, 11.0, 25.0] {
            let (found, expected) = (share_below(freedoms, sum), by_integration(freedoms, sum));
            assert!((found - expected).abs() < 2e-5, "{freedoms} {sum}: {found} {expected}");
        }
    }
}

#[test]
fn the_bound_is_exceeded_by_the_share_that_was_asked_for_and_rises_with_it() {
    for freedoms in 1..12 {
        let mut before = 0.0;
        for tail in [0.9, 0.5, 0.1, 0.01, 1e-3, 1e-6] {
            let bound = chi_square_beyond(freedoms, tail);
            assert!((1.0 - share_below(freedoms, bound) - tail).abs() < 1e-9);
            assert!(bound > before);
            before = bound;
        }
    }
}
