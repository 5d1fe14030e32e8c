//! What goes into a merge: a reconstruction, what is seen in its photographs, and where it stands in a city.

use super::extent::Extent;
use crate::geometry::Similarity;
use crate::imagery::LiftedSuperpixels;
use crate::reconstruction::Reconstruction;
use crate::robust::{Matrix7, MotionParameters};
use crate::verdict::{Alignment, Freedom, Support, Verdict};

/// One of the reconstructions to be joined.
#[derive(Clone, Debug)]
pub struct Part {
    /// Unique among the parts.
    pub name: String,
    pub sfm: Reconstruction,
    /// Superpixels of the photographs that it shares with others, where labels or photographs were given.
    pub superpixels: Option<LiftedSuperpixels>,
    /// Where the part stands in a common frame already (a city's), and how far that is to be relied on.
    pub anchor: Option<Anchor>,
}

/// A part's place in a frame that all anchored parts share.
#[derive(Clone, Debug)]
pub struct Anchor {
    pub common_from_part: Similarity,
    /// The alignment's verdict: only where it says so is the place relied on.
    pub verdict: Verdict,
    /// Centre and radius that make the seven unknowns of `information` lengths, common frame.
    pub parameters: MotionParameters,
    /// Inverse of the alignment's covariance, in the motion's unknowns.
    pub information: Matrix7,
    /// What the alignment said.
    pub reason: String,
    pub freedoms: Vec<Freedom>,
    pub support: Support,
}

impl Anchor {
    pub fn is_determined(&self) -> bool {
        self.verdict == Verdict::Aligned
    }

    /// Where an alignment puts a part; `fallback` where it found nothing.
    pub fn of(alignment: &Alignment, sfm: &Reconstruction, fallback: Similarity) -> Anchor {
        let common_from_part = alignment.best_candidate.unwrap_or(fallback);
        let radius = common_from_part.scale * Extent::of(&sfm.points).radius;
        let parameters = MotionParameters::of_similarity(alignment.center, radius);
        // The report's covariance is in radians, metres and log scale.
        let lengths = Matrix7::from_diagonal(&[radius, radius, radius, 1.0, 1.0, 1.0, radius].into());
        let covariance = Matrix7::from_fn(|i, j| alignment.covariance[i][j]);
        Anchor {
            common_from_part,
            verdict: alignment.verdict,
            parameters,
            information: (lengths * covariance * lengths).try_inverse().unwrap_or_else(Matrix7::zeros),
            reason: format!("in the city {}: {}", alignment.verdict.word(), alignment.reason),
            freedoms: alignment.freedoms.clone(),
            support: alignment.support.clone(),
        }
    }
}
