//! The last estimate of a pose, with all that errs together in the model and the reconstruction as unknowns beside it.
//!
//! Unknowns     the pose (7 or 6); how far all walls stand inside the model's and how high its level tops are too high (common to all);
//!              the reconstruction's bending (26 smooth fields); for each building a shift and a turn; for each building plane an offset and two tilts
//! Method       least squares with a prior on every unknown but the pose. The variances of buildings, building planes, surface cells and bending are estimated
//!              together with the unknowns (expectation and maximisation, which counts what is not known of an unknown: restricted
//!              maximum likelihood), each with a prior worth a few observations. Buildings, building planes and surface cells have heavy tails
//!              (Student's t): a rebuilt house, a building plane that is another's, a surface cell with a tree before it are outliers as wholes.
//!              Points are put on facets anew after each round
//! Source       docs/mathematics.md 17.2
//! Fails when   the pose is in another basin: then it is exactly wrong

use super::findings::SystematicErrors;
use super::leave_out;
use super::observations::observations;
use super::system::System;
use crate::correspondence::PoseRefiner;
use crate::geometry::Similarity;
use crate::robust::{Matrix7, MotionParameters};

/// The final pose with its information.
#[derive(Clone, Debug)]
pub struct Estimate {
    pub city_from_level: Similarity,
    pub parameters: MotionParameters,
    /// What the data hold of the pose, 1 / m^2 in the motion's unknowns.
    pub information: Matrix7,
    /// The same without each of the building planes in turn.
    pub without: Vec<Matrix7>,
    pub findings: SystematicErrors,
}

