use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn takes_the_nearest_rank() {
    assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), Some(3.0));
    assert_eq!(quantile(&mut [5.0, 4.0, 3.0, 2.0, 1.0], 0.8), Some(4.0));
    assert_eq!(median(&mut []), None);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(17), failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn a_quantile_is_the_entry_of_the_sorted_list(values in prop::collection::vec(-9.0..9.0f64, 1..60), share in 0.0..=1.0f64) {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let rank = (share * (sorted.len() - 1) as f64).round() as usize;
        prop_assert_eq!(quantile(&mut values.clone(), share), Some(sorted[rank]));
    }
}
