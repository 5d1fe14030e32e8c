use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn quadrics() -> impl Strategy<Value = [Quadric; 3]> {
    prop::array::uniform3(prop::array::uniform10(-1.0..1.0f64))
}

/// The same quadrics, each with a multiple of |q|^2 that makes it vanish at a unit quaternion.
fn through(quadrics: &[Quadric; 3], q: &Quaternion) -> [Quadric; 3] {
    quadrics.map(|quadric| {
        let off = value(&quadric, q);
        std::array::from_fn(|j| if j < 4 { quadric[j] - off } else { quadric[j] })
    })
}

/// How clearly the quadrics cross at q: the volume of their slopes along the sphere.
fn crossing(quadrics: &[Quadric; 3], q: &Quaternion) -> f64 {
    let tangents = tangents(q);
    let [a, b, c] = quadrics.map(|quadric| {
        let half = half_gradient(&quadric, q);
        Vector3::from(tangents.map(|t| (0..4).map(|i| half[i] * t[i]).sum::<f64>()))
    });
    a.cross(&b).dot(&c).abs()
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(2), failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn a_planted_point_is_found_and_all_points_satisfy_the_equations(
        random in quadrics(),
        planted in prop::array::uniform4(-1.0..1.0f64),
    ) {
        let Some(planted) = unit(planted) else { return Ok(()) };
        let quadrics = through(&random, &planted);
        prop_assume!(crossing(&quadrics, &planted) > 1e-4);
        for charts in [Charts::AsNeeded, Charts::All] {
            let found = three_quadrics(&quadrics, charts);
            let miss_sq = found.iter().map(|q| InChart::distance_sq(q, &planted)).fold(f64::INFINITY, f64::min);
            prop_assert!(miss_sq < 1e-16, "{:?}: missed by {}", charts, miss_sq.sqrt());
            prop_assert!(found.iter().all(|q| quadrics.iter().all(|quadric| value(quadric, q).abs() < 1e-9)));
        }
    }

    #[test]
    fn one_chart_finds_what_all_charts_find(quadrics in quadrics()) {
        let (few, all) = (three_quadrics(&quadrics, Charts::AsNeeded), three_quadrics(&quadrics, Charts::All));
        prop_assume!(all.iter().all(|q| crossing(&quadrics, q) > 1e-4));
        prop_assert_eq!(few.len(), all.len());
    }
}

#[test]
fn quadrics_that_depend_on_each_other_have_no_points() {
    let (a, b) =
        ([1.0, -1.0, 0.5, 0.0, 0.3, 0.2, 0.0, 0.0, 1.0, 0.0], [0.2, 0.1, -1.0, 0.4, 0.0, 0.0, 1.0, 0.0, 0.3, 0.0]);
    let sum = std::array::from_fn(|j| a[j] + b[j]);
    assert!(three_quadrics(&[a, b, sum], Charts::All).is_empty());
}
