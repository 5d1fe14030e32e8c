//! A pose made ready to move many points.

use crate::geometry::{Matrix3, Point3, Similarity, Vector3};
use crate::planes::OrientedPoint;

/// A similarity multiplied out for many points.
pub struct Mover {
    scaled: Matrix3<f64>,
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

impl Mover {
    pub fn new(pose: &Similarity) -> Mover {
        let rotation = *pose.rotation.matrix();
        Mover { scaled: rotation * pose.scale, rotation, translation: pose.translation }
    }

    pub fn sample_point(&self, p: &OrientedPoint) -> OrientedPoint {
        OrientedPoint { position: self.place(p), normal: self.direction(p), ..*p }
    }

    #[inline]
    pub fn place(&self, p: &OrientedPoint) -> Point3<f64> {
        Point3::from(self.scaled * p.position.coords + self.translation)
    }

    #[inline]
    pub fn direction(&self, p: &OrientedPoint) -> Vector3<f64> {
        self.rotation * p.normal
    }
}

#[cfg(test)]
mod tests;
