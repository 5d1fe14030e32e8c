//! How far apart two estimates are, in sigmas and in the scene, and how that is told.

use super::fit::Fit;
use crate::geometry::Similarity;
use crate::robust::Vector7;

/// Sources that differ by more than this many sigmas disagree: in seven unknowns chance gives 4.7 as rarely as three sigmas in one
/// (chi-square 21.8).
const DISAGREE_SIGMAS: f64 = 4.7;
/// A smaller difference than this share of the radius (0.15 % of the extent) is no matter: a freedom is called determined with it.
const DISAGREE_SHARE: f64 = 0.003;
const UNKNOWNS: f64 = 7.0;

/// The difference of two estimates of one pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart {
    /// Root of u^T H u, with u the difference in the seven unknowns and H the information of the first.
    pub sigmas: f64,
    /// Length of u as a share of the radius.
    pub share: f64,
}

/// `own` says by itself where the part is; `other` is another opinion.
pub(super) fn apart(own: &Fit, other: &Similarity) -> Apart {
    let motion = *other * own.a_from_b.inverse();
    let (center, radius) = (own.chart.center, own.chart.radius);
    let turn = motion.rotation.scaled_axis() * radius;
    let shift = motion.apply(&center) - center;
    let scale = motion.scale.ln() * radius;
    let unknowns = Vector7::from_column_slice(&[turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, scale]);
    let sigmas = unknowns.dot(&(own.information * unknowns)).max(0.0).sqrt();
    Apart { sigmas, share: unknowns.norm() / radius }
}

impl Apart {
    pub fn disagree(&self) -> bool {
        self.sigmas > DISAGREE_SIGMAS && self.share > DISAGREE_SHARE
    }

    /// How many times the variance must be greater for such a difference to be nothing special, at least 1 (Birge 1932).
    pub fn birge(&self) -> f64 {
        (self.sigmas * self.sigmas / UNKNOWNS).max(1.0)
    }

    /// "0.42 % of the extent (5.1 sigmas)"
    pub fn told(&self) -> String {
        format!("{:.2} % of the extent ({:.1} sigmas)", 50.0 * self.share, self.sigmas)
    }
}
