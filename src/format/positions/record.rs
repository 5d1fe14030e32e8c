//! What all forms of positions have in common.

use super::frame::Frame;

/// The positions of one file, database or folder.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionsFile {
    /// In words, for reports: "EXIF GPS".
    pub format: &'static str,
    pub frame: Frame,
    pub positions: Vec<StoredPosition>,
    /// What was tolerated, each kind once.
    pub warnings: Vec<String>,
}

/// Where one photograph was taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StoredPosition {
    /// As the file names the photograph, with `/` between folders.
    pub name: String,
    /// East and north, or longitude and latitude in degrees; in the file's frame. `None` where only gravity is known.
    pub east_north: Option<[f64; 2]>,
    /// Metres.
    pub height_m: Option<f64>,
    /// One sigma of each horizontal axis and of the height, metres, where the file says so.
    pub sigma_m: Option<f64>,
    pub height_sigma_m: Option<f64>,
    /// Where gravity points in the camera's frame (x right, y down, z forward), any length.
    pub gravity_in_cam: Option<[f64; 3]>,
}

impl StoredPosition {
    pub(super) fn at(name: &str, east_north: [f64; 2], height_m: Option<f64>) -> StoredPosition {
        StoredPosition {
            name: name.replace('\\', "/"),
            east_north: Some(east_north),
            height_m,
            ..StoredPosition::default()
        }
    }
}

/// A sigma that a file gives, where it is one: zero says "unknown" with most programs.
pub(super) fn sigma(value: Option<f64>) -> Option<f64> {
    value.filter(|v| v.is_finite() && *v > 0.0)
}

/// Whether coordinates of a file that does not say so are degrees: no more than half a turn, and so near to each other that in metres no
/// camera would have moved.
pub(super) fn look_like_degrees(positions: &[StoredPosition]) -> bool {
    let places: Vec<[f64; 2]> = positions.iter().filter_map(|p| p.east_north).collect();
    let spread = |k: usize| {
        let (low, high) =
            places.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[k]), h.max(p[k])));
        high - low
    };
    let is_angle = |p: &[f64; 2]| p[0].abs() <= 180.0 && p[1].abs() <= 180.0 && p[0].abs().min(p[1].abs()) <= 90.0;
    let is_whole = |p: &[f64; 2]| p[0].fract() == 0.0 && p[1].fract() == 0.0;
    !places.is_empty()
        && places.iter().all(is_angle)
        && !places.iter().all(is_whole)
        && spread(0) < LARGEST_SPREAD_DEG
        && spread(1) < LARGEST_SPREAD_DEG
}

/// Chosen: a degree of latitude is 111 km, a capture has a few; a capture in metres has more than half a metre.
const LARGEST_SPREAD_DEG: f64 = 0.5;
