use super::*;

#[test]
fn streams_of_other_purposes_and_seeds_are_others() {
    let first = |seed, purpose| stream(seed, purpose).unit();
    assert_eq!(first(1, 2), first(1, 2));
    let mut seen: Vec<f64> = (0..20).flat_map(|seed| (0..20).map(move |purpose| first(seed, purpose))).collect();
    seen.sort_by(f64::total_cmp);
    assert!(seen.windows(2).all(|two| two[0] != two[1]));
}

#[test]
fn numbers_lie_between_their_bounds_and_reach_them() {
    let mut random = stream(1, 0);
    let drawn: Vec<f64> = (0..4000).map(|_| between(&mut random, -3.0, 5.0)).collect();
    assert!(drawn.iter().all(|v| (-3.0..5.0).contains(v)));
    assert!(drawn.iter().any(|v| *v < -2.9) && drawn.iter().any(|v| *v > 4.9));
    let wholes: std::collections::BTreeSet<usize> = (0..400).map(|_| whole(&mut random, 3, 7)).collect();
    assert_eq!(wholes, (3..7).collect());
    // Half of the numbers lie below the geometric mean.
    let below = (0..4000).filter(|_| log_between(&mut random, 1.0, 100.0) < 10.0).count();
    assert!((1850..2150).contains(&below), "{below}");
}

#[test]
fn values_come_with_their_chances_and_the_last_takes_what_is_left() {
    let mut random = stream(2, 0);
    let mut counts = [0; 3];
    (0..10_000).for_each(|_| counts[one_of(&mut random, &[(0, 0.2), (1, 0.5), (2, 0.1)])] += 1);
    for (count, chance) in counts.iter().zip([0.2, 0.5, 0.3]) {
        assert!((f64::from(*count) - 10_000.0 * chance).abs() < 250.0, "{counts:?}");
    }
}

#[test]
fn counts_of_rare_things_have_the_mean_and_the_variance_of_poisson() {
    let mut random = stream(3, 0);
    for mean in [0.3, 2.0, 7.5] {
        let drawn: Vec<f64> = (0..20_000).map(|_| count(&mut random, mean) as f64).collect();
        let found = drawn.iter().sum::<f64>() / 20_000.0;
        let variance = drawn.iter().map(|v| (v - found).powi(2)).sum::<f64>() / 20_000.0;
        assert!(
            (found / mean - 1.0).abs() < 0.05 && (variance / mean - 1.0).abs() < 0.08,
            "{mean}: {found} {variance}"
        );
    }
}
