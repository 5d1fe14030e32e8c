//! Point pairs as rows: the same spot as both parts have it.
//!
//! Residual     W (T b - a), with a and b the spot in either part, T the pose and W the root of the information of a residual: the
//!              inverse of the two triangulations' covariances and the squared bend; in sigmas
//! Weights      Tukey's (Beaton and Tukey 1974); the bend does not average out, so pairs count at most as a fixed number of
//!              independent ones

use super::rows::{Miss, PlacedEquations, Rows, Source};
use super::shared_tracks::PointPair;
use crate::geometry::{Matrix3, Point3, Similarity, Vector3};
use crate::merging::pair_limits::FitLimits;
use crate::robust::{MotionParameters, NormalEquations, truncated_quadratic, tukey_weight};

/// Median of the norm of a whitened residual with three degrees of freedom (square root of the chi-square's 2.366).
pub(super) const MEDIAN_NORM: f64 = 1.538;

#[derive(Clone, Copy)]
pub(super) struct PointRows<'a> {
    pub pairs: &'a [PointPair],
    /// Radius of a, in its units.
    pub radius: f64,
    /// A share of the radius.
    pub bend: f64,
    pub limits: &'a FitLimits,
}

impl<'a> PointRows<'a> {
    /// With the bend that is taken before anything is known.
    pub fn new(pairs: &'a [PointPair], radius: f64, limits: &'a FitLimits) -> PointRows<'a> {
        PointRows { pairs, radius, bend: limits.first_bend, limits }
    }

    /// Lower Cholesky factor of a residual's information, transposed: rows whiten.
    fn whitening(&self, pair: &PointPair, a_from_b: &Similarity) -> Matrix3<f64> {
        let turn = a_from_b.rotation.matrix() * a_from_b.scale;
        let bend = self.bend * self.radius;
        let bend_sq = bend * bend;
        let covariance =
            pair.covariance_a + turn * pair.covariance_b * turn.transpose() + Matrix3::identity() * bend_sq;
        let information = covariance.try_inverse().unwrap_or_else(|| Matrix3::identity() / bend_sq);
        information.cholesky().map_or_else(|| Matrix3::identity() / bend, |c| c.l().transpose())
    }

    pub fn whitened(&self, pair: &PointPair, a_from_b: &Similarity) -> Vector3<f64> {
        self.whitening(pair, a_from_b) * (a_from_b.apply(&pair.in_b) - pair.in_a)
    }

    /// What of the pairs agrees with a pose.
    pub fn votes(&self, a_from_b: &Similarity) -> f64 {
        let gate = self.limits.gate_sigmas;
        self.pairs.iter().map(|pair| truncated_quadratic(self.whitened(pair, a_from_b).norm_squared(), gate)).sum()
    }

    /// Adds one pair; the robust weight that it got.
    fn add_pair(
        &self,
        pair: &PointPair,
        a_from_b: &Similarity,
        parameters: &MotionParameters,
        sums: &mut NormalEquations,
    ) -> f64 {
        let x = a_from_b.apply(&pair.in_b);
        let whitening = self.whitening(pair, a_from_b);
        let residual = whitening * (x - pair.in_a);
        let weight = tukey_weight(residual.norm_squared(), self.limits.gate_sigmas);
        for k in 0..3 {
            sums.add(&parameters.row(&x, &whitening.row(k).transpose()), residual[k], weight);
        }
        weight
    }
}

impl Rows for PointRows<'_> {
    fn add_rows(&self, a_from_b: &Similarity, parameters: &MotionParameters, factor: f64, sums: &mut NormalEquations) {
        let mut own = NormalEquations::default();
        let mut weights = 0.0;
        for pair in self.pairs {
            weights += self.add_pair(pair, a_from_b, parameters, &mut own);
        }
        sums.merge(&own, factor * (self.limits.independent / f64::max(weights, 1.0)).min(1.0));
    }
}

impl Source for PointRows<'_> {
    fn parameters(&self, a_from_b: &Similarity) -> MotionParameters {
        let sum = self.pairs.iter().map(|p| a_from_b.apply(&p.in_b).coords).sum::<Vector3<f64>>();
        MotionParameters::of_similarity(Point3::from(sum / self.pairs.len().max(1) as f64), self.radius)
    }

    fn misses(&self, a_from_b: &Similarity) -> Vec<Miss> {
        let miss = |pair: &PointPair| {
            let off = a_from_b.apply(&pair.in_b) - pair.in_a;
            let whitened = self.whitening(pair, a_from_b) * off;
            Miss { whitened_sq: whitened.norm_squared(), distance_sq: off.norm_squared() }
        };
        self.pairs.iter().map(miss).collect()
    }

    fn placed(&self, a_from_b: &Similarity, parameters: &MotionParameters) -> Vec<PlacedEquations> {
        let gate_sq = self.limits.gate_sigmas.powi(2);
        let inliers = self.misses(a_from_b).iter().filter(|m| m.whitened_sq < gate_sq).count();
        let factor = f64::max(inliers as f64 / self.limits.independent, 1.0).recip();
        let piece = |pair: &PointPair| {
            let (mut own, mut sums) = (NormalEquations::default(), NormalEquations::default());
            self.add_pair(pair, a_from_b, parameters, &mut own);
            sums.merge(&own, factor);
            PlacedEquations { place: pair.in_a, sums }
        };
        self.pairs.iter().map(piece).collect()
    }

    fn median_size(&self) -> f64 {
        MEDIAN_NORM
    }

    fn bend(&self) -> f64 {
        self.bend
    }

    fn set_bend(&mut self, bend: f64) {
        self.bend = bend;
    }
}

#[cfg(test)]
mod tests;
