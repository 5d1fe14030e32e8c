//! What is known of scale and place while a sample is being drawn.
//!
//! Method       With the rotation known, scale and translation enter every row linearly, so what is known of them is one Gaussian: the
//!              prior at first, narrowed by each pair of a patch and a plane (a Kalman update).
//! Source       sequential gating of pairs: joint compatibility (Neira and Tardos 2001)

use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector4};

use super::prior::{Prior, Vertical};
use super::targets::{Bounds, Target};
use crate::geometry::{Plane, Point3, Vector3};
use crate::limits::Limits;
use crate::robust::Random;
use crate::solvers::Row;

/// Errors of a row that are not those of scale and translation.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowErrors {
    /// Error of the model and of a patch's centre.
    sigma_m: f64,
    /// What an uncertain rotation adds, per metre of distance from the middle of the cloud.
    sigma_per_m: f64,
    /// A pair whose distance is predicted better than this adds no information.
    informative_sigma_m: f64,
    /// Of the cloud.
    radius_m: f64,
    /// Gate of the prediction.
    reach_sigmas: f64,
}

/// An open direction that is all scale and hardly any translation cannot be written as a plane.
const SMALLEST_ACROSS: f64 = 1e-3;

/// Where a patch is expected under a belief.
pub(super) struct Expectation<'a> {
    belief: &'a ScaleTranslationEstimate,
    /// Of the patch's centre from the middle of the cloud, city directions.
    arm: Vector3<f64>,
    row_variance: f64,
    /// The box that holds its centre within three sigmas.
    pub bounds: Bounds,
}

impl Expectation<'_> {
    /// How likely the patch lies on the target, times the target's weight; `None` beyond three sigmas.
    #[inline]
    pub fn likelihood(&self, target: &Target) -> Option<f64> {
        // The patch's centre must be able to lie within the target's box.
        if !self.bounds.meets(&target.bounds) {
            return None;
        }
        let n = target.normal();
        let row = Vector4::new(n.dot(&self.arm), n.x, n.y, n.z);
        let residual = row.dot(&self.belief.mean) + target.offset();
        let variance = row.dot(&(self.belief.covariance * row)) + self.row_variance;
        let reach = self.belief.errors.reach_sigmas;
        let miss_sq = residual * residual / variance;
        (miss_sq <= reach * reach).then(|| f64::from(target.weight) * (-0.5 * miss_sq).exp())
    }
}

impl RowErrors {
    pub fn new(limits: &Limits, radius_m: f64) -> RowErrors {
        let reach_sigmas = limits.reach_sigmas;
        let limits = &limits.search;
        RowErrors {
            sigma_m: limits.row_sigma_m,
            sigma_per_m: limits.row_sigma_per_m,
            informative_sigma_m: limits.informative_sigma_m,
            radius_m,
            reach_sigmas,
        }
    }
}

/// What is known of scale and translation, given the rotation.
#[derive(Clone, Copy)]
pub(super) struct ScaleTranslationEstimate {
    /// Level frame to city directions.
    rotation: Matrix3<f64>,
    /// Whether it may be off about level axes too, and not only about up.
    leans: bool,
    /// A turn that is wholly open yet: its axis, with one sigma for length, radians.
    spin: Vector3<f64>,
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
    errors: RowErrors,
}

impl ScaleTranslationEstimate {
    /// What the prior says, given the rotation.
    pub fn new(prior: &Prior, rotation: Matrix3<f64>, errors: RowErrors) -> ScaleTranslationEstimate {
        let (mean, covariance) = prior.scale_and_place();
        ScaleTranslationEstimate {
            rotation,
            leans: prior.vertical == Vertical::Free,
            spin: Vector3::zeros(),
            mean,
            covariance,
            errors,
        }
    }

    /// The same of scale and place under another rotation.
    pub fn turned(&self, rotation: Matrix3<f64>) -> ScaleTranslationEstimate {
        ScaleTranslationEstimate { rotation, ..*self }
    }

    /// The same with a turn that is wholly open: its axis, with one sigma for length, radians.
    pub fn spinning(&self, spin: Vector3<f64>) -> ScaleTranslationEstimate {
        ScaleTranslationEstimate { spin, ..*self }
    }

