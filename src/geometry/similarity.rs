//! Similarities `x_to = scale * rotation * x_from + translation`, named `to_from_from`.

use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

use super::rotation::orthonormalised;

/// How far a matrix may stray from orthonormal (largest entry of `R R^T - I`) and still be taken for a rotation that
/// was written with few digits.
const ROTATION_TOLERANCE: f64 = 1e-6;

/// `x_to = scale * rotation * x_from + translation`, with `scale > 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Units of the target frame per unit of the source frame.
    pub scale: f64,
    pub rotation: Rotation3<f64>,
    /// In units of the target frame.
    pub translation: Vector3<f64>,
}

/// Why numbers are no similarity.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotASimilarity {
    #[error("scale is {0}, expected a positive finite number")]
    Scale(f64),
    #[error("rotation is not orthonormal (R R^T differs from the identity by {0:.3e}, at most 1e-6 is allowed)")]
    NotOrthonormal(f64),
    #[error("rotation is a reflection (its determinant is -1, expected +1)")]
    Reflection,
    #[error("a coordinate is not finite")]
    NotFinite,
}

impl Similarity {
    pub fn identity() -> Similarity {
        Similarity { scale: 1.0, rotation: Rotation3::identity(), translation: Vector3::zeros() }
    }

    /// Checks the parts and makes the rotation exactly orthonormal (nearest rotation).
    pub fn try_new(
        scale: f64,
        rotation: Matrix3<f64>,
        translation: Vector3<f64>,
    ) -> Result<Similarity, NotASimilarity> {
        if !(scale.is_finite() && scale > 0.0) {
            return Err(NotASimilarity::Scale(scale));
        }
        if !rotation.iter().chain(translation.iter()).all(|v| v.is_finite()) {
            return Err(NotASimilarity::NotFinite);
        }
        let stray = (rotation * rotation.transpose() - Matrix3::identity()).amax();
        if stray > ROTATION_TOLERANCE {
            return Err(NotASimilarity::NotOrthonormal(stray));
        }
        if rotation.determinant() < 0.0 {
            return Err(NotASimilarity::Reflection);
        }
        Ok(Similarity { scale, rotation: orthonormalised(&rotation), translation })
    }

    /// The similarity that turns and scales about `pivot` (source frame) and sends it to `image`.
    pub fn about(pivot: &Point3<f64>, image: &Point3<f64>, scale: f64, rotation: Rotation3<f64>) -> Similarity {
        Similarity { scale, rotation, translation: image.coords - scale * (rotation * pivot.coords) }
    }

    pub fn apply(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.scale * (self.rotation * point.coords) + self.translation)
    }

    pub fn inverse(&self) -> Similarity {
        let rotation = self.rotation.inverse();
        let scale = self.scale.recip();
        Similarity { scale, rotation, translation: -(scale * (rotation * self.translation)) }
    }

    /// The same map into coordinates whose origin lies at `origin` of the present target frame.
    pub fn relative_to(&self, origin: &Vector3<f64>) -> Similarity {
        Similarity { translation: self.translation - origin, ..*self }
    }
}

impl std::ops::Mul for Similarity {
    type Output = Similarity;

    /// `a_from_c = a_from_b * b_from_c`
    fn mul(self, inner: Similarity) -> Similarity {
        Similarity {
            scale: self.scale * inner.scale,
            rotation: self.rotation * inner.rotation,
            translation: self.scale * (self.rotation * inner.translation) + self.translation,
        }
    }
}

#[cfg(test)]
mod tests;
