use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn distortion() -> impl Strategy<Value = Distortion> {
    let few = |most: f64| -most..most;
    (
        prop::array::uniform6(few(0.01)),
        prop::array::uniform3(few(0.01)),
        prop::array::uniform2(few(0.005)),
        prop::array::uniform4(few(0.005)),
        prop::bool::ANY,
    )
        .prop_map(|(numerator, denominator, tangential, prism, shifts_after_radial)| Distortion {
            numerator,
            denominator,
            tangential,
            prism,
            shifts_after_radial,
        })
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(15), failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn the_derivative_is_that_of_small_steps(d in distortion(), p in prop::array::uniform2(-0.5..0.5f64)) {
        let p = Vector2::from(p);
        let (_, derivative) = d.apply(p).unwrap();
        let step = 1e-6;
        for k in 0..2 {
            let mut aside = Vector2::zeros();
            aside[k] = step;
            let slope = (d.apply(p + aside).unwrap().0 - d.apply(p - aside).unwrap().0) / (2.0 * step);
            prop_assert!((slope - derivative.column(k)).norm() < 1e-7, "{slope} {derivative}");
        }
    }

    #[test]
    fn inversion_finds_the_point_that_was_distorted(d in distortion(), p in prop::array::uniform2(-0.5..0.5f64)) {
        let p = Vector2::from(p);
        let (q, _) = d.apply(p).unwrap();
        let found = d.invert(q).unwrap();
        prop_assert!((found - p).norm() < 1e-9, "{found} {p}");
    }
}

#[test]
fn no_distortion_moves_nothing_and_the_centre_stays() {
    let p = Vector2::new(0.3, -0.7);
    assert_eq!(Distortion::default().apply(p).unwrap(), (p, Matrix2::identity()));
    let strong = Distortion { tangential: [0.1, -0.2], prism: [0.1; 4], ..Distortion::radial(&[0.3, -0.1]) };
    assert_eq!(strong.apply(Vector2::zeros()).unwrap().0, Vector2::zeros());
}

#[test]
fn beyond_the_fold_nothing_is_seen() {
    // r (1 - 0.5 r^2) turns back at r^2 = 2/3.
    let folding = Distortion::radial(&[-0.5]);
    let fold = (2.0f64 / 3.0).sqrt();
    assert!(folding.apply(Vector2::new(0.99 * fold, 0.0)).is_some());
    assert!(folding.apply(Vector2::new(1.01 * fold, 0.0)).is_none());
    let farthest = fold * (1.0 - 0.5 * fold * fold);
    assert!(folding.invert(Vector2::new(1.01 * farthest, 0.0)).is_none());
    assert!(folding.invert(Vector2::new(0.0, 0.9 * farthest)).is_some());
}
