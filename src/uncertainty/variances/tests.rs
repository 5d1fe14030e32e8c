use super::*;

#[test]
fn a_mean_of_squares_begins_with_what_is_known() {
    let first = Squares { sum: 2.0 * 0.09, count: 2.0, each: 3.0 };
    assert!((first.mean() - 0.09).abs() < 1e-15);
    let mut squares = first;
    squares.add(0.3);
    assert!((squares.mean() - (0.18 + 0.3) / 5.0).abs() < 1e-15);
    (0..100_000).for_each(|_| squares.add(3.0 * 0.25));
    assert!((squares.mean() - 0.25).abs() < 1e-4, "what is known beforehand is forgotten");
}

#[test]
fn weights_are_those_of_a_scale_mixture() {
    // The posterior mean of the precision: gamma with shape nu / 2 and rate nu / 2, updated by one square.
    let (dof, steps) = (3.0f64, 200_000);
    for (squared, parts) in [(0.0, 1), (1.0, 1), (9.0, 1), (2.0, 4)] {
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in 1..steps {
            let precision = 40.0 * f64::from(k) / f64::from(steps);
            let log = (0.5 * dof - 1.0 + 0.5 * parts as f64) * precision.ln() - 0.5 * precision * (dof + squared);
            (sum, weights) = (sum + precision * log.exp(), weights + log.exp());
        }
        assert!((weight(squared, parts, dof) - sum / weights).abs() < 1e-3, "{squared} {parts}");
    }
}
