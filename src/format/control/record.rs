//! What both forms of control points have in common.

use crate::format::positions::Frame;

/// The points of one file.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlFile {
    /// In words, for reports.
    pub format: &'static str,
    pub frame: Frame,
    pub points: Vec<StoredPoint>,
}

/// A point that is known in the city and seen in the reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredPoint {
    pub name: String,
    /// East and north, or longitude and latitude in degrees; in the file's frame.
    pub east_north: [f64; 2],
    /// Metres.
    pub height_m: f64,
    /// One sigma of each axis, metres, where the file says so.
    pub sigma_m: Option<f64>,
    pub role: PointRole,
    pub sight: PointSight,
}

/// What a point is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointRole {
    /// It places the reconstruction.
    Control,
    /// It is kept out, and its residual told.
    Check,
}

/// Where a point is in the reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub enum PointSight {
    /// Coordinates of the sfm frame.
    At([f64; 3]),
    /// Pixels (x right, y down, from the corner of the picture) in photographs, by their names.
    In(Vec<([f64; 2], String)>),
}
