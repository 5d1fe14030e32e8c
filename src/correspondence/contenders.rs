//! From thousands of hypotheses to a few distinct poses, each as good as it can be made.
//!
//! Method       the robust search ranks minimal samples on a small panel of votes; then stages with larger panels and narrower gates
//!              refine, slide and rank fewer and fewer of them. From the second stage on a pose also pays for every line of
//!              sight that it would block, and better poses in the basins beside join before the last. Distinct poses stay distinct
//!              to the end: the verdict reads the distance to the runner-up.

use rayon::prelude::*;

use super::economy::{cheapest, prospects};
use super::hop::hop;
use super::lead::{ballot, lead_sigmas};
use super::pairing::Pairing;
use super::refine::{ErrorModel, Refined, Refiner};
use super::scene::{Scene, WIDEST_GATE};
use super::scoring::Scorer;
use super::search::{PoseSearch, largest_shift};
use super::slide::slide;
use crate::geometry::{Similarity, Vector3};
use crate::robust::{RansacOptions, ransac};
use crate::solvers::{Sought, Up};

/// A pose that survived to the end.
#[derive(Clone, Debug)]
pub struct Contender {
    pub refined: Refined,
    /// Share of the vote that lies on the city.
    pub share: f64,
    /// Share of the vote whose lines of sight the city would block.
    pub blocked: f64,
    /// What leaving the start costs.
    pub prior_cost: f64,
    /// Samples of the search that led here.
    pub hits: usize,
    /// By how many standard errors the best pose leads this one; see the card of `lead`.
    pub lead_sigmas: f64,
}

impl Contender {
    /// What speaks for the pose less what speaks against it.
    pub fn balance(&self) -> f64 {
        self.share - self.blocked - self.prior_cost
    }
}

/// What the search found and how.
#[derive(Clone, Debug)]
pub struct Contest {
    /// Best first.
    pub contenders: Vec<Contender>,
    /// Which configuration of the minimal family drew the samples, or `NO_SOLVER`.
    pub solver: String,
    pub samples: usize,
}

/// What a result names where the data feed no solver.
pub const NO_SOLVER: &str = "none";

/// A round of improvement.
struct Stage {
    /// Probes that refine and rank.
    panel: Vec<u32>,
    /// Gates of refinement and of ranking, in units of the scene.
    gates: &'static [f64],
    ranking_gate: f64,
    /// Whether lines of sight count.
    sight: bool,
    /// Whether better poses in the basins beside join first.
    hops: bool,
    /// Poses that go on.
    keep: usize,
}

/// Probes that rank a hypothesis: one vote in 200 more or less is noise beside that of a minimal sample.
const RANKING_PANEL: usize = 200;
/// Probes whose lines of sight are traced.
const SIGHT_PANEL: usize = 500;
/// Probes that say which of two basins explains more.
const HOPPING_PANEL: usize = 1500;
/// Model error of one plane: buildings stand some centimetres from where models have them.
const PLANE_SIGMA_M: f64 = 0.05;
/// No point of a photograph is better than this.
const LEAST_POINT_SIGMA_M: f64 = 0.01;
/// Two poses that move no corner of the scene by more than this many units are one.
const SAME_POSE_UNITS: f64 = 2.5;

/// Searches the scene. `scale` (relative to the start) is held where given; `progress` is told how many samples of how many.
pub fn contest(scene: &Scene, scale: Option<f64>, seed: u64, progress: &(dyn Fn(usize, usize) + Sync)) -> Contest {
    let scorer = Scorer { votes: &scene.votes, field: &scene.field, start: scene.start };
    let pairing =
        Pairing::new(&scene.votes, &scene.planes, &scene.start, scale, scene.up_is_known, |p| scene.is_seen(p));
    let (sought, panel) = (sought(scene, scale), scene.votes.panel(RANKING_PANEL));
    let gate_m = WIDEST_GATE * scene.unit_m;
    let search =
        |configuration| PoseSearch { pairing: &pairing, scorer: &scorer, sought, configuration, panel: &panel, gate_m };
    let searches: Vec<PoseSearch> = sought.configurations().iter().map(search).collect();
    let mut contest = Contest { contenders: Vec::new(), solver: NO_SOLVER.to_owned(), samples: 0 };
    let Some(configuration) = cheapest(&prospects(&searches)) else { return contest };
    contest.solver = format!("{} {configuration}", sought.name());
    let problem = search(&configuration);
    let options = RansacOptions { seed, keep: 60, fewest_samples: 8192, most_samples: 65_536, enough_hits: 10 };
    let (ranked, samples) = ransac(&problem, &options, |n| progress(n, options.most_samples));
    contest.samples = samples;

    let refiner = refiner(scene, &scorer, scale.is_some());
    let unranked = |r: &crate::robust::Ranked<Similarity>| Contender {
        refined: refiner.assess(&[], &r.pose, 0.0),
        share: r.score,
        blocked: 0.0,
        prior_cost: 0.0,
        hits: r.hits,
        lead_sigmas: 0.0,
    };
    let mut contenders: Vec<Contender> = ranked.iter().map(unranked).collect();
    for stage in stages(scene) {
        if stage.hops {
            contenders.extend(beside(scene, &refiner, &contenders));
        }
        let improve = |c: &Contender| improved(scene, &refiner, &stage, c);
        contenders = contenders.par_iter().map(improve).collect();
        contenders.retain(|c| scorer.within_reach(&c.refined.city_from_level));
        contenders = distinct(contenders, scene, stage.keep);
    }
    // Once more, with a gate as narrow as the residuals allow: what lies beyond is somebody else's facet.
    let (firm, all) = (probes(scene.votes.firm), probes(scene.votes.probes.len()));
    for c in &mut contenders {
        let sharp = refiner.sharpen(&firm, &c.refined.city_from_level, scene.unit_m);
        c.refined = refiner.settle(&all, sharp, scene.unit_m, SETTLING_UNITS * scene.unit_m);
    }
    compare_with_best(&mut contenders, scene, &scorer);
    contest.contenders = contenders;
    contest
}

