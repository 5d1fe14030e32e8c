//! Rotations as quadratic forms in a unit quaternion q = (w, x, y, z).

use crate::geometry::{Matrix3, Vector3};

pub type Quaternion = [f64; 4];

/// A quadratic form in q: the coefficients of the ten monomials.
pub type Quadric = [f64; 10];

/// Coordinates of the ten monomials, squares first.
pub const MONOMIALS: [(usize, usize); 10] =
    [(0, 0), (1, 1), (2, 2), (3, 3), (0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

/// Place of the monomial of coordinates i and j.
pub const PLACE: [[usize; 4]; 4] = [[0, 4, 5, 6], [4, 1, 7, 8], [5, 7, 2, 9], [6, 8, 9, 3]];

/// The ten monomials at q.
#[inline]
pub fn monomials(q: &Quaternion) -> [f64; 10] {
    let [w, x, y, z] = *q;
    [w * w, x * x, y * y, z * z, w * x, w * y, w * z, x * y, x * z, y * z]
}

/// The value of a quadratic form given by its ten coefficients.
#[inline]
pub fn value(coefficients: &Quadric, q: &Quaternion) -> f64 {
    let mono = monomials(q);
    (0..10).map(|j| coefficients[j] * mono[j]).sum()
}

/// R(q), homogeneous of degree 2; a rotation where |q| = 1.
#[inline]
pub fn rotation(q: &Quaternion) -> Matrix3<f64> {
    let [ww, xx, yy, zz, wx, wy, wz, xy, xz, yz] = monomials(q);
    Matrix3::new(
        ww + xx - yy - zz,
        2.0 * (xy - wz),
        2.0 * (xz + wy),
        2.0 * (xy + wz),
        ww - xx + yy - zz,
        2.0 * (yz - wx),
        2.0 * (xz - wy),
        2.0 * (yz + wx),
        ww - xx - yy + zz,
    )
}

/// The coefficients of n . R(q) p, read off R(q) entry by entry:
/// of ww it is n . p, of xx it is n_x p_x - n_y p_y - n_z p_z, of wx it is 2 (p x n)_x, of xy it is 2 (n_x p_y + n_y p_x).
#[inline]
pub fn form(n: &Vector3<f64>, p: &Vector3<f64>) -> Quadric {
    form_of(&(n * p.transpose()))
}

/// The same for a sum of such products n p^T.
#[inline]
pub fn form_of(b: &Matrix3<f64>) -> Quadric {
    let [x, y, z] = [b[(0, 0)], b[(1, 1)], b[(2, 2)]];
    [
        x + y + z,
        x - y - z,
        y - x - z,
        z - x - y,
        2.0 * (b[(2, 1)] - b[(1, 2)]),
        2.0 * (b[(0, 2)] - b[(2, 0)]),
        2.0 * (b[(1, 0)] - b[(0, 1)]),
        2.0 * (b[(0, 1)] + b[(1, 0)]),
        2.0 * (b[(0, 2)] + b[(2, 0)]),
        2.0 * (b[(1, 2)] + b[(2, 1)]),
    ]
}

/// Hamilton's product; R(a b) = R(a) R(b).
#[inline]
pub fn product(a: &Quaternion, b: &Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

#[cfg(test)]
mod tests;
