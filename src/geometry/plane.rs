//! The plane `normal . x + offset = 0` with a unit normal on its outward side.

use nalgebra::{Point3, Vector3};

/// `normal . x + offset = 0`; `|normal| = 1`; `offset` in the unit of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub normal: Vector3<f64>,
    pub offset: f64,
}

impl Plane {
    /// The plane through `point` across `normal` (any length but zero); `None` where the normal has no direction.
    pub fn through(point: &Point3<f64>, normal: &Vector3<f64>) -> Option<Plane> {
        let unit = normal.try_normalize(f64::MIN_POSITIVE)?;
        let offset = -unit.dot(&point.coords);
        (unit.iter().all(|c| c.is_finite()) && offset.is_finite()).then_some(Plane { normal: unit, offset })
    }

    /// Signed distance, positive on the side that the normal points to; the frame's unit.
    pub fn signed_distance(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&point.coords) + self.offset
    }

    /// The point of the plane nearest to `point`.
    pub fn project(&self, point: &Point3<f64>) -> Point3<f64> {
        point - self.normal * self.signed_distance(point)
    }

    /// The same plane seen from its other side.
    pub fn flipped(&self) -> Plane {
        Plane { normal: -self.normal, offset: -self.offset }
    }
}

/// How the distance of a point from a plane with this normal changes with a motion: derivatives of `n . x + d` for
/// `x -> x + omega x y + tau + sigma y` by omega, tau and sigma: `(y x n, n, n . y)`.
#[inline]
pub fn distance_derivative(y: &Vector3<f64>, n: &Vector3<f64>) -> [f64; 7] {
    let turn = y.cross(n);
    [turn.x, turn.y, turn.z, n.x, n.y, n.z, n.dot(y)]
}

#[cfg(test)]
mod tests;
