//! The two poses of one photograph as rows.
//!
//! Residuals    of the centre (T c_b - c_a) by its sigma: the bend all round, and along the view what the focal lengths leave open; of the
//!              turn the rotation vector of R R_ab^-1 by its sigma. T the pose, R its rotation, R_ab the camera's own a_from_b

use super::point_rows::MEDIAN_NORM;
use super::rows::Rows;
use super::shared_tracks::CameraPair;
use crate::geometry::{Matrix3, Similarity, Vector3};
use crate::merging::pair_limits::CameraFitLimits;
use crate::robust::{MotionParameters, NormalEquations, Vector7};

/// No bend is smaller than this share of a camera's depth where its centre is weighed: keeps the sigma from zero.
const LEAST_BEND: f64 = 1e-4;

pub(super) struct CameraRows<'a> {
    pub cameras: Vec<&'a CameraPair>,
    /// The pairs' bend, a's units.
    pub bend: f64,
    pub limits: &'a CameraFitLimits,
}

impl CameraRows<'_> {
    /// For each camera whether it agrees with a pose.
    pub fn agree(&self, a_from_b: &Similarity) -> Vec<bool> {
        let gate = self.limits.gate_medians * MEDIAN_NORM;
        let agrees = |camera: &&CameraPair| {
            let (center, turn) = self.residuals(camera, a_from_b);
            center.norm() < gate && turn.norm() < gate
        };
        self.cameras.iter().map(agrees).collect()
    }

    fn center_whitening(&self, camera: &CameraPair) -> Matrix3<f64> {
        let bend = self.bend.max(LEAST_BEND * camera.depth_a);
        let across = self.limits.center_bends * bend + self.limits.turn_sigma_rad * camera.depth_a;
        let along = across + camera.focal_doubt * camera.depth_a;
        let axis = camera.axis_a;
        let projector = axis * axis.transpose();
        (Matrix3::identity() - projector) / across + projector / along
    }

    fn turn_sigma_rad(&self, camera: &CameraPair) -> f64 {
        self.limits.turn_sigma_rad + self.limits.turn_per_focal_doubt * camera.focal_doubt
    }

    fn residuals(&self, camera: &CameraPair, a_from_b: &Similarity) -> (Vector3<f64>, Vector3<f64>) {
        let center = self.center_whitening(camera) * (a_from_b.apply(&camera.center_b) - camera.center_a);
        let turn = (a_from_b.rotation * camera.a_from_b_rotation.inverse()).scaled_axis() / self.turn_sigma_rad(camera);
        (center, turn)
    }
}

impl Rows for CameraRows<'_> {
    fn add_rows(&self, a_from_b: &Similarity, parameters: &MotionParameters, factor: f64, sums: &mut NormalEquations) {
        for camera in &self.cameras {
            let x = a_from_b.apply(&camera.center_b);
            let whitening = self.center_whitening(camera);
            let (center, turn) = self.residuals(camera, a_from_b);
            for k in 0..3 {
                sums.add(&parameters.row(&x, &whitening.row(k).transpose()), center[k], factor);
                let mut row = Vector7::zeros();
                row[k] = 1.0 / (parameters.radius * self.turn_sigma_rad(camera));
                sums.add(&row, turn[k], factor);
            }
        }
    }
}

#[cfg(test)]
mod tests;
