//! How far apart two estimates are, in sigmas and in the scene, and how that is told.

use super::fit::Fit;
use crate::geometry::Similarity;
use crate::merging::limits::MergeLimits;

/// The difference of two estimates of one pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference {
    /// Root of u^T H u, with u the difference in the seven unknowns and H the information of the first.
    pub sigmas: f64,
    /// Length of u as a share of the radius.
    pub share: f64,
    /// Unknowns that differ.
    unknowns: usize,
}

/// `own` says by itself where the part is; `other` is another decision.
pub(super) fn difference(own: &Fit, other: &Similarity) -> Difference {
    let unknowns = own.parameters.between(&own.a_from_b, other);
    let sigmas = unknowns.dot(&(own.information * unknowns)).max(0.0).sqrt();
    Difference { sigmas, share: unknowns.norm() / own.parameters.radius, unknowns: own.parameters.motion.unknowns() }
}

impl Difference {
    /// More than chance and more than matters.
    pub fn is_disagreement(&self, limits: &MergeLimits) -> bool {
        self.sigmas > limits.sources.disagree_sigmas && self.share > limits.decision.determined
    }

    /// How many times the variance must be greater for such a difference to be nothing special, at least 1 (Birge 1932).
    pub fn birge(&self) -> f64 {
        (self.sigmas * self.sigmas / self.unknowns as f64).max(1.0)
    }

    /// "0.42 % of the extent (5.1 sigmas)"
    pub fn told(&self) -> String {
        format!("{:.2} % of the extent ({:.1} sigmas)", 50.0 * self.share, self.sigmas)
    }
}

#[cfg(test)]
mod tests;
