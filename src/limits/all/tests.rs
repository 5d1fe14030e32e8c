use super::*;

#[test]
fn gates_narrow_from_step_to_step_and_begin_no_wider_than_the_search() {
    let limits = Limits::default();
    let narrows = |gates: &[f64]| gates.windows(2).all(|two| two[1] <= two[0]) && gates.iter().all(|g| *g > 0.0);
    assert!(narrows(limits.search.local_optimization_gates_units));
    assert!(narrows(limits.null_poses.gates_units) && narrows(limits.verdict.scale_gates_units));
    assert!(narrows(&limits.line_search.basin_gates_units));
    for stage in &limits.refinement.stages {
        assert!(narrows(stage.gates_units) && stage.gates_units[0] <= limits.search.gate_units);
        assert!(stage.ranking_gate_units <= stage.gates_units[0]);
    }
    assert!(limits.search.fewest_samples <= limits.search.most_samples);
}

#[test]
fn stages_have_more_sample_points_and_no_more_poses_than_those_before() {
    for two in Limits::default().refinement.stages.windows(2) {
        assert!(two[1].sample_points >= two[0].sample_points && two[1].keep <= two[0].keep);
        assert!(two[1].gates_units[0] <= two[0].gates_units[0]);
    }
}

#[test]
fn what_is_asked_of_a_freedom_grows_with_the_scene() {
    let limits = Limits::default().verdict;
    assert_eq!(limits.accuracy_m(1.0), limits.default_accuracy_m);
    let large = 10.0 * limits.default_accuracy_m / limits.default_accuracy_share;
    assert!((limits.accuracy_m(large) - limits.default_accuracy_share * large).abs() < 1e-9);
    // Ten bits for one in a thousand.
    assert!((limits.margin_bits() - 1000f64.log2()).abs() < 1e-9, "{}", limits.margin_bits());
}
