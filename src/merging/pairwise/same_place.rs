//! When two hypotheses of a search are one place.

use crate::geometry::{Point3, Similarity};
use crate::merging::pair_limits::PairSearchLimits;

pub(super) struct SamePlace<'a> {
    /// Middle of what is sought, in b.
    pub center_b: Point3<f64>,
    pub radius_a: f64,
    pub limits: &'a PairSearchLimits,
}

impl SamePlace<'_> {
    pub fn holds(&self, one: &Similarity, other: &Similarity) -> bool {
        let apart = (one.apply(&self.center_b) - other.apply(&self.center_b)).norm();
        apart < self.limits.same_shift * self.radius_a
            && (one.rotation.inverse() * other.rotation).angle() < self.limits.same_turn_rad
            && (one.scale / other.scale).ln().abs() < self.limits.same_log_scale
    }
}

#[cfg(test)]
mod tests;
