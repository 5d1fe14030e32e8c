//! Right-handed orthonormal axes with a given third one.

use nalgebra::Vector3;

/// Three orthonormal right-handed axes; coordinates in them are `(v . x, v . y, v . z)`.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    pub x: Vector3<f64>,
    pub y: Vector3<f64>,
    pub z: Vector3<f64>,
}

impl Axes {
    /// Some axes whose third is the unit vector `z`. The branch keeps the divisor at 1 or above, so that no `z` is
    /// special; the two tangents follow without a square root (Duff et al. 2017).
    #[inline]
    pub fn about(z: &Vector3<f64>) -> Axes {
        let sign = if z.z < 0.0 { -1.0 } else { 1.0 };
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Axes {
            x: Vector3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: Vector3::new(b, sign + z.y * z.y * a, -z.y),
            z: *z,
        }
    }

    /// Those whose first lies across the coordinate axis that is most across the unit vector `z`: of a wall, one that is level and one that
    /// is upright, in which corners of the same height stay on one line to the last bit.
    pub fn along_coordinates(z: &Vector3<f64>) -> Axes {
        let mut across = Vector3::zeros();
        across[z.iamin()] = 1.0;
        let x = across.cross(z).normalize();
        Axes { x, y: z.cross(&x), z: *z }
    }

    #[inline]
    pub fn coordinates(&self, v: &Vector3<f64>) -> [f64; 3] {
        [self.x.dot(v), self.y.dot(v), self.z.dot(v)]
    }

    #[inline]
    pub fn vector(&self, x: f64, y: f64, z: f64) -> Vector3<f64> {
        self.x * x + self.y * y + self.z * z
    }
}

#[cfg(test)]
mod tests;
