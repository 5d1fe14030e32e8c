use super::*;
use crate::solvers::scene::Random;
use crate::synthetic::sfm_from_city;
use crate::verdict::{Certainty, Freedom, FreedomKind, FreedomUnit, ModelErrors, SearchSummary, Support};

const RADIUS: f64 = 20.0;

/// An alignment at the truth moved by so much, stating these sigmas (lengths at the radius, axes of the chart).
fn alignment(motion: &Vector7, sigmas: &[f64; 7], determined: usize) -> (Alignment, Similarity, Vec<Point3<f64>>) {
    let truth = sfm_from_city().inverse();
    let center = Point3::new(10.0, -5.0, 4.0);
    let turn = Rotation3::new(Vector3::new(motion[0], motion[1], motion[2]) / RADIUS);
    let shift = Vector3::new(motion[3], motion[4], motion[5]);
    let off = Similarity::about(&center, &(center + shift), (motion[6] / RADIUS).exp(), turn);
    let lengths = [RADIUS, RADIUS, RADIUS, 1.0, 1.0, 1.0, RADIUS];
    let mut covariance = [[0.0; 7]; 7];
    for k in 0..7 {
        covariance[k][k] = (sigmas[k] / lengths[k]).powi(2);
    }
    let freedom = |k: usize| Freedom {
        name: String::new(),
        direction: Vector3::zeros(),
        sigma: sigmas[k],
        kind: FreedomKind::Shift,
        unit: FreedomUnit::Metre,
        determined: k < determined,
        given: false,
    };
    let mut random = Random::stream(3, 0);
    let points = (0..200)
        .map(|_| truth.inverse().apply(&(center + 0.3 * random.in_cube().component_mul(&Vector3::new(1.0, 1.0, 0.2)))))
        .collect();
    let alignment = Alignment {
        verdict: Verdict::Aligned,
        reason: String::new(),
        best_candidate: Some(off * truth),
        alternatives: Vec::new(),
        certainty: Certainty::default(),
        origin: Vector3::zeros(),
        center: off.apply(&center),
        radius: RADIUS,
        accuracy_m: 0.35,
        model_errors: ModelErrors::default(),
        freedoms: (0..7).map(freedom).collect(),
        covariance,
        support: Support::default(),
        evidence: Vec::new(),
        search: SearchSummary::default(),
        warnings: Vec::new(),
    };
    (alignment, truth, points)
}

#[test]
fn errors_as_stated_lie_in_the_band_and_their_chi_square_has_its_median() {
    let sigmas = [0.02, 0.03, 0.05, 0.04, 0.06, 0.08, 0.03];
    let mut random = Random::stream(8, 0);
    let mut normalised = Vec::new();
    let mut inside = 0;
    for _ in 0..400 {
        let motion = Vector7::from_fn(|k, _| sigmas[k] * random.normal());
        let (found, truth, points) = alignment(&motion, &sigmas, 7);
        let assessed = Assessment::new(&found, Some(&truth), &points);
        inside += usize::from(assessed.band().is_eq());
        normalised.push(assessed.normalised());
    }
    normalised.sort_by(f64::total_cmp);
    assert!((370..=392).contains(&inside), "{inside} of 400");
    assert!((normalised[200] - 1.0).abs() < 0.1, "{}", normalised[200]);
}

#[test]
fn turns_are_measured_whatever_their_size() {
    for angle in [0.0, 1e-9, 1e-3, 1.0, 3.0, std::f64::consts::PI] {
        let vector = Vector3::new(0.0, 0.0, angle);
        let found = rotation_vector(&Rotation3::new(vector));
        assert!((found.norm() - angle).abs() < 1e-12, "{angle} {found}");
    }
}

#[test]
fn an_error_along_what_is_open_is_none() {
    let sigmas = [0.02, 0.02, 0.02, 0.02, 0.02, 3.0, 0.02];
    let motion = Vector7::from_column_slice(&[0.0, 0.0, 0.0, 0.0, 0.01, 2.5, 0.0]);
    let (mut found, truth, points) = alignment(&motion, &sigmas, 6);
    found.verdict = Verdict::Undetermined;
    let assessed = Assessment::new(&found, Some(&truth), &points);
    assert_eq!((assessed.held, assessed.outcome()), (6, Outcome::UndeterminedRight));
    assert!((assessed.error_m - 2.5).abs() < 0.01 && (assessed.held_error_m - 0.01).abs() < 1e-3, "{assessed:?}");
    let motion = Vector7::from_column_slice(&[0.0, 0.0, 0.0, 0.0, 0.9, 0.0, 0.0]);
    let (mut found, truth, points) = alignment(&motion, &sigmas, 6);
    found.verdict = Verdict::Undetermined;
    assert_eq!(Assessment::new(&found, Some(&truth), &points).outcome(), Outcome::UndeterminedWrong);
}

#[test]
fn wrong_is_beyond_half_a_metre_and_three_sigmas_and_gross_beyond_two_metres() {
    let shifted = |by: f64, sigma: f64| {
        let motion = Vector7::from_column_slice(&[0.0, 0.0, 0.0, by, 0.0, 0.0, 0.0]);
        let (found, truth, points) = alignment(&motion, &[0.01, 0.01, 0.01, sigma, 0.01, 0.01, 0.01], 7);
        Assessment::new(&found, Some(&truth), &points).outcome()
    };
    assert_eq!(shifted(0.45, 0.01), Outcome::AlignedRight);
    assert_eq!(shifted(0.6, 0.01), Outcome::AlignedWrong);
    assert_eq!(shifted(0.6, 0.25), Outcome::AlignedRight);
    assert_eq!(shifted(5.0, 0.25), Outcome::AlignedGross);
}

#[test]
fn without_a_truth_whatever_is_called_aligned_is_gross() {
    let (found, _, points) = alignment(&Vector7::zeros(), &[0.01; 7], 7);
    assert_eq!(Assessment::new(&found, None, &points).outcome(), Outcome::AlignedGross);
}
