//! The main job on one page: patches, up, scene, search, candidates, evidence, estimate, verdict.

use std::f64::consts::PI;

use super::options::{AlignOptions, Place, Up};
use super::outcome::Outcome;
use super::whereabouts::{Whereabouts, up_of};
use super::{evidence, report, whereabouts};
use crate::correspondence::{Candidate, Hypotheses, PoseRefiner, Scene, candidates, joined, search};
use crate::evidence::CandidateEvaluation;
use crate::geometry::{Similarity, Start, StartSigmas};
use crate::imagery::LiftedSuperpixels;
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::planes::{Patches, PreparedCity, UpCandidate, Upright, patches, up_beyond_start};
use crate::reconstruction::Reconstruction;
use crate::robust::Motion;
use crate::verdict::{Alignment, Decision, Verdict, judge};

/// Finds where the reconstruction stands in the city and judges it. `superpixels` are the evidence of labels or
/// photographs; without them planar clusters are taken out of the cloud itself.
pub fn align(
    city: &PreparedCity,
    reconstruction: &Reconstruction,
    superpixels: Option<&LiftedSuperpixels>,
    options: &AlignOptions,
    observer: &dyn Observer,
) -> Result<Alignment, Cancelled> {
    observer.progress(Stage::Patches, 0, 0);
    let patches = patches(reconstruction, superpixels, &options.limits.patches);
    let in_place = whereabouts::in_place(&city.model, reconstruction, &patches, options);
    let align_by = |options: &AlignOptions| align_patches(city, reconstruction, &patches, options, observer);
    in_place_first(in_place, options, align_by, |alignment| alignment.verdict)
}

/// Aligns where the cloud's own coordinates say, if they say a place, and elsewhere only where that fails. The false alarms that are allowed are
/// shared between the two searches.
pub(super) fn in_place_first<Answer, Error>(
    in_place: Option<Start>,
    options: &AlignOptions,
    align_by: impl Fn(&AlignOptions) -> Result<Answer, Error>,
    verdict_of: impl Fn(&Answer) -> Verdict,
) -> Result<Answer, Error> {
    let Some(start) = in_place else { return align_by(options) };
    let each = options.with_false_alarm(options.limits.verdict.false_alarm / 2.0);
    let there = align_by(&AlignOptions { place: Place::Start(start), ..each })?;
    match verdict_of(&there) {
        Verdict::Failed => align_by(&each),
        Verdict::Aligned | Verdict::Undetermined | Verdict::Ambiguous => Ok(there),
    }
}

pub(super) fn align_patches(
    city: &PreparedCity,
    reconstruction: &Reconstruction,
    patches: &Patches,
    options: &AlignOptions,
    observer: &dyn Observer,
) -> Result<Alignment, Cancelled> {
    match Whereabouts::find(city, reconstruction, patches, options, observer)? {
        Ok(whereabouts) => align_about(city, patches, whereabouts, options, observer),
        Err(obstacle) => Ok(report::refused(&obstacle, &city.model, patches, options)),
    }
}

/// Aligns from there on.
pub(super) fn align_about(
    city: &PreparedCity,
    patches: &Patches,
    mut whereabouts: Whereabouts,
    options: &AlignOptions,
    observer: &dyn Observer,
) -> Result<Alignment, Cancelled> {
    check_cancelled(observer)?;
    observer.progress(Stage::City, 0, 0);
    let answer_about = |whereabouts: &Whereabouts| Task { city, patches, whereabouts, options, observer }.answer();
    let mut answer = answer_about(&whereabouts)?;
    for _ in 0..MOST_MOVES {
        let Some(moved) = moved_to_answer(&whereabouts, &answer, city, patches, options) else { break };
        whereabouts = moved;
        answer = answer_about(&whereabouts)?;
    }
    if moved_to_answer(&whereabouts, &answer, city, patches, options).is_some() {
        answer.decision = answer.decision.between_places();
    }
    answer.decision = answer.decision.with_left_out(&whereabouts.left_out());
    let up_elsewhere = up_elsewhere(&answer.decision, patches, &whereabouts, options);
    Ok(report::tell(answer, patches, up_elsewhere, city, options))
}

/// Places of a city from which another one is led to, in turn, before the answer is that none is beyond doubt. Chosen: one move is usual.
const MOST_MOVES: usize = 3;

/// The whereabouts about the place of an answer, where that is another one than the answer was asked at.
fn moved_to_answer(
    whereabouts: &Whereabouts,
    answer: &Outcome,
    city: &PreparedCity,
    patches: &Patches,
    options: &AlignOptions,
) -> Option<Whereabouts> {
    let best = answer.found.evidence.rivals.first()?;
    whereabouts.moved_to(&best.city_from_sfm.relative_to(&city.model.origin), patches, &options.limits)
}

/// What is to be aligned, and how.
struct Task<'a> {
    city: &'a PreparedCity,
    patches: &'a Patches,
    whereabouts: &'a Whereabouts,
    options: &'a AlignOptions,
    observer: &'a dyn Observer,
}

/// The result of a search under one direction of up.
struct View<'a> {
    upright: Upright,
    scene: Scene<'a>,
    hypotheses: Hypotheses,
    candidates: Vec<Candidate>,
}

