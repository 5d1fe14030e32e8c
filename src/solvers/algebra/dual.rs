//! The dual basis of three vectors: what the inverse of a 3 x 3 matrix is, row by row.

use crate::geometry::Vector3;

/// The volume that three vectors span, with its sign.
#[inline]
pub fn volume([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    a.dot(&b.cross(c))
}

/// Vectors whose products with the three given ones are 1 with the one of the same place and 0 with the others: the x with
/// `v_k . x = h_k` is the sum of `h_k` times the k-th. The volume must not vanish.
#[inline]
pub fn dual_basis([a, b, c]: &[Vector3<f64>; 3], volume: f64) -> [Vector3<f64>; 3] {
    let inverse = volume.recip();
    [b.cross(c) * inverse, c.cross(a) * inverse, a.cross(b) * inverse]
}

#[cfg(test)]
mod tests;
