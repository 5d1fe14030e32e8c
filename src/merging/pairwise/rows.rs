//! What the sources of a pose have in common: rows of normal equations, and misses.

use crate::geometry::{Point3, Similarity};
use crate::robust::{Matrix7, MotionParameters, NormalEquations};

/// Observations that hold the similarity `a_from_b`.
pub(super) trait Rows {
    /// Adds what they say at a pose, times a factor.
    fn add_rows(&self, a_from_b: &Similarity, parameters: &MotionParameters, factor: f64, sums: &mut NormalEquations);

    /// The part of that information which is only noise of the rows themselves, where they are measured and not given.
    fn noise(&self, _a_from_b: &Similarity, _parameters: &MotionParameters) -> Option<Matrix7> {
        None
    }
}

/// Rows that can be fitted by themselves. They bend: there is a deformation of the two parts against each other that no similarity takes
/// away, whose size is that which makes the median whitened residual what theory says.
pub(super) trait Source: Rows {
    /// Middle and size of what is observed, as it lies in a.
    fn parameters(&self, a_from_b: &Similarity) -> MotionParameters;

    /// Every observation against a pose.
    fn misses(&self, a_from_b: &Similarity) -> Vec<Miss>;

    /// What each piece of the scene says at a pose, weighted as among all.
    fn placed(&self, a_from_b: &Similarity, parameters: &MotionParameters) -> Vec<PlacedEquations>;

    /// Median size of a whitened residual.
    fn median_size(&self) -> f64;

    /// Share of a part's radius.
    fn bend(&self) -> f64;

    fn set_bend(&mut self, bend: f64);
}

/// An observation against a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Miss {
    /// Squared sigmas.
    pub whitened_sq: f64,
    /// Squared distance, a's units.
    pub distance_sq: f64,
}

/// Observations of one place.
pub(super) struct PlacedEquations {
    /// In a.
    pub place: Point3<f64>,
    pub sums: NormalEquations,
}
