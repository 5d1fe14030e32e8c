use super::*;
use crate::merging::limits::MergeLimits;
use crate::random::Random;
use crate::robust::{Matrix7, MotionParameters, Vector7};

fn own(sigma: f64) -> Fit {
    Fit {
        a_from_b: Similarity { scale: 1.4, ..Similarity::identity() },
        parameters: MotionParameters::of_similarity(crate::geometry::Point3::new(1.0, 2.0, 3.0), 10.0),
        information: Matrix7::identity() / (sigma * sigma),
        bend: 0.0,
        inliers: Vec::new(),
        rms: 0.0,
    }
}

#[test]
fn a_difference_is_told_in_sigmas_and_as_a_share_of_the_radius() {
    let (own, mut random) = (own(0.02), Random::stream(113, 0));
    for _ in 0..30 {
        let unknowns = Vector7::from_fn(|_, _| 0.05 * random.normal());
        let found = difference(&own, &own.parameters.moved(&own.a_from_b, &unknowns));
        assert!((found.sigmas - unknowns.norm() / 0.02).abs() < 1e-6 * found.sigmas);
        assert!((found.share - unknowns.norm() / 10.0).abs() < 1e-9);
        // With so much greater a variance the difference would be what chance gives: one sigma in each unknown.
        let at_ease = found.sigmas / found.birge().sqrt();
        assert!(at_ease <= 7f64.sqrt() + 1e-9);
    }
}

#[test]
fn only_what_is_beyond_chance_and_matters_is_a_disagreement() {
    let limits = MergeLimits::default();
    let apart = |sigma: f64, off: f64| {
        let own = own(sigma);
        let mut unknowns = Vector7::zeros();
        unknowns[4] = off;
        difference(&own, &own.parameters.moved(&own.a_from_b, &unknowns))
    };
    assert!(apart(0.02, 0.2).is_disagreement(&limits));
    assert!(!apart(0.2, 0.2).is_disagreement(&limits), "one sigma");
    assert!(!apart(1e-4, 0.02).is_disagreement(&limits), "two hundred sigmas of two in a thousand");
    assert_eq!(apart(0.02, 0.2).told(), "1.00 % of the extent (10.0 sigmas)");
}
