//! All poses that may be right, heard by the same witnesses.
//!
//! Question     which pose is right, and what speaks against it?
//! Input        a scene whose prior reaches beyond the start's, and the poses that the search found within the start's reach
//! Output       every distinct pose with its evidence: those of the search, and the best that were fitted to other places, which are refined to the end
//! Method       the contenders of other places give the rates by chance, and the best of them are heard as rivals: who wins within the
//!              start's reach is compared with what lies beyond it, too

use rayon::prelude::*;

use super::bits::{Weighed, weigh};
use super::chance::Chance;
use super::outcomes::outcomes;
use super::witnesses::Witnesses;
use crate::correspondence::{Candidate, Place, Refined, Refiner, Scene, candidate_at, contenders, settled};
use crate::geometry::Similarity;
use crate::limits::ContenderLimits;

/// A pose that may be right.
#[derive(Clone, Debug)]
pub struct Contestant {
    pub candidate: Candidate,
    pub weighed: Weighed,
    /// Whether it was fitted to another place than the search's, and is not among its candidates.
    pub by_chance: bool,
}

/// What judges the poses of one cloud in one city.
pub struct Contest<'a> {
    scene: &'a Scene<'a>,
    witnesses: Witnesses,
    chance: Chance,
    /// The best contenders, made as sharp as the search's candidates.
    pub others: Vec<Contestant>,
    /// Evidence of all contenders, the largest first.
    pub by_chance: Vec<f64>,
}

impl<'a> Contest<'a> {
    /// `scene` reaches beyond the start; `answer` is the search's best pose.
    pub fn new(scene: &'a Scene<'a>, answer: &Refined, seed: u64) -> Contest<'a> {
        let limits = scene.limits;
        let refiner = Refiner::new(scene);
        let place = Place::of(answer, limits.refinement.held_m, &limits.contenders);
        let fitted = contenders(&refiner, &place, seed, &limits.contenders);
        let witnesses = Witnesses::new(scene, answer.city_from_level.scale, &limits.evidence);
        let of_pose = |pose: &Similarity| outcomes(scene, &witnesses, pose, &limits.evidence);
        let met: Vec<_> = fitted.par_iter().map(|c| of_pose(&c.city_from_level)).collect();
        let chance = Chance::new(&witnesses, &met, limits.evidence.unseen_contenders);
        let mut ranked: Vec<(f64, Similarity)> = met
            .iter()
            .zip(&fitted)
            .map(|(met, c)| (weigh(&witnesses, met, &chance, &limits.evidence).bits, c.city_from_level))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let by_chance = ranked.iter().map(|(bits, _)| *bits).collect();
        let mut contest = Contest { scene, witnesses, chance, others: Vec::new(), by_chance };
        // Refinement to the end gains some bits: who is twice the margin behind cannot become a rival.
        let least = contest.weigh(&answer.city_from_level).bits - 2.0 * limits.verdict.margin_bits();
        ranked.retain(|(bits, _)| *bits >= least);
        contest.others = contest.sharpened(&refiner, &ranked, &place);
        contest
    }

    /// The evidence of a pose.
    pub fn weigh(&self, pose: &Similarity) -> Weighed {
        let evidence = &self.scene.limits.evidence;
        weigh(&self.witnesses, &outcomes(self.scene, &self.witnesses, pose, evidence), &self.chance, evidence)
    }

    /// How many planes in space can speak for a pose.
    pub fn witnesses(&self) -> usize {
        self.witnesses.class.len()
    }

    /// The best distinct contenders, refined to the end.
    fn sharpened(&self, refiner: &Refiner, ranked: &[(f64, Similarity)], answer: &Place) -> Vec<Contestant> {
        let ContenderLimits { heard: most, .. } = self.scene.limits.contenders;
        let mut heard: Vec<Place> = Vec::new();
        for (_, pose) in ranked {
            if heard.len() < most && !heard.iter().any(|other| other.has(pose)) {
                heard.push(Place::around(refiner, pose));
            }
        }
        let to_the_end = |place: &Place| {
            let refined = settled(refiner, place.pose());
            let candidate = Candidate { refined, ..candidate_at(refiner, place.pose()) };
            let weighed = self.weigh(&candidate.refined.city_from_level);
            Contestant { candidate, weighed, by_chance: true }
        };
        let sharp: Vec<Contestant> = heard.par_iter().map(to_the_end).collect();
        sharp.into_iter().filter(|c| !answer.has(&c.candidate.refined.city_from_level)).collect()
    }
}
