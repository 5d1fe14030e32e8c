//! Every number that decides how parts are joined, in one value that is handed down.
//!
//! Each says where it comes from: *derived* (from what), *measured on* (what), or *chosen* (why). Guards of arithmetic (steps of
//! numerical derivatives, rounds, convergence) stand beside the code that they guard. Lengths without a unit are shares of the radius
//! that holds 98 % of a part's points; half of such a share is one of the extent.

use super::pair_limits::{
    FitLimits, KeypointLimits, PairDecisionLimits, PairSearchLimits, SharedPlaneLimits, SourceLimits,
};
use crate::limits::{Limits, PatchLimits, VerdictLimits};
use crate::robust::{Motion, chi_square_beyond};

/// The numbers that decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergeLimits {
    /// The false alarms that are allowed, and what is asked of a freedom in a city.
    pub verdict: VerdictLimits,
    /// How patches are made of a part's points, and planes of its superpixels.
    pub patches: PatchLimits,
    pub keypoints: KeypointLimits,
    pub planes: SharedPlaneLimits,
    pub fit: FitLimits,
    pub search: PairSearchLimits,
    pub sources: SourceLimits,
    pub decision: PairDecisionLimits,
    pub network: NetworkLimits,
    pub fuse: FuseLimits,
}

/// How edges are held against each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkLimits {
    /// No edge is known better than this in any of the seven unknowns, one sigma: parts bend, which their covariances do not
    /// tell. Measured:
    /// parts that belong together err by up to 0.4 % of the extent, all unknowns together.
    pub edge_floor: f64,
    /// An edge further off than this many sigmas pulls no harder. Chosen: about what a cycle may miss by.
    pub pull_sigmas: f64,
    /// Surfaces that both parts see are not used where they lie further apart than this many floors. Derived: each part's own place in the
    /// city may be wrong by one.
    pub overlap_floors: f64,
}

/// What is one in the fused model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuseLimits {
    /// Parts bend against each other by about this; points of two parts are one within the gate of a fit. Chosen.
    pub bend: f64,
    /// A point of the other part that misses its keypoint in the fused photograph by more than this share of the width is not
    /// tied to it any longer. Chosen.
    pub far_from_keypoint_share: f64,
}

impl MergeLimits {
    /// A cycle that misses by more sigmas has a wrong edge in it: the root of the chi-square of seven freedoms that chance exceeds as
    /// rarely as the false alarms that are allowed (4.93 at one in a thousand).
    pub fn cycle_sigmas(&self) -> f64 {
        chi_square_beyond(Motion::Similarity.unknowns() as u32, self.verdict.false_alarm).sqrt()
    }

    /// Places that differ by less are one place, share of the radius: what one edge at its floor may miss by.
    pub fn same_place(&self) -> f64 {
        self.cycle_sigmas() * self.network.edge_floor
    }
}

/// Points of a part's patches. Derived: they tell all that there is to say, since those of one plane share its error.
const MOST_POINTS: usize = 10_000;

impl Default for MergeLimits {
    fn default() -> Self {
        let limits = Limits::default();
        MergeLimits {
            verdict: limits.verdict,
            patches: PatchLimits { most_points: MOST_POINTS, ..limits.patches },
            keypoints: KeypointLimits { same_share: 1e-3, same_px: 1.0, sigma_px: 1.0 },
            planes: SharedPlaneLimits::default(),
            fit: FitLimits::default(),
            search: PairSearchLimits::default(),
            sources: SourceLimits { disagree_sigmas: 4.7, on_plane: 4e-3, contradicted_share: 0.5, elsewhere: 0.05 },
            decision: PairDecisionLimits::default(),
            network: NetworkLimits { edge_floor: 5e-3, pull_sigmas: 5.0, overlap_floors: 2.0 },
            fuse: FuseLimits { bend: 3e-3, far_from_keypoint_share: 0.02 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_is_held_to_the_chi_square_of_seven_freedoms() {
        let mut limits = MergeLimits::default();
        assert!((limits.cycle_sigmas() - 4.93).abs() < 0.005, "{}", limits.cycle_sigmas());
        limits.verdict.false_alarm = 1e-6;
        assert!(limits.cycle_sigmas() > 6.0);
    }
}
