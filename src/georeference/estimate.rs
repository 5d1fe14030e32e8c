//! What every source becomes.

use super::extent::middle;
use crate::geometry::{Point3, Start};

/// Where a source says that a reconstruction stands.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// To absolute city coordinates.
    pub start: Start,
    /// Of the reconstruction, sfm frame: what the sigmas are about.
    pub middle: Point3<f64>,
    /// What it comes from, in words.
    pub source: String,
    /// What was tolerated, each kind once.
    pub warnings: Vec<String>,
    /// Control and check points, where the source has any.
    pub points: Vec<ControlPoint>,
}

impl Estimate {
    /// A start as it was given.
    pub fn given(start: Start, points: &[Point3<f64>], source: String) -> Estimate {
        Estimate { start, middle: middle(points), source, warnings: Vec::new(), points: Vec::new() }
    }
}

/// A point that is known in both frames.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPoint {
    pub name: String,
    pub use_of: ControlUse,
    pub in_sfm: Point3<f64>,
    /// Absolute city coordinates.
    pub in_city: Point3<f64>,
    /// Each axis, metres.
    pub sigma_m: f64,
}

/// What became of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlUse {
    Control,
    /// Kept out, to check the result.
    Check,
    /// Far from where the others put it.
    LeftOut,
}
