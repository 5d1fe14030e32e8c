//! Whether two parts belong together at all: tests that are independent of the estimate, each with its reason.
//!
//! Input        what one source, point pairs or planes, answers to the same questions ([`PairChecks`]), and the poses of the shared photographs
//! Output       a [`PairDecision`]
//! Method       both parts must be sound; there must be enough that chance does not explain; a similarity must be agreed on, and no mirror
//!              image or stretch explain more; the shared cameras must stand where it puts them; and every freedom must be held

use nalgebra::SymmetricEigen;

use super::fit::Fit;
use super::shared_tracks::{CameraPair, SharedTracks};
use crate::merging::fault::PairFault;
use crate::merging::limits::MergeLimits;
use crate::merging::pair_limits::PairDecisionLimits;

/// Whether two parts belong together.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::merging) enum PairDecision {
    /// They are parts of one place, and how they stand is fixed.
    Accepted,
    /// They may be, but how they stand is not fixed.
    Open(PairFault),
    /// They are not, for all that is known.
    Rejected(PairFault),
}

impl PairDecision {
    /// Why they are not joined.
    pub fn fault(&self) -> Option<&PairFault> {
        match self {
            PairDecision::Accepted => None,
            PairDecision::Open(fault) | PairDecision::Rejected(fault) => Some(fault),
        }
    }
}

/// The questions that decide, answered by one source: point pairs, or points on planes.
pub(super) trait PairChecks {
    /// The source in the words of the report: what determines the pose, and what is counted.
    fn words(&self) -> Words;

    /// Why there is too little of it to say anything.
    fn shortage(&self) -> Option<PairDecision>;

    /// The similarity that it found, or why there is none.
    fn fit(&self) -> Result<&Fit, PairFault>;

    /// Why it does not agree with that similarity.
    fn disagreement(&self, fit: &Fit) -> Option<PairDecision>;

    /// What an affine map would explain; `None` where nothing is known of it.
    fn stretch(&self, fit: &Fit) -> Option<Stretch>;
}

pub(super) struct Words {
    pub holds: &'static str,
    pub counted: &'static str,
}

/// The affine map that fits best, against the similarity.
pub(super) struct Stretch {
    /// Ratio of its extreme stretches.
    pub ratio: f64,
    /// Share of the residual that it leaves.
    pub rest: f64,
}

/// `names` are the two parts'.
pub(super) fn decide(
    checks: &dyn PairChecks,
    tracks: &SharedTracks,
    names: [&str; 2],
    limits: &MergeLimits,
) -> PairDecision {
    if let Some(decision) = unsound(tracks, names, &limits.decision).or_else(|| checks.shortage()) {
        return decision;
    }
    let fit = match checks.fit() {
        Ok(fit) => fit,
        Err(fault) => return PairDecision::Rejected(fault),
    };
    checks
        .disagreement(fit)
        .or_else(|| stretched(&checks.stretch(fit)?, &limits.decision))
        .or_else(|| cameras(tracks, fit, checks.words().holds, &limits.decision))
        .or_else(|| freedoms(tracks, fit, checks.words().counted, &limits.decision))
        .unwrap_or(PairDecision::Accepted)
}

fn unsound(tracks: &SharedTracks, names: [&str; 2], limits: &PairDecisionLimits) -> Option<PairDecision> {
    let [of_a, of_b] = tracks.own_error;
    let (part, error_share) = if of_a >= of_b { (names[0].to_owned(), of_a) } else { (names[1].to_owned(), of_b) };
    (error_share > limits.own_error_share).then_some(PairDecision::Rejected(PairFault::Unsound { part, error_share }))
}

/// Refused where the mirror image of a part explains so many times more.
pub(super) fn mirrored(gain: f64, limits: &PairDecisionLimits) -> Option<PairDecision> {
    (gain > limits.mirror_gain).then_some(PairDecision::Rejected(PairFault::Mirrored))
}

/// Refused where an affine map explains what a similarity does not.
pub(super) fn stretched(stretch: &Stretch, limits: &PairDecisionLimits) -> Option<PairDecision> {
    let Stretch { ratio, rest } = *stretch;
    let is_stretched = ratio > limits.most_stretch && rest < limits.stretch_rest;
    is_stretched.then_some(PairDecision::Rejected(PairFault::Stretched { ratio }))
}

/// Refused where even the nearest of the shared cameras stands elsewhere than the similarity puts it.
fn cameras(tracks: &SharedTracks, fit: &Fit, holds: &'static str, limits: &PairDecisionLimits) -> Option<PairDecision> {
    let off = |camera: &CameraPair| {
        let turn_deg = (fit.a_from_b.rotation * camera.a_from_b_rotation.inverse()).angle().to_degrees();
        let off = fit.a_from_b.apply(&camera.center_b) - camera.center_a;
        let allowed = limits.most_shift * tracks.radius_a.max(camera.depth_a)
            + limits.shift_focal_doubts * camera.focal_doubt * camera.depth_a;
        (turn_deg, off.norm() / allowed)
    };
    let sum = |(turn_deg, shift): &(f64, f64)| turn_deg / limits.most_turn_deg + shift;
    let nearest = tracks.cameras.iter().map(off).min_by(|one, other| sum(one).total_cmp(&sum(other)));
    let (turn_deg, shift) = nearest?;
    let is_elsewhere = turn_deg > limits.most_turn_deg || shift > 1.0;
    is_elsewhere.then_some(PairDecision::Rejected(PairFault::CamerasElsewhere { holds, turn_deg, shift }))
}

/// Open where the loosest freedom is not held.
fn freedoms(
    tracks: &SharedTracks,
    fit: &Fit,
    counted: &'static str,
    limits: &PairDecisionLimits,
) -> Option<PairDecision> {
    let weakest = SymmetricEigen::new(fit.information).eigenvalues.min();
    let sigma_a = if weakest > 0.0 { weakest.sqrt().recip() } else { f64::INFINITY };
    let sigma = sigma_a / tracks.radius_a;
    let inliers = fit.inlier_count();
    (sigma > limits.determined).then_some(PairDecision::Open(PairFault::FreedomOpen { inliers, counted, sigma }))
}
