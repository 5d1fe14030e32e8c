//! A coarse similarity and how far it may be off: the prior of every search.

use super::Similarity;

/// `city_from_sfm` roughly, with one sigma for each way in which it may be wrong. Offsets are about the image of the
/// reconstruction's centre, not about its origin. A search looks out to three sigmas and not beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    pub city_from_sfm: Similarity,
    /// Horizontal, each of the two axes.
    pub position_sigma_m: f64,
    /// Along up.
    pub height_sigma_m: f64,
    /// Heading; pi means that nothing is known of it.
    pub heading_sigma_rad: f64,
    /// Of up, about each horizontal axis.
    pub tilt_sigma_rad: f64,
    /// Of the natural logarithm of the scale.
    pub log_scale_sigma: f64,
}

impl Start {
    /// The sigmas that hold where a start file names none.
    pub fn with_default_sigmas(city_from_sfm: Similarity) -> Start {
        Start {
            city_from_sfm,
            position_sigma_m: 10.0,
            height_sigma_m: 3.0,
            heading_sigma_rad: 10f64.to_radians(),
            tilt_sigma_rad: 2f64.to_radians(),
            log_scale_sigma: 0.15,
        }
    }

    /// True where any heading is possible within three sigmas.
    pub fn heading_is_unknown(&self) -> bool {
        3.0 * self.heading_sigma_rad >= std::f64::consts::PI
    }
}