/// The estimate near a pose.
pub fn estimate(refiner: &PoseRefiner, pose: &Similarity) -> Estimate {
    let scene = refiner.scene;
    let limits = &scene.limits.uncertainty;
    let mut pose = *pose;
    for _ in 0..limits.rounds {
        let parameters = refiner.assess(&[], &pose, 0.0).parameters;
        let observations = observations(refiner, &pose, limits.gate_units * scene.gate_unit_m);
        let system = System::converged(refiner, &pose, &parameters, &observations);
        let moved = parameters.moved(&pose, &parameters.step(&system.held(), scene.limits.refinement.most_sigma_m));
        if !moved.translation.iter().all(|v| v.is_finite()) || !scene.prior.reaches(&moved) {
            break;
        }
        pose = moved;
    }
    let parameters = refiner.assess(&[], &pose, 0.0).parameters;
    let observations = observations(refiner, &pose, limits.gate_units * scene.gate_unit_m);
    let mut system = System::converged(refiner, &pose, &parameters, &observations);
    system.widen_to_t_variance();
    let left_out = leave_out::by_building(&system);
    Estimate {
        city_from_level: pose,
        parameters,
        information: left_out.widened(&system.held().full()),
        without: leave_out::by_building_plane(&system).iter().map(|m| left_out.widened(m)).collect(),
        findings: SystematicErrors::of(&system),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::Scene;
    use crate::correspondence::test_scene::Made;
    use crate::geometry::Vector3;
    use crate::robust::Motion;
    use crate::synthetic::{Block, CloudOptions, House, Offset, Survey};

    fn seen() -> CloudOptions {
        CloudOptions { points_per_roof: 100, outlier_share: 0.0, seed: 5, ..CloudOptions::default() }
    }

    fn town() -> Block {
        Block::town(2, 2, 3).with_ground()
    }

    fn found(made: &Made) -> (Estimate, Scene<'_>) {
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let estimate = estimate(&PoseRefiner::new(&scene), &made.truth(&scene));
        (estimate, scene)
    }

    /// One sigma of the whole pose, metres.
    fn sigma_m(estimate: &Estimate) -> f64 {
        estimate.information.try_inverse().unwrap().trace().sqrt()
    }

    /// The city has its houses changed, the survey saw them as they were.
    fn with_other_model(block: &Block, change: impl Fn(usize, &mut House)) -> Made {
        let survey = block.cloud(&seen());
        let mut known = block.clone();
        known.houses.iter_mut().enumerate().for_each(|(k, house)| change(k, house));
        Made::new(known, survey)
    }

    fn shifted(house: &mut House, by: [f64; 3]) {
        *house = house.clone().at(by);
    }

    #[test]
    fn an_exact_model_gives_a_pose_to_centimetres_and_says_so() {
        let made = Made::cloud(town(), &seen());
        let (estimate, scene) = found(&made);
        let error = made.error(&scene, &estimate.city_from_level);
        assert!(error.level_m < 0.02 && error.up_m < 0.02, "{error:?}");
        assert!(sigma_m(&estimate) < 0.15, "{}", sigma_m(&estimate));
        assert!(estimate.findings.buildings_m < 0.06, "{:?}", estimate.findings);
        assert!(estimate.findings.notable(&made.limits.uncertainty).is_empty(), "{:?}", estimate.findings);
    }

    #[test]
    fn the_unit_of_the_reconstruction_changes_nothing() {
        let made = Made::cloud(town(), &seen());
        let mut survey = town().cloud(&seen());
        survey.sfm.points.iter_mut().for_each(|p| p.coords *= 7.0);
        survey.city_from_sfm.scale /= 7.0;
        let other = Made::new(town(), survey);
        let (one, two) = (sigma_m(&found(&made).0), sigma_m(&found(&other).0));
        assert!((one / two - 1.0).abs() < 1e-3, "{one} {two}");
    }

    #[test]
    fn a_house_that_stands_elsewhere_moves_the_pose_by_less_than_its_share() {
        let block = town();
        let made = with_other_model(&block, |k, house| {
            if k == 1 {
                shifted(house, [0.3, 0.3, 0.0]);
            }
        });
        let (estimate, scene) = found(&made);
        let level_m = made.error(&scene, &estimate.city_from_level).level_m;
        let share_m = 0.3 * 2f64.sqrt() / block.houses.len() as f64;
        assert!(level_m < share_m, "{level_m} {share_m}");
    }

    #[test]
    fn houses_that_stand_off_each_on_its_own_widen_the_sigmas_and_are_found() {
        let block = town();
        let exact = found(&with_other_model(&block, |_, _| ())).0;
        let made = with_other_model(&block, |k, house| shifted(house, off(k)));
        let (estimate, _) = found(&made);
        assert!(sigma_m(&estimate) > 1.3 * sigma_m(&exact), "{} {}", sigma_m(&estimate), sigma_m(&exact));
        assert!(estimate.findings.buildings_m > 0.07, "{:?}", estimate.findings);
    }

    #[test]
    fn walls_under_eaves_are_told_and_do_not_pull_the_scale() {
        let block = town();
        let made = with_other_model(&block, |_, house| {
            let corners = || house.faces.iter().flat_map(|face| &face.corners);
            let middle = corners().map(|c| c.coords).sum::<Vector3<f64>>() / corners().count() as f64;
            // A house is grown about its middle in plan: by some 0.3 m a wall.
            let reach = corners().map(|c| (c.coords - middle).xy().norm()).sum::<f64>() / corners().count() as f64;
            for corner in house.faces.iter_mut().flat_map(|face| &mut face.corners) {
                let arm = (corner.coords - middle).xy();
                corner.x += arm.x / reach * 0.4;
                corner.y += arm.y / reach * 0.4;
            }
        });
        let (estimate, scene) = found(&made);
        let found_m = estimate.findings.walls_inset_m;
        assert!((0.2..0.4).contains(&found_m), "{:?}", estimate.findings);
        let told = estimate.findings.notable(&made.limits.uncertainty);
        assert!(told.iter().any(|text| text.contains("inside the model's")), "{told:?}");
        let scale_error = estimate.city_from_level.scale / made.truth(&scene).scale - 1.0;
        assert!(scale_error.abs() < 2e-3, "{scale_error}");
    }

    /// Where a model's houses stand off, each on its own.
    fn off(k: usize) -> [f64; 3] {
        let of = |k: usize| [0.2, -0.2, 0.1, -0.1][k % 4] * if k % 8 < 4 { 1.0 } else { -1.0 };
        [of(k), of(k / 2 + 1), 0.0]
    }

    #[test]
    fn half_of_the_points_give_nearly_the_same_sigmas_and_points_given_twice_the_same() {
        let sigma_of = |change: &dyn Fn(&mut Survey)| {
            let mut survey = town().cloud(&seen());
            change(&mut survey);
            let mut known = town();
            known.houses.iter_mut().enumerate().for_each(|(k, house)| shifted(house, off(k)));
            sigma_m(&found(&Made::new(known, survey)).0)
        };
        let whole = sigma_of(&|_| ());
        let half = sigma_of(&|survey| {
            let every_other = |count: usize| (0..count).map(|k| k % 2 == 0).collect::<Vec<_>>().into_iter();
            let mut keep = every_other(survey.sfm.points.len());
            survey.sfm.points.retain(|_| keep.next() == Some(true));
            let mut keep = every_other(survey.sfm.normals.len());
            survey.sfm.normals.retain(|_| keep.next() == Some(true));
            let mut keep = every_other(survey.face_of_point.len());
            survey.face_of_point.retain(|_| keep.next() == Some(true));
        });
        assert!((half / whole - 1.0).abs() < 0.25, "{half} {whole}");
        let twice = sigma_of(&|survey| {
            survey.sfm.points.extend_from_within(..);
            survey.sfm.normals.extend_from_within(..);
            survey.face_of_point.extend_from_within(..);
        });
        assert!((twice / whole - 1.0).abs() < 0.02, "{twice} {whole}");
    }

    #[test]
    fn a_given_scale_is_kept_to_the_bit_and_nothing_is_said_to_hold_it() {
        let made = Made::cloud(town(), &seen());
        let scene = made.scene(&Offset::default(), Motion::Rigid);
        let estimate = estimate(&PoseRefiner::new(&scene), &scene.prior.expected());
        assert_eq!(estimate.city_from_level.scale.to_bits(), 1f64.to_bits());
        assert!(estimate.information.column(6).norm() < 1e-6, "{}", estimate.information);
    }
}
