//! Rotations that lay a known axis of the sensor onto a known axis of the object: one angle is left.
//!
//! In axes (a, b, m) of the sensor and (c, e, n) of the object, both with the known axis as third, such a rotation is
//! R = Rot_z(theta) diag(1, sigma, sigma) with R m = sigma n, sigma = +-1. With y = coordinates of p and v = coordinates of a normal
//!
//! ```text
//! normal . R p = cos (v_x y_x + sigma v_y y_y) + sin (v_y y_x - sigma v_x y_y) + sigma v_z y_z,
//! ```
//!
//! so that an equation of the rotation is a line, and (cos, sin) a point of the unit circle on it (mathematics.md 4.1).

use crate::geometry::{Axes, Matrix3, Vector3};

use super::algebra::circle::on_circle;

/// The known axis as the third of three, in either frame.
#[derive(Clone, Copy, Debug)]
pub struct KnownAxis {
    pub sensor: Axes,
    pub object: Axes,
}

/// Whether the axes are laid onto each other, or one onto the other's opposite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    Along,
    Against,
}

impl Sense {
    pub const BOTH: [Sense; 2] = [Sense::Along, Sense::Against];

    #[inline]
    pub fn sigma(self) -> f64 {
        match self {
            Sense::Along => 1.0,
            Sense::Against => -1.0,
        }
    }
}

/// What a row says of `R p`: the parts that come with cos (without and with sigma), with sin (without and with sigma),
/// and with sigma alone. They may be added and multiplied like the rows themselves.
pub type Parts = [f64; 5];

/// A line `a cos + b sin + g = 0`.
pub type Line = [f64; 3];

/// One such rotation.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    pub cos: f64,
    pub sin: f64,
    pub sense: Sense,
}

impl KnownAxis {
    /// The parts of `normal . R point`.
    #[inline]
    pub fn parts(&self, normal: &[f64; 3], point: &[f64; 3]) -> Parts {
        let (v, y) = (normal, point);
        [v[0] * y[0], v[1] * y[1], v[1] * y[0], v[0] * y[1], v[2] * y[2]]
    }

    /// The same for a sum of products, `<n p^T, R>`.
    pub fn parts_of(&self, turning: &Matrix3<f64>) -> Parts {
        let (o, s) = (&self.object, &self.sensor);
        let product = |v: &Vector3<f64>, y: &Vector3<f64>| v.dot(&(turning * y));
        [product(&o.x, &s.x), product(&o.y, &s.y), product(&o.y, &s.x), product(&o.x, &s.y), product(&o.z, &s.z)]
    }

    #[inline]
    pub fn rotation(&self, turn: &Turn) -> Matrix3<f64> {
        let (o, s, sigma) = (&self.object, &self.sensor, turn.sense.sigma());
        let x = o.x * turn.cos + o.y * turn.sin;
        let y = (o.y * turn.cos - o.x * turn.sin) * sigma;
        x * s.x.transpose() + y * s.y.transpose() + (o.z * sigma) * s.z.transpose()
    }
}

/// The line that parts are for one sense of the axis.
#[inline]
pub fn line(parts: &[f64], sense: Sense) -> Line {
    let sigma = sense.sigma();
    [parts[0] + sigma * parts[1], parts[2] - sigma * parts[3], sigma * parts[4]]
}

/// The same with a constant beside them.
#[inline]
pub fn line_with(parts: &[f64], constant: f64, sense: Sense) -> Line {
    let [a, b, g] = line(parts, sense);
    [a, b, g + constant]
}

impl Turn {
    /// The turns on a line; `size_sq` is the square of the size that its first two coefficients have in general.
    #[inline]
    pub fn on([a, b, g]: Line, sense: Sense, size_sq: f64) -> impl Iterator<Item = Turn> {
        let (points, len) = on_circle(a, b, g, size_sq);
        (0..len).map(move |i| Turn { cos: points[i][0], sin: points[i][1], sense })
    }

    /// `normal . R p` from its parts.
    #[inline]
    pub fn along(&self, parts: &[f64]) -> f64 {
        let [a, b, g] = line(parts, self.sense);
        self.cos * a + self.sin * b + g
    }
}

#[cfg(test)]
mod tests;
