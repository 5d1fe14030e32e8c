//! All poses that may be right, compared on the same planes of the cloud.
//!
//! Question     which pose is right, and what speaks against it?
//! Input        a scene whose prior reaches beyond the start's, and the poses that the search found within the start's reach
//! Output       every distinct pose with its evidence: those of the search, and the best that were fitted to other places, which are refined to the end
//! Method       the null poses of other places give the rates by chance, and the best of them are compared as rivals: who wins within the
//!              start's reach is compared with what lies beyond it, too

use rayon::prelude::*;

use super::bits::{PoseEvidence, weigh};
use super::chance::NullRates;
use super::cloud_planes::CloudPlanes;
use super::occluded::SeenPoints;
use super::outcomes::{Outcomes, outcomes};
use crate::correspondence::{
    Basin, Candidate, PoseRefiner, RefinedPose, Scene, candidate_at, null_poses, refined_to_end,
};
use crate::geometry::Similarity;
use crate::limits::NullPoseLimits;
use crate::planes::Patches;

/// A pose that may be right.
#[derive(Clone, Debug)]
pub struct EvaluatedCandidate {
    pub candidate: Candidate,
    pub weighed: PoseEvidence,
    /// Whether it was fitted to another place than the search's, and is not among its candidates.
    pub by_chance: bool,
}

/// What candidates of one cloud in one city are compared on: planes of the cloud, rates by chance.
pub struct CandidateEvaluation<'a> {
    scene: &'a Scene<'a>,
    cloud_planes: CloudPlanes,
    seen: SeenPoints,
    chance: NullRates,
    /// The best null poses, made as sharp as the search's candidates.
    pub others: Vec<EvaluatedCandidate>,
    /// Evidence of all null poses, the largest first.
    pub by_chance: Vec<f64>,
}

