//! The octic of three quadrics that are solved for Y^2, Z^2 and YZ, and the points that belong to its roots.
//!
//! The identities Z (Y^2) = Y (YZ), Y (Z^2) = Z (YZ) and (Y^2)(Z^2) = (YZ)^2 become three equations linear in (Y, Z, 1), whose
//! coefficients are polynomials in X : W. Their determinant is the octic; at a root (Y, Z, 1) spans the null space
//! (mathematics.md section 6).

use crate::geometry::Vector3;

use super::quaternion::Quaternion;

/// Product of polynomials in X : W, lowest power of X first; `P = N + M - 1`.
#[inline]
fn times<const N: usize, const M: usize, const P: usize>(a: &[f64; N], b: &[f64; M]) -> [f64; P] {
    let mut out = [0.0; P];
    for i in 0..N {
        for j in 0..M {
            out[i + j] += a[i] * b[j];
        }
    }
    out
}

#[inline]
fn sum<const N: usize, const T: usize>(terms: [[f64; N]; T]) -> [f64; N] {
    let mut out = [0.0; N];
    for term in terms {
        for i in 0..N {
            out[i] += term[i];
        }
    }
    out
}

#[inline]
fn minus<const N: usize>(a: [f64; N]) -> [f64; N] {
    a.map(|v| -v)
}

/// The 3 x 3 matrix that annihilates (Y, Z, 1); rows 1 and 2 have degrees (2, 2, 3), row 3 has (3, 3, 4).
pub struct Resultant {
    m11: [f64; 3],
    m12: [f64; 3],
    m13: [f64; 4],
    m21: [f64; 3],
    m23: [f64; 4],
    m31: [f64; 4],
    m32: [f64; 4],
    m33: [f64; 5],
}

impl Resultant {
    /// mathematics.md (11), line by line. The entry (2, 2) equals (1, 1).
    pub fn new(solved: &[[f64; 7]; 3]) -> Resultant {
        let linear = |row: &[f64; 7], k: usize| [row[2 * k + 1], row[2 * k]];
        let quadratic = |row: &[f64; 7]| [row[4], row[5], row[6]];
        let [a, b, c] = solved;
        let (a1, a2, a3) = (linear(a, 0), linear(a, 1), quadratic(a));
        let (b1, b2, b3) = (linear(b, 0), linear(b, 1), quadratic(b));
        let (c1, c2, c3) = (linear(c, 0), linear(c, 1), quadratic(c));
        let (n_c1, n_c2, n_c3) = (minus(c1), minus(c2), minus(c3));
        let alpha: [f64; 3] = sum([times(&a1, &b1), times(&n_c1, &c1)]);
        let beta: [f64; 3] = sum([times(&a2, &b2), times(&n_c2, &c2)]);
        let a2b1: [f64; 3] = times(&a2, &b1);
        let c1c2: [f64; 3] = times(&n_c1, &c2);
        let gamma: [f64; 3] = sum([times(&a1, &b2), a2b1, c1c2, c1c2]);
        // The last row's "- 2 c1 c3" and "+ gamma c1" join: (gamma - 2 c3) c1; likewise (alpha + b3) a1, (beta + a3) b1.
        let alpha_b3 = sum([alpha, b3]);
        let beta_a3 = sum([beta, a3]);
        let gamma_c3 = sum([gamma, n_c3, n_c3]);
        Resultant {
            m11: sum([a2b1, c1c2, n_c3]),
            m12: sum([times(&a1, &c2), beta_a3, times(&n_c1, &a2)]),
            m13: sum([times(&a1, &c3), times(&a2, &b3), times(&n_c1, &a3), times(&n_c2, &c3)]),
            m21: sum([alpha_b3, times(&b2, &c1), times(&n_c2, &b1)]),
            m23: sum([times(&b1, &a3), times(&b2, &c3), times(&n_c1, &c3), times(&n_c2, &b3)]),
            m31: sum([times(&alpha_b3, &a1), times(&beta_a3, &b1), times(&gamma_c3, &c1)]),
            m32: sum([times(&alpha_b3, &a2), times(&beta_a3, &b2), times(&gamma_c3, &c2)]),
            m33: sum([times(&alpha_b3, &a3), times(&beta, &b3), times(&sum([gamma, n_c3]), &c3)]),
        }
    }

    /// The determinant, by its last column.
    pub fn octic(&self) -> [f64; 9] {
        let Resultant { m11, m12, m13, m21, m23, m31, m32, m33 } = self;
        let first: [f64; 6] = sum([times(m21, m32), minus(times(m11, m31))]);
        let second: [f64; 6] = sum([times(m12, m31), minus(times(m11, m32))]);
        let third: [f64; 5] = sum([times(m11, m11), minus(times(m12, m21))]);
        sum([times(m13, &first), times(m23, &second), times(m33, &third)])
    }

    /// (Y, Z, X, W) at the root (X, W): the largest cross product of two rows is a multiple of (Y, Z, 1).
    pub fn null_vector(&self, root: &[f64; 2]) -> Quaternion {
        let [x, w] = *root;
        let cubic = |p: &[f64; 4]| p[0] * w * w * w + p[1] * x * w * w + p[2] * x * x * w + p[3] * x * x * x;
        let quadratic = |p: &[f64; 3]| p[0] * w * w + p[1] * x * w + p[2] * x * x;
        let quartic = |p: &[f64; 5]| quadratic(&[p[0], p[1], 0.0]) * w * w + quadratic(&[p[2], p[3], p[4]]) * x * x;
        let diagonal = quadratic(&self.m11);
        let rows = [
            Vector3::new(diagonal, quadratic(&self.m12), cubic(&self.m13)),
            Vector3::new(quadratic(&self.m21), diagonal, cubic(&self.m23)),
            Vector3::new(cubic(&self.m31), cubic(&self.m32), quartic(&self.m33)),
        ];
        let crosses = [rows[0].cross(&rows[1]), rows[1].cross(&rows[2]), rows[2].cross(&rows[0])];
        let mut v = crosses[0];
        for cross in &crosses[1..] {
            if cross.norm_squared() > v.norm_squared() {
                v = *cross;
            }
        }
        [v.x, v.y, x * v.z, w * v.z]
    }
}
