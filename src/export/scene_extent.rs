//! How far a scene reaches, and how the city frame becomes that of glTF.

use crate::geometry::{Point3, Vector3};

/// Share of the points left out at each end of an axis when the extent of the scene is taken: outliers lie far away.
const OUTLIER_SHARE: f64 = 0.02;
/// How far around the scene a large city is written, metres.
pub(super) const CITY_MARGIN_M: f64 = 300.0;

/// Box that holds nearly all points.
pub(super) struct Extent {
    pub low: Vector3<f64>,
    pub high: Vector3<f64>,
}

impl Extent {
    /// `points`: city frame.
    pub fn of_points(points: &[Point3<f64>]) -> Option<Extent> {
        let last = points.len().checked_sub(1)?;
        let (mut low, mut high) = (Vector3::zeros(), Vector3::zeros());
        for axis in 0..3 {
            let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
            let rank = (OUTLIER_SHARE * last as f64) as usize;
            low[axis] = *values.select_nth_unstable_by(rank, f64::total_cmp).1;
            high[axis] = *values.select_nth_unstable_by(last - rank, f64::total_cmp).1;
        }
        Some(Extent { low, high })
    }

    pub fn diagonal(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// True where a polygon's box comes within the margin, seen from above: a large floor may have all corners far off.
    pub fn is_near<'a>(&self, corners: impl Iterator<Item = &'a Point3<f64>> + Clone) -> bool {
        (0..2).all(|axis| {
            let (low, high) = (self.low[axis] - CITY_MARGIN_M, self.high[axis] + CITY_MARGIN_M);
            corners.clone().any(|corner| corner[axis] <= high) && corners.clone().any(|corner| corner[axis] >= low)
        })
    }
}

/// City frame to glTF's, single precision.
pub(super) fn turned(point: &Point3<f64>) -> [f32; 3] {
    [point.x as f32, point.z as f32, -point.y as f32]
}

/// glTF's vertex colours are linear (specification, 3.9.2), photographs are sRGB. 16 bits keep the dark tones.
pub(super) fn linear(srgb: [u8; 3]) -> [u16; 4] {
    let [r, g, b] = srgb.map(|v| {
        let v = f64::from(v) / 255.0;
        let linear = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
        (linear * f64::from(u16::MAX)).round() as u16
    });
    [r, g, b, u16::MAX]
}

#[cfg(test)]
mod tests;
