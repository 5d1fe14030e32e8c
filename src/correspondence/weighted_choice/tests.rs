use super::*;

#[test]
fn offers_are_taken_in_proportion_to_their_weights() {
    let weights = [1.0, 0.0, 5.0, 2.0, 2.0];
    let mut counts = [0usize; 5];
    let mut random = Random::stream(63, 0);
    for _ in 0..20_000 {
        let mut choice = Choice::default();
        weights.iter().enumerate().for_each(|(what, weight)| choice.offer(*weight, what, &mut random));
        let drawn = choice.drawn().unwrap();
        assert!((drawn.chance - 34.0 / 100.0).abs() < 1e-12, "the sum of squared shares");
        counts[drawn.what] += 1;
    }
    for (count, weight) in counts.iter().zip(weights) {
        let expected = 20_000.0 * weight / 10.0;
        assert!((*count as f64 - expected).abs() <= 5.0 * expected.sqrt(), "{counts:?}");
    }
}

#[test]
fn nothing_offered_is_nothing_drawn_and_one_offer_is_certain() {
    assert!(Choice::<u8>::default().drawn().is_none());
    let mut choice = Choice::default();
    choice.offer(1e-300, 'a', &mut Random::stream(64, 0));
    let drawn = choice.drawn();
    assert!(drawn.is_some_and(|drawn| drawn.what == 'a'));
}
