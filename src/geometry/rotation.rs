//! The rotation nearest to a matrix.

use nalgebra::{Matrix3, Rotation3};

/// The rotation nearest to a matrix that is one but for small errors: Newton's iteration for the polar factor, `R <- (R + R^-T) / 2`.
pub fn orthonormalised(matrix: &Matrix3<f64>) -> Rotation3<f64> {
    let mut r = *matrix;
    // Convergence is quadratic from an error of 1e-6: two steps reach rounding, the third costs nothing.
    for _ in 0..3 {
        if let Some(inverse) = r.try_inverse() {
            r = 0.5 * (r + inverse.transpose());
        }
    }
    Rotation3::from_matrix_unchecked(r)
}

/// The rotation nearest to any matrix (sum of squared differences): U diag(1, 1, det U V^T) V^T for U S V^T. `None` where the
/// numbers leave the finite.
pub fn nearest_rotation(matrix: &Matrix3<f64>) -> Option<Rotation3<f64>> {
    let svd = matrix.svd(true, true);
    let (mut u, v_t) = (svd.u?, svd.v_t?);
    if (u * v_t).determinant() < 0.0 {
        // nalgebra sorts the singular values, so the last column belongs to the smallest.
        u.column_mut(2).neg_mut();
    }
    let rotation = u * v_t;
    rotation.iter().all(|v| v.is_finite()).then(|| Rotation3::from_matrix_unchecked(rotation))
}

#[cfg(test)]
mod tests;