    /// Level frame to city directions.
    pub fn turn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * v
    }

    /// Coefficients of a row: `row . (scale, translation) + offset = 0`.
    fn row(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> Vector4<f64> {
        Vector4::new(normal.dot(&self.turn(&point.coords)), normal.x, normal.y, normal.z)
    }

    pub fn variance(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let row = self.row(point, normal);
        row.dot(&(self.covariance * row))
    }

    /// Where a patch at `point` is expected.
    pub fn predict(&self, point: &Point3<f64>) -> Expectation<'_> {
        let arm = self.turn(&point.coords);
        let spun = self.spin.cross(&arm);
        let row_variance = self.row_variance(point);
        let slack = |k: usize| {
            let spread = self.covariance[(0, 0)] * arm[k] * arm[k]
                + 2.0 * self.covariance[(0, k + 1)] * arm[k]
                + self.covariance[(k + 1, k + 1)];
            self.errors.reach_sigmas * (spread.max(0.0) + spun[k] * spun[k] + row_variance).sqrt()
        };
        let slack = Vector3::new(slack(0), slack(1), slack(2));
        let expected = arm * self.mean[0] + self.mean.fixed_rows::<3>(1);
        Expectation {
            belief: self,
            arm,
            row_variance,
            bounds: Bounds::in_space(&(expected - slack), &(expected + slack)),
        }
    }

    /// Rows for the `missing` least known combinations of scale and translation, each at a value drawn evenly from the three
    /// sigmas that are left of it, and the chance that this meets the truth; `None` where the scale alone is open, which no plane
    /// can fix.
    pub fn completion(&self, missing: usize, random: &mut Random) -> Option<(Vec<Row>, f64)> {
        if missing == 0 {
            return Some((Vec::new(), 1.0));
        }
        // The scale counts by what it moves at the scene's radius, so that all four are metres and the unit changes nothing.
        let metres = Vector4::new(self.errors.radius_m, 1.0, 1.0, 1.0);
        let eigen =
            SymmetricEigen::new(Matrix4::from_diagonal(&metres) * self.covariance * Matrix4::from_diagonal(&metres));
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let mut chance = 1.0;
        let mut row = |k: &usize| {
            let sigma_m = eigen.eigenvalues[*k].max(0.0).sqrt();
            // Back to (scale, metres): v . (scale, translation) is the length that the eigenvector stands for.
            let v = eigen.eigenvectors.column(*k).component_mul(&metres);
            let value = v.dot(&self.mean) + sigma_m * self.errors.reach_sigmas * (2.0 * random.unit() - 1.0);
            // v . (scale, translation) = value is the row of a point p with n . R p = v[0] / |n| on the plane across n.
            let across = v.fixed_rows::<3>(1).into_owned();
            let length = across.norm();
            let normal = across.try_normalize(SMALLEST_ACROSS)?;
            chance *= (self.errors.informative_sigma_m / (self.errors.reach_sigmas * sigma_m)).min(1.0);
            Some(Row { point: self.unturn(&normal) * (v[0] / length), normal, offset: -value / length })
        };
        let rows: Option<Vec<Row>> = order[..missing.min(4)].iter().map(&mut row).collect();
        rows.map(|rows| (rows, chance))
    }

    /// City to level directions.
    fn unturn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(v)
    }

    /// What a row may be off besides scale and translation.
    fn row_variance(&self, point: &Point3<f64>) -> f64 {
        let arm_sq = if self.leans { point.coords.norm_squared() } else { point.coords.xy().norm_squared() };
        self.errors.sigma_m.powi(2) + self.errors.sigma_per_m.powi(2) * arm_sq
    }

    /// Kalman update with the row of a pair.
    pub fn learn(&mut self, point: &Point3<f64>, target: &Plane) {
        let row = self.row(point, &target.normal);
        let gain = self.covariance * row;
        let variance = row.dot(&gain) + self.row_variance(point);
        let residual = row.dot(&self.mean) + target.offset;
        self.mean -= gain * (residual / variance);
        self.covariance -= gain * gain.transpose() / variance;
    }
}

#[cfg(test)]
mod tests;
