use super::*;
use crate::merging::limits::MergeLimits;
use crate::random::Random;
use crate::robust::Vector7;

fn pairs(random: &mut Random, pose: &Similarity, noise: f64) -> Vec<PointPair> {
    let spread = |random: &mut Random| {
        let root = Matrix3::from_fn(|_, _| 0.01 * random.normal());
        root * root.transpose() + Matrix3::identity() * 1e-6
    };
    (0..30)
        .map(|_| {
            let in_b = Point3::from(2.0 * random.normal_vector());
            let in_a = pose.apply(&in_b) + noise * random.normal_vector();
            PointPair { in_a, in_b, covariance_a: spread(random), covariance_b: spread(random) }
        })
        .collect()
}

fn pose() -> Similarity {
    let rotation = crate::geometry::Rotation3::from_euler_angles(0.3, -0.4, 1.9);
    Similarity { scale: 1.6, rotation, translation: Vector3::new(1.0, 2.0, -3.0) }
}

#[test]
fn whitening_makes_the_covariance_of_a_residual_the_identity() {
    let mut random = Random::stream(35, 0);
    let limits = MergeLimits::default().fit;
    let pairs = pairs(&mut random, &pose(), 0.01);
    let rows = PointRows::new(&pairs, 4.0, &limits);
    for pair in &pairs {
        let turn = pose().rotation.matrix() * pose().scale;
        let bend = (rows.bend * rows.radius).powi(2);
        let covariance = pair.covariance_a + turn * pair.covariance_b * turn.transpose() + Matrix3::identity() * bend;
        let whitening = rows.whitening(pair, &pose());
        assert!((whitening * covariance * whitening.transpose() - Matrix3::identity()).norm() < 1e-9);
    }
}

#[test]
fn rows_are_the_weighted_derivatives_of_the_whitened_residuals() {
    let mut random = Random::stream(36, 0);
    let limits = MergeLimits::default().fit;
    let pairs = pairs(&mut random, &pose(), 0.02);
    let rows = PointRows::new(&pairs, 4.0, &limits);
    let parameters = rows.parameters(&pose());
    for pair in &pairs {
        let mut sums = NormalEquations::default();
        let weight = rows.add_pair(pair, &pose(), &parameters, &mut sums);
        let whitening = rows.whitening(pair, &pose());
        let residual =
            |unknowns: &Vector7| whitening * (parameters.moved(&pose(), unknowns).apply(&pair.in_b) - pair.in_a);
        let mut jacobian = nalgebra::SMatrix::<f64, 3, 7>::zeros();
        for k in 0..7 {
            let mut step = Vector7::zeros();
            step[k] = 1e-6;
            jacobian.set_column(k, &((residual(&step) - residual(&-step)) / 2e-6));
        }
        let information = jacobian.transpose() * jacobian * weight;
        let gradient = jacobian.transpose() * residual(&Vector7::zeros()) * weight;
        assert!((sums.full() - information).norm() < 1e-5 * (1.0 + information.norm()));
        assert!((sums.gradient - gradient).norm() < 1e-5 * (1.0 + gradient.norm()));
    }
}

#[test]
fn rows_of_single_places_add_up_to_the_rows_of_all() {
    let mut random = Random::stream(37, 0);
    let limits = MergeLimits::default().fit;
    let pairs = pairs(&mut random, &pose(), 0.003);
    let rows = PointRows::new(&pairs, 4.0, &limits);
    let parameters = rows.parameters(&pose());
    let (mut whole, mut sum) = (NormalEquations::default(), NormalEquations::default());
    rows.add_rows(&pose(), &parameters, 1.0, &mut whole);
    rows.placed(&pose(), &parameters).iter().for_each(|placed| sum.merge(&placed.sums, 1.0));
    assert!((whole.full() - sum.full()).norm() < 1e-9 * whole.full().norm());
}

#[test]
fn more_pairs_than_count_as_independent_hold_no_firmer() {
    let mut random = Random::stream(38, 0);
    let limits = FitLimits { independent: 10.0, ..MergeLimits::default().fit };
    let few = pairs(&mut random, &pose(), 0.0);
    let many: Vec<PointPair> = std::iter::repeat_n(few.clone(), 5).flatten().collect();
    let information = |pairs: &[PointPair]| {
        let rows = PointRows::new(pairs, 4.0, &limits);
        let mut sums = NormalEquations::default();
        rows.add_rows(&pose(), &rows.parameters(&pose()), 1.0, &mut sums);
        sums.full()
    };
    assert!((information(&few) - information(&many)).norm() < 1e-9 * information(&few).norm());
}
