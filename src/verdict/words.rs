//! Directions and differences as a person says them.

use super::{Freedom, FreedomKind, FreedomUnit};
use crate::geometry::{Point3, Similarity, Vector3};

/// A direction nearer to up than this is called up, nearer to level than its complement is called level (cosines).
const UP_COS: f64 = 0.8;
const LEVEL_COS: f64 = 0.5;

/// "along up", "along the azimuth 31 deg".
pub fn shift(direction: &Vector3<f64>) -> String {
    let unit = direction.normalize();
    match unit.z.abs() {
        z if z > UP_COS => "along up".to_owned(),
        z if z < LEVEL_COS => format!("along the azimuth {:.0} deg", azimuth_deg(&unit)),
        _ => format!("along a slope towards the azimuth {:.0} deg", azimuth_deg(&unit)),
    }
}

/// "heading", "tilt about the azimuth 31 deg".
pub fn turn(axis: &Vector3<f64>) -> String {
    let unit = axis.normalize();
    if unit.z.abs() > UP_COS {
        "heading".to_owned()
    } else {
        format!("tilt about the azimuth {:.0} deg", azimuth_deg(&unit))
    }
}

/// Azimuth of a line, degrees from north (y) to east (x), 0 to 180.
fn azimuth_deg(unit: &Vector3<f64>) -> f64 {
    // Added to zero, which may be a negative one.
    0.0 + unit.x.atan2(unit.y).to_degrees().rem_euclid(180.0)
}

/// How `b` differs from `a`, both maps of the same cloud whose centre `a` puts at `center`.
pub fn difference(a: &Similarity, b: &Similarity, center: &Point3<f64>) -> String {
    let b_from_a = *b * a.inverse();
    let moved = b_from_a.apply(center);
    let shift = moved - center;
    let angle_deg = b_from_a.rotation.angle().to_degrees();
    let mut parts = Vec::new();
    if angle_deg >= 0.5 {
        let axis = b_from_a.rotation.axis().map_or(Vector3::z(), |axis| axis.into_inner());
        let about =
            if axis.z.abs() > UP_COS { "up".to_owned() } else { format!("the azimuth {:.0} deg", azimuth_deg(&axis)) };
        parts.push(format!("turned {angle_deg:.1} deg about {about} at ({:.1}, {:.1})", center.x, center.y));
    }
    if shift.norm() >= 0.05 {
        parts.push(format!("shifted by ({:.2}, {:.2}, {:.2}) m", shift.x, shift.y, shift.z));
    }
    let scale = 100.0 * (b_from_a.scale - 1.0);
    if scale.abs() >= 0.5 {
        parts.push(format!("scaled by {scale:+.1} %"));
    }
    if parts.is_empty() { "by less than 0.05 m and 0.5 deg".to_owned() } else { parts.join(", ") }
}

/// What would fix a freedom.
pub fn remedy(freedom: &Freedom) -> &'static str {
    let is_up = freedom.direction.z.abs() > UP_COS;
    match freedom.kind {
        FreedomKind::Shift if is_up => {
            "ground, a floor or a roof that the cameras saw and the city model has (--terrain) would fix it"
        }
        FreedomKind::Shift => "a crossing street or a wall that faces this way would fix it",
        FreedomKind::Turn if is_up => "a second wall across the first would fix it",
        FreedomKind::Turn => "ground or a wall in another direction would fix it",
        FreedomKind::Scale => "a known scale (--scale) or planes that do not meet in one point would fix it",
    }
}

/// The sigma of a freedom as a person reads it: scales in percent.
pub fn sigma(freedom: &Freedom) -> String {
    match freedom.unit {
        FreedomUnit::LogScale => format!("{:.2} %", 100.0 * freedom.sigma),
        unit => format!("{:.2} {}", freedom.sigma, unit.symbol()),
    }
}

#[cfg(test)]
mod tests;