/// What is unknown of the pose in the level frame.
fn sought(scene: &Scene, scale: Option<f64>) -> Sought {
    let up = Up::new(&Vector3::z(), &Vector3::z()).filter(|_| scene.up_is_known);
    match (up, scale) {
        (Some(up), None) => Sought::UprightSimilarity(up),
        (Some(up), Some(_)) => Sought::UprightRigid(up),
        (None, None) => Sought::Similarity,
        (None, Some(_)) => Sought::Rigid,
    }
}

fn compare_with_best(contenders: &mut [Contender], scene: &Scene, scorer: &Scorer) {
    let ballots: Vec<Vec<f64>> = contenders.iter().map(|c| ballot(scene, scorer, &c.refined.city_from_level)).collect();
    let costs: Vec<f64> = contenders.iter().map(|c| c.prior_cost).collect();
    for (k, c) in contenders.iter_mut().enumerate().skip(1) {
        c.lead_sigmas = lead_sigmas(&ballots[0], &ballots[k], costs[k] - costs[0]);
    }
}

/// The refiner of a scene.
pub fn refiner<'a>(scene: &'a Scene, scorer: &'a Scorer<'a>, scale_is_fixed: bool) -> Refiner<'a> {
    let point_sigma_m = scene.votes.noise_m.max(LEAST_POINT_SIGMA_M);
    let errors = ErrorModel { point_sigma_m, plane_sigma_m: PLANE_SIGMA_M };
    Refiner { scorer, planes: &scene.planes, errors, scale_is_fixed }
}

fn stages(scene: &Scene) -> [Stage; 3] {
    let votes = &scene.votes;
    [
        Stage {
            panel: votes.panel(400),
            gates: &[5.0, 5.0, 4.0, 3.3, 2.7],
            ranking_gate: 2.3,
            sight: false,
            hops: false,
            keep: 16,
        },
        Stage {
            panel: votes.panel(1500),
            gates: &[2.7, 2.3, 2.0, 1.7, 1.7],
            ranking_gate: 1.3,
            sight: true,
            hops: false,
            keep: 6,
        },
        Stage {
            panel: probes(votes.firm),
            gates: &[1.7, 1.3, 1.0, 1.0],
            ranking_gate: 1.0,
            sight: true,
            hops: true,
            keep: 6,
        },
    ]
}

fn probes(count: usize) -> Vec<u32> {
    (0..count as u32).collect()
}

/// Better poses in basins beside those of the contenders, which stay: one that is far enough off remains a rival.
fn beside(scene: &Scene, refiner: &Refiner, contenders: &[Contender]) -> Vec<Contender> {
    let panel = scene.votes.panel(HOPPING_PANEL);
    let hopped = |c: &Contender| {
        let pose = hop(refiner, &panel, &c.refined.city_from_level, scene.unit_m);
        Contender { refined: refiner.assess(&[], &pose, 0.0), hits: 0, ..c.clone() }
    };
    contenders.par_iter().map(hopped).collect()
}

fn improved(scene: &Scene, refiner: &Refiner, stage: &Stage, contender: &Contender) -> Contender {
    let gates_m: Vec<f64> = stage.gates.iter().map(|g| g * scene.unit_m).collect();
    let gate_m = stage.ranking_gate * scene.unit_m;
    let scorer = refiner.scorer;
    let first = refiner.refine(&stage.panel, &contender.refined.city_from_level, &gates_m);
    let spectrum = first.equations.spectrum();
    // Loose points have no vote.
    let voters = scene.votes.panel(stage.panel.len().min(MOST_VOTERS));
    let slid = slide(scorer, &voters, &first.chart, &spectrum, &first.city_from_level, gate_m);
    let refined = if slid == first.city_from_level { first } else { refiner.refine(&stage.panel, &slid, &gates_m) };
    let pose = refined.city_from_level;
    let blocked = if stage.sight { blocked_share(scene, &pose) } else { 0.0 };
    let share = scorer.panel_share(&voters, &pose, gate_m);
    Contender { refined, share, blocked, prior_cost: scorer.prior_cost(&pose), hits: contender.hits, lead_sigmas: 0.0 }
}

/// A slide by the votes ends within this many units of the right place.
const SETTLING_UNITS: f64 = 4.0;

/// Voters of the last ranking; a larger panel changes the third digit.
const MOST_VOTERS: usize = 3000;

fn blocked_share(scene: &Scene, pose: &Similarity) -> f64 {
    let panel = scene.votes.panel(SIGHT_PANEL);
    let blocked = scene.sightlines.blocked(&scene.votes, &panel, pose);
    blocked.iter().filter(|b| **b).count() as f64 / blocked.len().max(1) as f64
}

/// The best `keep` of those that are truly different, best first.
fn distinct(mut contenders: Vec<Contender>, scene: &Scene, keep: usize) -> Vec<Contender> {
    contenders.sort_by(|a, b| b.balance().total_cmp(&a.balance()));
    let mut kept: Vec<Contender> = Vec::new();
    for c in contenders {
        let shift =
            |k: &Contender| largest_shift(&k.refined.city_from_level, &c.refined.city_from_level, scene.votes.radius_m);
        match kept.iter_mut().find(|k| shift(k) < SAME_POSE_UNITS * scene.unit_m) {
            Some(same) => same.hits += c.hits,
            None => kept.push(c),
        }
    }
    kept.truncate(keep);
    kept
}
