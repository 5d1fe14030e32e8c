//! Whether two parts belong together at all: tests that are independent of the estimate, each with its reason in words.
//!
//! Input        what a kind of evidence answers ([`Testimony`]), and the poses of the shared photographs
//! Output       an [`Opinion`]
//! Method       both parts must be sound; there must be enough that chance does not explain; a similarity must be agreed on, and no mirror
//!              image or stretch explain more; the shared cameras must stand where it puts them; and every freedom must be held

use nalgebra::SymmetricEigen;

use super::fit::Fit;
use super::track_evidence::TrackEvidence;
use crate::merging::limits::{MergeLimits, PairJudgeLimits};

/// What is thought of a pair of parts.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::merging) enum Opinion {
    Together,
    /// They may belong together, but how is not fixed.
    Open(String),
    Apart(String),
}

/// What a kind of evidence answers to the judge.
pub(super) trait Testimony {
    /// What is said to hold a pose, and what it is counted in.
    fn words(&self) -> Words;

    /// Why it cannot be heard.
    fn lacking(&self) -> Option<Opinion>;

    /// The similarity that it found, or why there is none.
    fn fit(&self) -> Result<&Fit, String>;

    /// Why it does not agree with that similarity.
    fn refused(&self, fit: &Fit) -> Option<Opinion>;

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
pub(super) fn judge(
    testimony: &dyn Testimony,
    evidence: &TrackEvidence,
    names: [&str; 2],
    limits: &MergeLimits,
) -> Opinion {
    if let Some(opinion) = unsound(evidence, names, &limits.judge).or_else(|| testimony.lacking()) {
        return opinion;
    }
    let fit = match testimony.fit() {
        Ok(fit) => fit,
        Err(reason) => return Opinion::Apart(reason),
    };
    testimony
        .refused(fit)
        .or_else(|| stretched(&testimony.stretch(fit)?, &limits.judge))
        .or_else(|| cameras(evidence, fit, testimony.words().holds, &limits.judge))
        .or_else(|| freedoms(evidence, fit, testimony.words().counted, &limits.judge))
        .unwrap_or(Opinion::Together)
}

fn unsound(evidence: &TrackEvidence, names: [&str; 2], limits: &PairJudgeLimits) -> Option<Opinion> {
    let [of_a, of_b] = evidence.own_error;
    let (which, error) = if of_a >= of_b { (names[0], of_a) } else { (names[1], of_b) };
    (error > limits.own_error_share).then(|| {
        Opinion::Apart(format!(
            "{which} contradicts itself: its points miss its own keypoints by {:.1} % of the photograph's width",
            100.0 * error
        ))
    })
}

/// Refused where the mirror image of a part explains so many times more.
pub(super) fn mirrored(gain: f64, limits: &PairJudgeLimits) -> Option<Opinion> {
    (gain > limits.mirror_gain)
        .then(|| Opinion::Apart("one part is a mirror image of the other; only a reflection fits".to_owned()))
}

pub(super) fn stretched(stretch: &Stretch, limits: &PairJudgeLimits) -> Option<Opinion> {
    (stretch.ratio > limits.most_stretch && stretch.rest < limits.stretch_rest).then(|| {
        Opinion::Apart(format!(
            "one part is stretched by {:.0} % along one axis against the other; no similarity fits",
            100.0 * (stretch.ratio - 1.0)
        ))
    })
}

/// Where the nearest of the shared cameras stands, against the similarity.
fn cameras(evidence: &TrackEvidence, fit: &Fit, holds: &str, limits: &PairJudgeLimits) -> Option<Opinion> {
    let mut best: Option<(f64, f64)> = None;
    for camera in &evidence.cameras {
        let turn = (fit.a_from_b.rotation * camera.a_from_b_rotation.inverse()).angle().to_degrees();
        let off = fit.a_from_b.apply(&camera.center_b) - camera.center_a;
        let allowed = limits.most_shift * evidence.radius_a.max(camera.depth_a)
            + limits.shift_focal_doubts * camera.focal_doubt * camera.depth_a;
        let shift = off.norm() / allowed;
        if best.is_none_or(|(t, s)| turn / limits.most_turn_deg + shift < t / limits.most_turn_deg + s) {
            best = Some((turn, shift));
        }
    }
    let (turn, shift) = best?;
    (turn > limits.most_turn_deg || shift > 1.0).then(|| {
        Opinion::Apart(format!(
            "the shared photograph's two poses contradict the {holds} (turned by {turn:.1} deg, shifted by {shift:.1} \
             times what would be allowed)"
        ))
    })
}

fn freedoms(evidence: &TrackEvidence, fit: &Fit, counted: &str, limits: &PairJudgeLimits) -> Option<Opinion> {
    let weakest = SymmetricEigen::new(fit.information).eigenvalues.min();
    let sigma = if weakest > 0.0 { weakest.sqrt().recip() } else { f64::INFINITY };
    let share = sigma / evidence.radius_a;
    (share > limits.determined).then(|| {
        Opinion::Open(format!(
            "{} {counted} leave one freedom open to {:.2} % of the extent (one sigma); a further shared photograph would fix it",
            fit.inlier_count(),
            50.0 * share.min(1e4)
        ))
    })
}
