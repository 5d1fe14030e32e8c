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
mod tests {
    use super::*;

    #[test]
    fn distance_is_positive_on_the_side_of_the_normal() {
        let plane = Plane::through(&Point3::new(0.0, 0.0, 2.0), &Vector3::new(0.0, 0.0, 5.0)).unwrap();
        assert_eq!(plane.signed_distance(&Point3::new(7.0, -3.0, 3.5)), 1.5);
        assert_eq!(plane.flipped().signed_distance(&Point3::new(7.0, -3.0, 3.5)), -1.5);
    }

    #[test]
    fn refuses_a_normal_without_direction() {
        assert!(Plane::through(&Point3::origin(), &Vector3::zeros()).is_none());
        assert!(Plane::through(&Point3::origin(), &Vector3::new(f64::NAN, 0.0, 1.0)).is_none());
    }
}
