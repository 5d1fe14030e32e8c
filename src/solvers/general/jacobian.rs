//! How rows change when a pose moves: their derivatives by the unknowns.
//!
//! The motion x -> x + omega x y + tau + sigma y of an image, y taken from some centre, changes the row n . x + d by
//! J (omega, tau, sigma) with J = (y x n, n, n . y) (mathematics.md 10.1, equation 14). For a known vertical u the first three become
//! one: (y x n) . u.

use super::forms::reduced;
use crate::geometry::{Matrix3, Vector3};
use crate::solvers::algebra::singular::Singular;
use crate::solvers::sought::Sought;

/// Rotation 3, translation 3, logarithm of the scale 1.
pub type Derivative = [f64; 7];

/// More rows than this are brought to triangular form before their singular values are taken: those of few are more exact without
/// it, those of many would take long.
const MANY_ROWS: usize = 64;

/// `geometry::distance_derivative` for a sum of products `m = y n^T`: y x n stands beside its diagonal and n . y along it.
pub fn jacobian_of_sum(m: &Matrix3<f64>, normal: &Vector3<f64>) -> Derivative {
    let n = normal;
    [m[(1, 2)] - m[(2, 1)], m[(2, 0)] - m[(0, 2)], m[(0, 1)] - m[(1, 0)], n.x, n.y, n.z, m.trace()]
}

/// Singular values of the columns that belong to what is sought.
pub fn singular_of(sought: &Sought, rows: impl Iterator<Item = Derivative>) -> Singular {
    let mut rows: Vec<Derivative> = rows.map(|row| in_unknowns(sought, row)).collect();
    if rows.len() > MANY_ROWS {
        rows = reduced(rows.into_iter());
    }
    let sought: Vec<&[f64]> = rows.iter().map(|row| &row[..sought.unknowns()]).collect();
    Singular::of(&sought)
}

/// The derivatives by what is sought, first of all.
fn in_unknowns(sought: &Sought, row: Derivative) -> Derivative {
    let [a, b, c, x, y, z, stretch] = row;
    match sought.up() {
        None => row,
        Some(up) => [Vector3::new(a, b, c).dot(&up.in_object()), x, y, z, stretch, 0.0, 0.0],
    }
}

/// Turn and logarithm of the scale from values of the unknowns.
pub fn turn_and_stretch(sought: &Sought, unknowns: &[f64]) -> (Vector3<f64>, f64) {
    let turn = match sought.up() {
        None => Vector3::new(unknowns[0], unknowns[1], unknowns[2]),
        Some(up) => up.in_object() * unknowns[0],
    };
    let stretch = if sought.is_similarity() { unknowns[sought.unknowns() - 1] } else { 0.0 };
    (turn, stretch)
}

#[cfg(test)]
mod tests;
