use super::*;
use crate::correspondence::search::search;
use crate::correspondence::test_scene::Made;
use crate::geometry::{Rotation3, StartSigmas, Vector3};
use crate::planes::Upright;
use crate::robust::Motion;
use crate::synthetic::{Block, CloudOptions, House, Offset};

fn found(scene: &Scene, seed: u64) -> Vec<Candidate> {
    candidates(&PoseRefiner::new(scene), &search(scene, seed, &()).unwrap())
}

fn apart_m(scene: &Scene, a: &Candidate, b: &Candidate) -> f64 {
    largest_shift(&a.refined.city_from_level, &b.refined.city_from_level, scene.level_cloud.radius_m)
}

/// What holds of every list of candidates.
fn check(scene: &Scene, candidates: &[Candidate]) {
    assert!(candidates.len() <= 6);
    assert!(candidates.is_sorted_by(|a, b| a.total_score() >= b.total_score()), "the best first");
    let same_m = scene.limits.refinement.same_pose_units * scene.gate_unit_m;
    for (i, c) in candidates.iter().enumerate() {
        assert!(scene.prior.reaches(&c.refined.city_from_level));
        for other in &candidates[..i] {
            assert!(apart_m(scene, c, other) >= same_m, "one pose twice: {}", apart_m(scene, c, other));
        }
    }
}

#[test]
fn the_best_candidate_is_the_truth_and_leads_the_others() {
    let made = Made::four_houses();
    let start = Offset { shift_m: [6.0, -5.0, 1.5], heading_rad: 0.15, scale: 1.12, ..Offset::default() };
    let scene = made.scene(&start, Motion::Similarity);
    let candidates = found(&scene, 0);
    check(&scene, &candidates);
    let error = made.error(&scene, &candidates[0].refined.city_from_level);
    assert!(error.level_m < 0.02 && error.up_m < 0.02, "{error:?}");
    assert!(candidates[0].share > 0.9 && candidates[0].hits > 0, "{:?}", candidates[0]);
    let again = candidate_at(&PoseRefiner::new(&scene), &candidates[0].refined.city_from_level);
    assert!((again.total_score() - candidates[0].total_score()).abs() < 0.01);
}

/// One box on flat ground, seen all round, its heading unknown.
fn box_alone() -> (Made, StartSigmas) {
    let seen = CloudOptions { points_per_roof: 100, outlier_share: 0.0, ..CloudOptions::default() };
    let block = Block::new(vec![House::flat([14.0, 8.0, 6.0])]).with_ground();
    let any_heading = StartSigmas { heading_rad: std::f64::consts::PI, ..StartSigmas::default() };
    (Made::cloud(block, &seen), any_heading)
}

fn vertical(made: &Made) -> Upright {
    let up = made.survey.city_from_sfm.rotation.inverse() * Vector3::z();
    Upright { up, sigma_rad: 0.0, known: true }
}

#[test]
fn both_halves_of_a_symmetric_building_are_candidates() {
    let (made, any_heading) = box_alone();
    for (motion, heading_rad) in
        [(Motion::Rigid, 0.3), (Motion::Rigid, 2.0), (Motion::Similarity, 1.0), (Motion::Similarity, 3.1)]
    {
        let start = Offset { shift_m: [3.0, -2.0, 1.0], heading_rad, ..Offset::default() };
        let scene = made.scene_with(&start, any_heading, motion, &vertical(&made));
        let candidates = found(&scene, 2);
        check(&scene, &candidates);
        let half_turn = Offset { heading_rad: std::f64::consts::PI, ..Offset::default() };
        for off in [Offset::default(), half_turn] {
            let expected = made.pose(&scene, &off);
            let shift_m =
                |c: &Candidate| largest_shift(&c.refined.city_from_level, &expected, scene.level_cloud.radius_m);
            let nearest_m = candidates.iter().map(shift_m).fold(f64::INFINITY, f64::min);
            assert!(nearest_m < 0.05, "{motion:?} {heading_rad} {off:?}: {nearest_m}");
        }
        // Nothing but the start tells the two apart.
        assert!(candidates[1].total_score() > 0.97 * candidates[0].total_score());
    }
}

#[test]
fn a_given_scale_comes_through_all_stages_to_the_bit() {
    let made = Made::four_houses();
    for seed in 0..3 {
        // Right, and wrong by two per cent either way.
        let scale = 0.98 + 0.02 * seed as f64;
        let start = Offset { shift_m: [4.0, -3.0, 1.0], heading_rad: 0.1, scale, ..Offset::default() };
        let scene = made.scene(&start, Motion::Rigid);
        let candidates = found(&scene, seed);
        check(&scene, &candidates);
        assert!(!candidates.is_empty());
        for c in &candidates {
            assert_eq!(c.refined.city_from_level.scale.to_bits(), 1f64.to_bits(), "{seed}");
        }
    }
}

#[test]
fn candidates_of_two_views_join_without_doubles_and_keep_a_given_scale_to_the_bit() {
    let (made, any_heading) = box_alone();
    for (motion, lean_rad) in [(Motion::Rigid, 0.004), (Motion::Rigid, -0.007), (Motion::Similarity, 0.005)] {
        // A scale that does not come back from being divided out and multiplied in again.
        let comes_back = |scale: f64| scale * scale.recip() == 1.0;
        let mut scales = (0..100).map(|k| 1.0 + 1e-4 * f64::from(k));
        let scale = scales.find(|s| !comes_back(s * made.survey.city_from_sfm.scale)).unwrap();
        let start = Offset { shift_m: [2.0, -2.0, 1.0], heading_rad: 0.4, scale, ..Offset::default() };
        let upright = vertical(&made);
        let leaning = Upright { up: Rotation3::new(Vector3::new(lean_rad, lean_rad, 0.0)) * upright.up, ..upright };
        let [own, other] = [upright, leaning].map(|u| made.scene_with(&start, any_heading, motion, &u));
        let [of_own, of_other] = [&own, &other].map(|scene| found(scene, 1));
        assert!(of_own.len() > 1 && of_other.len() > 1);
        let other_from_own = other.level_cloud.level_from_sfm * own.level_cloud.level_from_sfm.inverse();
        let others: Vec<_> = of_other.into_iter().map(|c| (other_from_own, c)).collect();
        let joined = joined(&PoseRefiner::new(&own), of_own.clone(), &others);
        check(&own, &joined);
        assert!(joined.len() >= of_own.len(), "{} {}", joined.len(), of_own.len());
        let error = made.error(&own, &joined[0].refined.city_from_level);
        assert!(error.up_m < 0.03, "{error:?}");
        for c in joined.iter().filter(|_| motion == Motion::Rigid) {
            assert_eq!(c.refined.city_from_level.scale.to_bits(), 1f64.to_bits());
        }
    }
}

#[test]
fn no_hypotheses_no_candidates() {
    let made = Made::four_houses();
    let scene = made.scene(&Offset::default(), Motion::Similarity);
    let none = Hypotheses { ranked: Vec::new(), solver: String::new(), samples: 0 };
    assert!(candidates(&PoseRefiner::new(&scene), &none).is_empty());
    assert!(joined(&PoseRefiner::new(&scene), Vec::new(), &[]).is_empty());
}
