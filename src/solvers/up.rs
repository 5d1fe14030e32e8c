//! The vertical, known in both frames.

use crate::geometry::{Axes, Matrix3, Vector3};

use super::turn::{KnownAxis, Sense, Turn};

/// The vertical in both frames, prepared once for many samples.
#[derive(Clone, Copy, Debug)]
pub struct Up {
    axis: KnownAxis,
}

impl Up {
    /// `None` where a vector has no direction. The vectors may have any length.
    pub fn new(sensor: &Vector3<f64>, object: &Vector3<f64>) -> Option<Up> {
        let unit = |v: &Vector3<f64>| {
            let scaled = v / v.amax();
            let unit = scaled.try_normalize(0.5)?;
            unit.iter().all(|c| c.is_finite()).then_some(unit)
        };
        Some(Up { axis: KnownAxis { sensor: Axes::about(&unit(sensor)?), object: Axes::about(&unit(object)?) } })
    }

    /// Unit vertical in the sensor frame.
    pub fn in_sensor(&self) -> Vector3<f64> {
        self.axis.sensor.z
    }

    /// Unit vertical in the object frame.
    pub fn in_object(&self) -> Vector3<f64> {
        self.axis.object.z
    }

    #[inline]
    pub(super) fn axis(&self) -> &KnownAxis {
        &self.axis
    }

    /// The turn by `(cos, sin)` about the vertical, after the verticals have been laid onto each other.
    #[inline]
    pub(super) fn rotation(&self, cos: f64, sin: f64) -> Matrix3<f64> {
        self.axis.rotation(&Turn { cos, sin, sense: Sense::Along })
    }
}