impl<'a> Task<'a> {
    /// Aligns at the given scale, or with the scale free where none was given. Where the data deny it, or cannot tell with it, what they say with the scale free is asked: a
    /// pose of the wrong scale is wrong everywhere.
    fn answer(&self) -> Result<Outcome, Cancelled> {
        if self.options.fixed_scale.is_none() {
            return self.outcome(Motion::Similarity);
        }
        let of_given = self.outcome(Motion::Rigid)?;
        if of_given.found.evidence.hold.agrees_with_given_scale(&self.options.limits.verdict) {
            return Ok(of_given);
        }
        let free = self.outcome(Motion::Similarity)?;
        Ok(if free.decision.scale_is_denied { free } else { of_given })
    }

    fn outcome(&self, motion: Motion) -> Result<Outcome, Cancelled> {
        let view = self.best_view(motion)?;
        self.observer.progress(Stage::Evidence, 0, 0);
        let null_pose_scene = self.null_pose_scene(&view);
        let evaluation = view
            .candidates
            .first()
            .map(|best| CandidateEvaluation::new(&null_pose_scene, self.patches, &best.refined, self.options.seed));
        let evaluated = evaluation
            .as_ref()
            .map_or(Vec::new(), |evaluation| evidence::evaluated_candidates(evaluation, &view.scene, &view.candidates));
        check_cancelled(self.observer)?;
        let refiner = PoseRefiner::new(&view.scene);
        let given_scale = self
            .options
            .fixed_scale
            .and_then(|_| Some(evidence::scale_of_data(&refiner, evaluation.as_ref()?, evaluated.first()?)));
        let space = self.whereabouts.space();
        let found =
            evidence::collect(&refiner, evaluation.as_ref(), &evaluated, given_scale, self.options.accuracy_m, space);
        let decision = judge(&found.evidence, &self.options.limits.verdict);
        Ok(Outcome { decision, found, hypotheses: view.hypotheses })
    }

    /// Searches under every up that there may be; the view with the best candidate, joined by the candidates of the others.
    fn best_view(&self, motion: Motion) -> Result<View<'a>, Cancelled> {
        let uprights = &self.whereabouts.uprights;
        let mut views = uprights.iter().map(|upright| self.view(upright, motion)).collect::<Result<Vec<View>, _>>()?;
        let total_score = |view: &View| view.candidates.first().map_or(f64::NEG_INFINITY, Candidate::total_score);
        let at =
            (0..views.len()).max_by(|&a, &b| total_score(&views[a]).total_cmp(&total_score(&views[b])).then(b.cmp(&a)));
        let mut best = views.swap_remove(at.unwrap_or(0));
        let sfm_from_level = best.scene.level_cloud.level_from_sfm.inverse();
        let seen_from_best = |view: View<'a>| {
            let other_from_level = view.scene.level_cloud.level_from_sfm * sfm_from_level;
            view.candidates.into_iter().map(move |candidate| (other_from_level, candidate))
        };
        let others: Vec<(Similarity, Candidate)> = views.into_iter().flat_map(seen_from_best).collect();
        if !others.is_empty() {
            best.candidates = joined(&PoseRefiner::new(&best.scene), best.candidates, &others);
        }
        Ok(best)
    }

    fn view(&self, upright: &Upright, motion: Motion) -> Result<View<'a>, Cancelled> {
        let mut scene =
            Scene::new(self.city, self.patches, &self.whereabouts.reach, motion, upright, &self.options.limits);
        if !self.whereabouts.is_start() {
            scene.prior = scene.prior.uniform();
        }
        let hypotheses = match self.whereabouts.hypotheses(&scene, upright) {
            Some(of_places) => of_places,
            None => search(&scene, self.options.seed, self.observer)?,
        };
        let candidates = candidates(&PoseRefiner::new(&scene), &hypotheses);
        check_cancelled(self.observer)?;
        Ok(View { upright: *upright, scene, hypotheses, candidates })
    }

    /// The scene of a view with a prior that reaches over its neighbourhood, whatever the heading. What chance does is asked of poses that are as free as those of a usual start: one
    /// that knows everything would leave none to compare with.
    fn null_pose_scene(&self, view: &View) -> Scene<'a> {
        let limits = &self.options.limits;
        let Whereabouts { start, reach, .. } = self.whereabouts;
        let (own, usual) = (*reach.sigmas(), StartSigmas::default());
        let sigmas = StartSigmas {
            position_m: start.sigmas().position_m.max(limits.null_poses.least_reach_m / limits.reach_sigmas),
            height_m: own.height_m.max(usual.height_m),
            heading_rad: PI,
            tilt_rad: own.tilt_rad.max(usual.tilt_rad),
            log_scale: own.log_scale.max(usual.log_scale),
        };
        let start = start.with_sigmas(sigmas);
        let mut scene = Scene::new(self.city, self.patches, &start, view.scene.prior.motion, &view.upright, limits);
        // Poses of the view are weighed in it, wherever they are.
        scene.reach = scene.reach.with(&view.scene.reach);
        scene
    }
}

/// The up that walls and cameras see, where nothing was found and it lies beyond the start's reach.
fn up_elsewhere(
    decision: &Decision,
    patches: &Patches,
    whereabouts: &Whereabouts,
    options: &AlignOptions,
) -> Option<UpCandidate> {
    let failed = decision.verdict == Verdict::Failed && options.up == Up::Auto && whereabouts.is_start();
    failed.then(|| up_beyond_start(patches, &up_of(&whereabouts.start), &options.limits)).flatten()
}
