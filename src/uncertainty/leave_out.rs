//! What the answer does when one building, or one building plane, is left out.
//!
//! Question     is the covariance as large as the answers scatter? Does a freedom rest on one building plane alone?
//! Method       the jackknife by building: the unknowns without each building in turn, and their scatter times the number of buildings less
//!              one. Where along some direction it is larger than the stated covariance, the information is made smaller by as
//!              much. It assumes nothing of how a building errs; what all of them share it cannot see. For building planes the information that is left
//!              is told as it is
//! Fails when   there are few buildings: then their scatter says little, and below a least number it is not asked
//! Source       Efron 1982; docs/mathematics.md 17.3

use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use super::elimination::{eliminate, inverse};
use super::rows::POSE;
use super::system::System;
use crate::robust::{Matrix7, Vector7};

/// By how much directions of the pose scatter more than stated.
pub(super) struct Scatter {
    /// Makes the stated covariance the identity, and back.
    whiten: Matrix7,
    color: Matrix7,
    /// In these terms: what information is multiplied by on both sides.
    shrink: Matrix7,
}

/// The scatter of the answers without each building.
pub(super) fn by_building(system: &System) -> Scatter {
    let count = system.parts.len();
    let stated = system.covariance.fixed_view::<POSE, POSE>(0, 0).into_owned();
    let Some(factor) = stated.cholesky().filter(|_| count >= system.limits.fewest_left_out) else {
        return Scatter::none();
    };
    let color = factor.l();
    let Some(whiten) = color.try_inverse() else { return Scatter::none() };
    let (total, n) = (system.total(), system.common);
    let given = inverse(system.covariance.clone()) - total.view((0, 0), (n, n));
    let without = |part: usize| -> Vector7 {
        let rest = &total - &system.parts[part].building.rest;
        let found = -(inverse(rest.view((0, 0), (n, n)) + &given) * rest.view((0, n), (n, 1)).column(0));
        whiten * found.fixed_rows::<POSE>(0)
    };
    let answers: Vec<Vector7> = (0..count).into_par_iter().map(without).collect();
    let mean = answers.iter().sum::<Vector7>() / count as f64;
    let squares: Matrix7 = answers.iter().map(|answer| (answer - mean) * (answer - mean).transpose()).sum();
    let eigen = SymmetricEigen::new(squares * ((count - 1) as f64 / count as f64));
    let factors = eigen.eigenvalues.map(|times| times.max(1.0).sqrt().recip());
    Scatter {
        whiten,
        color,
        shrink: eigen.eigenvectors * Matrix7::from_diagonal(&factors) * eigen.eigenvectors.transpose(),
    }
}

impl Scatter {
    fn none() -> Scatter {
        Scatter { whiten: Matrix7::identity(), color: Matrix7::identity(), shrink: Matrix7::identity() }
    }

    /// Information reduced to match the scatter of the jackknife.
    pub fn widened(&self, information: &Matrix7) -> Matrix7 {
        let white = self.color.transpose() * information * self.color;
        let wide = self.whiten.transpose() * self.shrink * white * self.shrink * self.whiten;
        (wide + wide.transpose()) / 2.0
    }
}

/// The pose's information without each building plane.
pub(super) fn by_building_plane(system: &System) -> Vec<Matrix7> {
    let total = system.total();
    let without = |part: usize, building_plane: usize| {
        let part = &system.parts[part];
        let whole: DMatrix<f64> = &part.whole - &part.building_planes[building_plane].rest;
        let rest = eliminate(&whole, system.common + 1, part.precision).rest;
        system.of_pose(&(&total - &part.building.rest + rest)).0
    };
    let building_planes =
        |part: usize| (0..system.parts[part].building_planes.len()).map(move |building_plane| (part, building_plane));
    let all: Vec<(usize, usize)> = (0..system.parts.len()).flat_map(building_planes).collect();
    all.into_par_iter().map(|(part, building_plane)| without(part, building_plane)).collect()
}
