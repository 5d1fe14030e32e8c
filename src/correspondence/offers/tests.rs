use super::*;

/// Offers with these likelihoods.
fn offers(likelihoods: &[f64]) -> Offers {
    let mut offers = Offers::default();
    likelihoods.iter().zip(0..).for_each(|(likelihood, plane)| offers.add(*likelihood, (PlaneId(plane), false)));
    offers.finish()
}

#[test]
fn the_chance_of_the_right_offer_is_the_sum_of_squared_shares() {
    assert!((offers(&[2.0, 2.0]).chance - 0.5).abs() < 1e-15);
    assert!((offers(&[3.0, 1.0]).chance - 10.0 / 16.0).abs() < 1e-15);
    assert!((offers(&[7.0]).chance - 1.0).abs() < 1e-15);
    assert_eq!(offers(&[1.0, 2.0, 4.0]).sums, [1.0, 3.0, 7.0]);
}

#[test]
fn offers_are_found_once_while_there_is_room_and_each_time_when_there_is_none() {
    let first = FirstOffers::of(3);
    let found = std::cell::Cell::new(0);
    let ask = |patch: usize| {
        let find = || {
            found.set(found.get() + 1);
            offers(&[1.0, patch as f64])
        };
        first.with(patch, find, |offers| offers.sums[1])
    };
    assert_eq!([ask(1), ask(1), ask(2)], [2.0, 2.0, 3.0]);
    assert_eq!(found.get(), 2);
    first.keep_no_more();
    assert_eq!([ask(1), ask(0), ask(0)], [2.0, 1.0, 1.0]);
    assert_eq!(found.get(), 4, "what was kept stays");
}
