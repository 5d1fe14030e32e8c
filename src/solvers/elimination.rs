//! Translation and scale out: what remains of the rows are equations of the rotation.
//!
//! ```text
//! Question    which equations the rows make for the rotation alone, and translation and scale once it is known
//! Input       rows as numbers: T for the unknowns of the translation | the offset | functions of the rotation. With along(R), linear
//!             in the latter, for what a row says of R p, each reads
//!                 normal part . translation + offset + scale along(R) = 0
//! Method      1. Householder's reflections, an orthogonal matrix from the left, make the first T columns upper triangular, the
//!                offset's column too where the scale is sought. The rows below are free of these unknowns.
//!             2. At a rotation the row that has lost the translation but not the offset gives the scale, and the first T rows
//!                give the translation, from the last to the first.
//!             An orthogonal matrix keeps rounding errors small whatever the planes, where the inverse of three chosen normals would
//!             not (mathematics.md 3.4, 12).
//! Fails when  the normals do not span what the translation is sought in: `None`
//! Source      Golub and Van Loan, Matrix Computations, 5.2; mathematics.md 2, 7
//! ```

use super::algebra::tolerance::RANK_TOLERANCE;

/// Whether the scale is an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// It is 1, and offsets are constants beside the rotation.
    Given,
    /// Offsets stand beside an unknown factor.
    Sought,
}

/// Rows whose first `T` columns are triangular.
pub struct Eliminated<const T: usize, const M: usize, const C: usize> {
    rows: [[f64; C]; M],
    scale: Scale,
}

impl<const T: usize, const M: usize, const C: usize> Eliminated<T, M, C> {
    /// `None` where the translation does not follow from the rows.
    #[inline(always)]
    pub fn new(mut rows: [[f64; C]; M], scale: Scale) -> Option<Self> {
        let unknowns = if scale == Scale::Sought { T + 1 } else { T };
        triangular(&mut rows, unknowns);
        Eliminated::triangular(rows, scale)
    }

    /// The same for rows that are triangular as they come.
    #[inline(always)]
    pub fn triangular(rows: [[f64; C]; M], scale: Scale) -> Option<Self> {
        let holds = (0..T).all(|k| rows[k][k].abs() > RANK_TOLERANCE);
        holds.then_some(Eliminated { rows, scale })
    }

    /// The last rows: the equations of the rotation. A given scale has left their offsets, in column `T`.
    #[inline(always)]
    pub fn equations<const E: usize>(&self) -> [&[f64; C]; E] {
        std::array::from_fn(|k| &self.rows[M - E + k])
    }

    /// Scale and translation at a rotation that satisfies the equations; `None` where the scale is not positive: a mirror image.
    #[inline(always)]
    pub fn scale_and_translation(&self, along: impl Fn(&[f64; C]) -> f64) -> Option<(f64, [f64; T])> {
        let scale = match self.scale {
            Scale::Given => 1.0,
            Scale::Sought => -self.rows[T][T] / along(&self.rows[T]),
        };
        if !(scale > 0.0) {
            return None;
        }
        let mut translation = [0.0; T];
        for i in (0..T).rev() {
            let row = &self.rows[i];
            let mut rest = row[T] + scale * along(row);
            for j in i + 1..T {
                rest += row[j] * translation[j];
            }
            translation[i] = -rest / row[i];
        }
        Some((scale, translation))
    }
}

/// Multiplies `rows` from the left by reflections until their first columns are upper triangular.
#[inline(always)]
pub fn triangular<const C: usize>(rows: &mut [[f64; C]], columns: usize) {
    // The last row has nothing below it to remove.
    for k in 0..columns.min(rows.len().saturating_sub(1)) {
        reflect(&mut rows[k..], k);
    }
}

/// Reflects the rows so that their column `k` vanishes below the first.
#[inline(always)]
fn reflect<const C: usize>(rows: &mut [[f64; C]], k: usize) {
    let square: f64 = rows.iter().map(|row| row[k] * row[k]).sum();
    if square == 0.0 {
        return;
    }
    let norm = square.sqrt();
    // The sign that adds, never subtracts, in the difference below: no cancellation.
    let diagonal = if rows[0][k] > 0.0 { -norm } else { norm };
    let weight = (square - diagonal * rows[0][k]).recip();
    // From here on column k holds the vector that the rows are reflected along.
    rows[0][k] -= diagonal;
    let mut along = [0.0; C];
    for row in rows.iter() {
        for j in 0..C {
            along[j] += row[k] * row[j];
        }
    }
    for row in rows.iter_mut() {
        let step = weight * row[k];
        for j in 0..C {
            row[j] -= step * along[j];
        }
        row[k] = 0.0;
    }
    rows[0][k] = diagonal;
}

#[cfg(test)]
mod tests;
