//! Gauss and Newton on all rows (mathematics.md section 11).
//!
//! At a pose with images x = s R p + t the row r_r = n_r . x + d_r changes by J_r (omega, tau, sigma) under R <- exp(omega) R,
//! t <- t + tau, s <- s exp(sigma), with J_r = [ s (R p) x n, n, s n . R p ]. Each step solves J delta = -r by singular values, takes
//! omega and sigma from it and then t anew, since t is linear. For as many rows as unknowns this is Newton's method.

use super::Sought;
use super::forms::Form;
use super::normalised::Normalised;
use super::singular::Singular;
use crate::geometry::{Matrix3, Rotation3, Vector3};

/// Steps; three are usual, a nearly double solution takes one for each bit.
const MOST_STEPS: usize = 40;

/// Largest turn of a step that still means to converge.
const ASTRAY_RAD: f64 = 0.5;

/// A step below which nothing more is to be gained.
const AT_REST: f64 = 1e-15;

/// Singular values below this, relative to the largest, carry no information.
const NO_INFORMATION: f64 = 1e-13;

/// A pose in normalised units.
pub(super) struct Fit {
    pub scale: f64,
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
    /// Largest absolute row.
    pub residual: f64,
}

/// From a rotation to the nearest pose that satisfies the rows; `None` where the numbers leave the finite.
pub(super) fn polish(problem: &Normalised, start: &Matrix3<f64>) -> Option<Fit> {
    let mut rotation = orthonormal(start);
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
        rotation = orthonormal(&(Rotation3::new(omega).into_inner() * best.rotation));
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
    let mut translation = -Vector3::from(problem.normals.least_squares(&along, NO_INFORMATION));
    let rest = |translation: &Vector3<f64>| -> Vec<f64> {
        problem.forms.iter().zip(&along).map(|(row, a)| a + row.normal.dot(translation)).collect()
    };
    // Once more on what is left: nearly coplanar normals lose digits in one solution.
    translation -= Vector3::from(problem.normals.least_squares(&rest(&translation), NO_INFORMATION));
    let residual = rest(&translation).iter().map(|r| r.abs()).fold(0.0, f64::max);
    (residual.is_finite() && scale.is_finite()).then_some(Fit { scale, rotation, translation, residual })
}

fn step(problem: &Normalised, fit: &Fit) -> (Vector3<f64>, f64) {
    // Of one point x on one plane n the product is x n^T, with x cross n beside its diagonal and n . x along it.
    let moved: Vec<(Vector3<f64>, Vector3<f64>, f64)> = problem
        .forms
        .iter()
        .map(|row| {
            let m = fit.scale * (fit.rotation * row.turning.transpose());
            let across = Vector3::new(m[(1, 2)] - m[(2, 1)], m[(2, 0)] - m[(0, 2)], m[(0, 1)] - m[(1, 0)]);
            (across, row.normal, m.trace())
        })
        .collect();
    let residual = |(row, m): (&Form, &(_, _, f64))| -(m.2 + row.normal.dot(&fit.translation) + row.offset);
    let right: Vec<f64> = problem.forms.iter().zip(&moved).map(residual).collect();
    let rows = moved.iter().copied();
    match &problem.sought {
        Sought::Rigid => {
            let x = solved(rows.map(|(t, n, _)| [t.x, t.y, t.z, n.x, n.y, n.z]), &right);
            (Vector3::new(x[0], x[1], x[2]), 0.0)
        }
        Sought::Similarity => {
            let x = solved(rows.map(|(t, n, s)| [t.x, t.y, t.z, n.x, n.y, n.z, s]), &right);
            (Vector3::new(x[0], x[1], x[2]), x[6])
        }
        Sought::UprightRigid(up) => {
            let u = up.in_object();
            let x = solved(rows.map(|(t, n, _)| [t.dot(&u), n.x, n.y, n.z]), &right);
            (u * x[0], 0.0)
        }
        Sought::UprightSimilarity(up) => {
            let u = up.in_object();
            let x = solved(rows.map(|(t, n, s)| [t.dot(&u), n.x, n.y, n.z, s]), &right);
            (u * x[0], x[4])
        }
    }
}

fn solved<const K: usize>(rows: impl Iterator<Item = [f64; K]>, right: &[f64]) -> [f64; K] {
    let rows: Vec<[f64; K]> = rows.collect();
    Singular::of(&rows).least_squares(right, NO_INFORMATION)
}

/// 1, or the scale that fits best with the translation free.
fn linear_scale(problem: &Normalised, rotation: &Matrix3<f64>) -> f64 {
    if !problem.sought.is_similarity() {
        return 1.0;
    }
    let right: Vec<f64> = problem.forms.iter().map(|row| -row.offset).collect();
    let rows = problem.forms.iter().map(|row| {
        let n = row.normal;
        [n.x, n.y, n.z, row.turning.dot(rotation)]
    });
    solved(rows, &right)[3]
}

/// The nearest rotation to a matrix that is one but for rounding: Newton's iteration for the polar factor.
fn orthonormal(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let mut rotation = *matrix;
    for _ in 0..2 {
        if let Some(inverse) = rotation.try_inverse() {
            rotation = 0.5 * (rotation + inverse.transpose());
        }
    }
    rotation
}
