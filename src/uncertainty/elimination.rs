//! Taking unknowns out of normal equations, and putting them back in.
//!
//! Question     what is left to say of some unknowns when others, each about zero with a known spread, are free?
//! Method       Schur's complement of the others' block with their prior: with A = [K C; C' T], K - C (T + P)^-1 C'. This is what
//!              generalised least squares with their covariance says, without its matrix ever being built

use nalgebra::DMatrix;

/// Unknowns taken out.
#[derive(Clone, Debug)]
pub(super) struct Eliminated {
    /// Normal equations of those that stay.
    pub rest: DMatrix<f64>,
    /// Covariance of those taken out, were the others known.
    pub covariance: DMatrix<f64>,
    /// How the ones are felt in the others: rows of those that stay.
    pub coupling: DMatrix<f64>,
}

/// Takes the last unknowns out of `equations`, all but the first `keep`; each of them is zero to within `1 / precision`, squared.
pub(super) fn eliminate(equations: &DMatrix<f64>, keep: usize, precision: f64) -> Eliminated {
    let taken = equations.nrows() - keep;
    let mut block = equations.view((keep, keep), (taken, taken)).into_owned();
    (0..taken).for_each(|k| block[(k, k)] += precision);
    let covariance = inverse(block);
    let coupling = equations.view((0, keep), (keep, taken)).into_owned();
    let rest = equations.view((0, 0), (keep, keep)) - &coupling * &covariance * coupling.transpose();
    Eliminated { rest, covariance, coupling }
}

/// Inverse of a symmetric positive definite matrix. What is not (rounding, where nothing is known of an unknown) counts as unknown: zero
/// information has no covariance to hand on.
pub(super) fn inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let size = matrix.nrows();
    match matrix.cholesky() {
        Some(factor) => factor.inverse(),
        None => DMatrix::zeros(size, size),
    }
}

#[cfg(test)]
mod tests;
