//! Whether three quadrics meet in points alone, or in a curve besides.
//!
//! The quadrics times all quadratic monomials are a 30 x 35 matrix: its rank is 27 exactly where they meet in points alone. A
//! curve of common points makes the octic rounding noise, and noise may have no root; "no point" would then be the wrong answer.

use super::quaternion::{MONOMIALS, Quadric};
use super::singular::Singular;

/// Singular value, relative to the largest, below which the matrix has lost a rank.
const MACAULAY_RANK: f64 = 1e-12;

/// Whether three quadrics meet in points alone, in complex projective space.
pub fn meet_in_points(quadrics: &[Quadric; 3]) -> bool {
    let mut place = [[[[usize::MAX; 5]; 5]; 5]; 5];
    let mut count = 0;
    for a in 0..5 {
        for b in 0..5 - a {
            for c in 0..5 - a - b {
                place[a][b][c][4 - a - b - c] = count;
                count += 1;
            }
        }
    }
    // Columns of the transposed matrix: quadric times monomial; 35 rows, one for each monomial of degree 4.
    let mut rows = vec![[0.0; 30]; 35];
    for (k, quadric) in quadrics.iter().enumerate() {
        let size = quadric.iter().map(|v| v * v).sum::<f64>().sqrt();
        for (m, times) in MONOMIALS.iter().enumerate() {
            for (coefficient, of) in quadric.iter().zip(MONOMIALS) {
                let mut power = [0; 4];
                for i in [times.0, times.1, of.0, of.1] {
                    power[i] += 1;
                }
                let [a, b, c, d] = power;
                rows[place[a][b][c][d]][10 * k + m] += coefficient / size;
            }
        }
    }
    let sorted = Singular::of(&rows).sorted();
    sorted[26] > MACAULAY_RANK * sorted[0]
}

#[cfg(test)]
mod tests;