impl<'a> CandidateEvaluation<'a> {
    /// `scene` reaches beyond the start, and is of the cloud of `patches`; `answer` is the search's best pose.
    pub fn new(scene: &'a Scene<'a>, patches: &Patches, answer: &RefinedPose, seed: u64) -> CandidateEvaluation<'a> {
        let limits = scene.limits;
        let refiner = PoseRefiner::new(scene);
        let place = Basin::of(answer, limits.refinement.most_sigma_m, &limits.null_poses);
        let fitted = null_poses(&refiner, &place, seed, &limits.null_poses);
        let scale = answer.city_from_level.scale;
        let cloud_planes = CloudPlanes::new(scene, scale, &limits.evidence);
        let seen = SeenPoints::new(scene, patches, scale, &limits.evidence);
        let meet = |c: &RefinedPose| {
            let pose = &c.city_from_level;
            (outcomes(scene, &cloud_planes, pose, &limits.evidence), seen.occluded_share(scene, pose))
        };
        let met: Vec<(Outcomes, f64)> = fitted.par_iter().map(meet).collect();
        let (met, hidden): (Vec<Outcomes>, Vec<f64>) = met.into_iter().unzip();
        let chance = NullRates::new(&cloud_planes, &met, hidden.clone(), limits.evidence.unseen_null_poses);
        let mut ranked: Vec<(f64, Similarity)> = (met.iter().zip(&hidden).zip(&fitted))
            .map(|((met, hidden), c)| (weigh(&cloud_planes, met, *hidden, &chance).bits, c.city_from_level))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let by_chance = ranked.iter().map(|(bits, _)| *bits).collect();
        let mut evaluation = CandidateEvaluation { scene, cloud_planes, seen, chance, others: Vec::new(), by_chance };
        // Refinement to the end gains some bits: who is twice the margin behind cannot become a rival.
        let least = evaluation.weigh(&answer.city_from_level).bits - 2.0 * limits.verdict.margin_bits();
        ranked.retain(|(bits, _)| *bits >= least);
        evaluation.others = evaluation.sharpened(&refiner, &ranked, &place);
        evaluation
    }

    /// The evidence of a pose.
    pub fn weigh(&self, pose: &Similarity) -> PoseEvidence {
        let met = outcomes(self.scene, &self.cloud_planes, pose, &self.scene.limits.evidence);
        weigh(&self.cloud_planes, &met, self.seen.occluded_share(self.scene, pose), &self.chance)
    }

    /// How many planes in space can speak for a pose.
    pub fn cloud_planes(&self) -> usize {
        self.cloud_planes.inclinations.len()
    }

    /// The best distinct null poses, refined to the end.
    fn sharpened(
        &self,
        refiner: &PoseRefiner,
        ranked: &[(f64, Similarity)],
        answer: &Basin,
    ) -> Vec<EvaluatedCandidate> {
        let NullPoseLimits { rivals: most, .. } = self.scene.limits.null_poses;
        let mut basins: Vec<Basin> = Vec::new();
        for (_, pose) in ranked {
            if basins.len() < most && !basins.iter().any(|other| other.has(pose)) {
                basins.push(Basin::around(refiner, pose));
            }
        }
        let to_the_end = |place: &Basin| {
            let refined = refined_to_end(refiner, place.pose());
            let candidate = Candidate { refined, ..candidate_at(refiner, place.pose()) };
            let weighed = self.weigh(&candidate.refined.city_from_level);
            EvaluatedCandidate { candidate, weighed, by_chance: true }
        };
        let sharp: Vec<EvaluatedCandidate> = basins.par_iter().map(to_the_end).collect();
        sharp.into_iter().filter(|c| !answer.has(&c.candidate.refined.city_from_level)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::Made;
    use crate::geometry::{StartSigmas, Vector3};
    use crate::planes::Upright;
    use crate::robust::Motion;
    use crate::synthetic::Offset;

    /// A scene whose prior reaches over the whole block in every heading.
    fn wide(made: &Made) -> Scene<'_> {
        let up = made.survey.city_from_sfm.rotation.inverse() * Vector3::z();
        let upright = Upright { up, sigma_rad: 0.0, known: true };
        let sigmas = StartSigmas { position_m: 33.0, heading_rad: std::f64::consts::PI, ..StartSigmas::default() };
        made.scene_with(&Offset::default(), sigmas, Motion::Similarity, &upright)
    }

    fn answer(scene: &Scene, made: &Made, off: &Offset) -> RefinedPose {
        refined_to_end(&PoseRefiner::new(scene), &made.pose(scene, off))
    }

    #[test]
    fn the_truth_has_more_evidence_than_chance_and_than_every_other_place() {
        for made in [Made::four_houses(), Made::photographed()] {
            let scene = wide(&made);
            let truth = answer(&scene, &made, &Offset::default());
            let evaluation = CandidateEvaluation::new(&scene, &made.patches, &truth, 1);
            let bits = evaluation.weigh(&truth.city_from_level).bits;
            assert!(bits > 20.0, "{bits}");
            assert!(!evaluation.by_chance.is_empty() && evaluation.by_chance.is_sorted_by(|a, b| a >= b));
            assert!(evaluation.by_chance[0] < bits - 10.0, "{bits} {:?}", &evaluation.by_chance[..3]);
            for shift_m in [[4.0, 0.0, 0.0], [0.0, -6.0, 0.0], [3.0, 3.0, 1.5]] {
                let other = answer(&scene, &made, &Offset { shift_m, ..Offset::default() });
                let off_m = made.error(&scene, &other.city_from_level).level_m;
                assert!(off_m < 1.0 || evaluation.weigh(&other.city_from_level).bits < bits - 10.0, "{shift_m:?}");
            }
        }
    }

    #[test]
    fn a_wrong_answer_has_no_evidence_and_the_right_place_is_heard_beside_it() {
        let made = Made::four_houses();
        let scene = wide(&made);
        let wrong = answer(&scene, &made, &Offset { shift_m: [9.0, -7.0, 0.0], heading_rad: 0.3, ..Offset::default() });
        let evaluation = CandidateEvaluation::new(&scene, &made.patches, &wrong, 1);
        assert!(evaluation.weigh(&wrong.city_from_level).bits < 10.0);
        let best = evaluation.others.iter().map(|other| other.weighed.bits).fold(f64::NEG_INFINITY, f64::max);
        assert!(best > evaluation.weigh(&wrong.city_from_level).bits, "{best}");
        let nearest_m = |c: &EvaluatedCandidate| made.error(&scene, &c.candidate.refined.city_from_level).level_m;
        let found = evaluation.others.iter().any(|other| nearest_m(other) < 0.1 && other.by_chance);
        assert!(found, "{:?}", evaluation.others.iter().map(nearest_m).collect::<Vec<_>>());
    }

    #[test]
    fn what_leads_to_the_answer_but_for_an_open_height_is_no_contender() {
        let made = Made::walls();
        let scene = wide(&made);
        let refiner = PoseRefiner::new(&scene);
        let truth = refiner.sharpen(
            &(0..scene.level_cloud.patch_points as u32).collect::<Vec<_>>(),
            &made.truth(&scene),
            scene.gate_unit_m,
        );
        let limits = &made.limits;
        let place = Basin::of(&truth, limits.refinement.most_sigma_m, &limits.null_poses);
        let at = |shift_m: [f64; 3]| made.pose(&scene, &Offset { shift_m, ..Offset::default() });
        assert!(place.has(&at([0.0, 0.0, 5.0])) && place.has(&at([0.5, 0.5, -4.0])));
        assert!(!place.has(&at([3.0, 0.0, 0.0])));
        assert!(!Basin::around(&refiner, &truth.city_from_level).has(&at([0.0, 0.0, 5.0])));
    }
}
