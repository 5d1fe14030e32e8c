//! Gauss and Newton on all rows (mathematics.md section 11).
//!
//! At a pose with images x = s R p + t the row r_r = n_r . x + d_r changes by J_r (omega, tau, sigma) under R <- exp(omega) R,
//! t <- t + tau, s <- s exp(sigma), with J_r = [ s (R p) x n, n, s n . R p ]. Each step solves J delta = -r by singular values, takes
//! omega and sigma from it and then t anew, since t is linear. For as many rows as unknowns this is Newton's method.

use super::forms::Form;
use super::jacobian::{jacobian_of_sum, singular_of, turn_and_stretch};
use super::normalised::{NO_INFORMATION, Normalised};
use crate::geometry::{Matrix3, Rotation3, Vector3, orthonormalised};
use crate::solvers::algebra::singular::Singular;

/// Steps; three are usual, a nearly double solution takes one for each bit.
const MOST_STEPS: usize = 40;

/// Largest turn of a step that still means to converge.
const ASTRAY_RAD: f64 = 0.5;

/// A step below which nothing more is to be gained.
const AT_REST: f64 = 1e-15;

/// A pose in normalised units.
pub struct Fit {
    pub scale: f64,
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
    /// Largest absolute row.
    pub residual: f64,
}

/// From a rotation to the nearest pose that satisfies the rows; `None` where the numbers leave the finite.
pub fn polish(problem: &Normalised, start: &Matrix3<f64>) -> Option<Fit> {
    let mut rotation = orthonormalised(start).into_inner();
    let mut scale = linear_scale(problem, &rotation);
    if !(scale > 0.0) {
        return None;
    }
    let mut best = fit(problem, scale, rotation)?;
    for _ in 0..MOST_STEPS {
        let (omega, sigma) = step(problem, &best);
        if !(omega.norm() <= ASTRAY_RAD) {
            break;
        }
        rotation = orthonormalised(&(Rotation3::new(omega).into_inner() * best.rotation)).into_inner();
        if problem.sought.is_similarity() {
            scale = best.scale * sigma.clamp(-1.0, 1.0).exp();
        }
        let next = fit(problem, scale, rotation)?;
        let rest = omega.norm() + sigma.abs() < AT_REST;
        // Rounding makes the last steps wander: the best pose is kept.
        if next.residual > best.residual && omega.norm() + sigma.abs() < 1e-9 {
            break;
        }
        best = next;
        if rest {
            break;
        }
    }
    Some(best)
}

fn fit(problem: &Normalised, scale: f64, rotation: Matrix3<f64>) -> Option<Fit> {
    let along: Vec<f64> = problem.forms.iter().map(|row| scale * row.turning.dot(&rotation) + row.offset).collect();
    let mut translation = -problem.foot_of(&along);
    let rest = |translation: &Vector3<f64>| -> Vec<f64> {
        problem.forms.iter().zip(&along).map(|(row, a)| a + row.normal.dot(translation)).collect()
    };
    // Once more on what is left: nearly coplanar normals lose digits in one solution.
    translation -= problem.foot_of(&rest(&translation));
    let residual = rest(&translation).iter().map(|r| r.abs()).fold(0.0, f64::max);
    (residual.is_finite() && scale.is_finite()).then_some(Fit { scale, rotation, translation, residual })
}

/// Turn and logarithm of the scale that a Gauss-Newton step suggests.
fn step(problem: &Normalised, fit: &Fit) -> (Vector3<f64>, f64) {
    let images = problem.forms.iter().map(|row| fit.scale * (fit.rotation * row.turning.transpose()));
    let jacobian: Vec<_> = images.zip(&problem.forms).map(|(m, row)| jacobian_of_sum(&m, &row.normal)).collect();
    let right: Vec<f64> = problem
        .forms
        .iter()
        .zip(&jacobian)
        .map(|(row, derivative)| -(derivative[6] + row.normal.dot(&fit.translation) + row.offset))
        .collect();
    let unknowns = singular_of(&problem.sought, jacobian.into_iter()).least_squares(&right, NO_INFORMATION);
    turn_and_stretch(&problem.sought, &unknowns)
}

/// 1, or the scale that fits best with the translation free.
fn linear_scale(problem: &Normalised, rotation: &Matrix3<f64>) -> f64 {
    if !problem.sought.is_similarity() {
        return 1.0;
    }
    let right: Vec<f64> = problem.forms.iter().map(|row| -row.offset).collect();
    let columns = |row: &Form| [row.normal.x, row.normal.y, row.normal.z, row.turning.dot(rotation)];
    let rows: Vec<[f64; 4]> = problem.forms.iter().map(columns).collect();
    Singular::of(&rows).least_squares(&right, NO_INFORMATION)[3]
}

#[cfg(test)]
mod tests;
