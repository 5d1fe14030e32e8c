//! A coarse similarity and how far it may be off: the prior of every search.

use std::f64::consts::PI;

use super::Similarity;

/// How far a start may be off, one sigma for each way in which it may be wrong. Offsets are about the image of the
/// reconstruction's centre, not about its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartSigmas {
    /// Horizontal, each of the two axes.
    pub position_m: f64,
    /// Along up.
    pub height_m: f64,
    /// Heading; pi means that nothing is known of it.
    pub heading_rad: f64,
    /// Of up, about each horizontal axis.
    pub tilt_rad: f64,
    /// Of the natural logarithm of the scale.
    pub log_scale: f64,
}

/// `city_from_sfm` roughly, with its sigmas: finite, above zero, no larger than a search can make use of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    city_from_sfm: Similarity,
    sigmas: StartSigmas,
}

/// Why numbers are no start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StartError {
    #[error("{name} is {value}; expected a finite number that is not negative")]
    NotASigma { name: &'static str, value: f64 },
    #[error("{name} is {value}; expected at most {most} ({why})")]
    TooLarge { name: &'static str, value: f64, most: f64, why: &'static str },
}

/// A sigma of zero says "exactly known". A search divides by it, so it is taken as this instead: far below what any
/// reconstruction resolves. Metres, radians and log scale alike. Chosen.
const SMALLEST_SIGMA: f64 = 1e-4;
/// A shift that leaves the Earth, metres: its circumference. A search is bounded by the city besides.
const LARGEST_SHIFT_M: f64 = 4e7;
/// One sigma of a factor of ten, three of a thousand: a scale less certain than this is unknown. Chosen.
const LARGEST_LOG_SCALE: f64 = std::f64::consts::LN_10;

impl Default for StartSigmas {
    /// The sigmas that hold where a start names none: a place clicked on a map, a compass, a guess at a step's length.
    fn default() -> Self {
        StartSigmas {
            position_m: 10.0,
            height_m: 3.0,
            heading_rad: 10f64.to_radians(),
            tilt_rad: 2f64.to_radians(),
            log_scale: 0.15,
        }
    }
}

/// No source is believed better than this, metres at the scene's radius: what a verdict calls determined. A city model stands off its own
/// coordinate system by decimetres, and better data shall be able to say something else than an earlier result.
pub const LEAST_SPREAD_M: f64 = 0.35;

impl StartSigmas {
    /// None smaller than a length at the scene's radius.
    pub fn at_least(&self, length_m: f64, radius_m: f64) -> StartSigmas {
        let share = length_m / radius_m.max(length_m);
        StartSigmas {
            position_m: self.position_m.max(length_m),
            height_m: self.height_m.max(length_m),
            heading_rad: self.heading_rad.max(share),
            tilt_rad: self.tilt_rad.max(share),
            log_scale: self.log_scale.max(share),
        }
    }
}

impl Start {
    /// A start with checked sigmas. Zero becomes a tenth of a millimetre (or of a milliradian); an angle beyond pi says no
    /// more than pi.
    pub fn new(city_from_sfm: Similarity, sigmas: StartSigmas) -> Result<Start, StartError> {
        let StartSigmas { position_m, height_m, heading_rad, tilt_rad, log_scale } = sigmas;
        let beyond_earth = "metres, once round the Earth";
        let beyond_factor = "natural logarithm, a factor of ten";
        let sigmas = StartSigmas {
            position_m: checked("position_sigma", position_m, LARGEST_SHIFT_M, beyond_earth)?,
            height_m: checked("height_sigma", height_m, LARGEST_SHIFT_M, beyond_earth)?,
            heading_rad: checked("rotation_sigma_deg", heading_rad, f64::MAX, "")?.min(PI),
            tilt_rad: checked("tilt_sigma_deg", tilt_rad, f64::MAX, "")?.min(PI),
            log_scale: checked("scale_sigma", log_scale, LARGEST_LOG_SCALE, beyond_factor)?,
        };
        Ok(Start { city_from_sfm, sigmas })
    }

    /// A start of the usual reliability.
    pub fn with_default_sigmas(city_from_sfm: Similarity) -> Start {
        Start { city_from_sfm, sigmas: StartSigmas::default() }
    }

    pub fn city_from_sfm(&self) -> &Similarity {
        &self.city_from_sfm
    }

    pub fn sigmas(&self) -> &StartSigmas {
        &self.sigmas
    }

    /// The same pose with other sigmas, taken as they are.
    pub(crate) fn with_sigmas(&self, sigmas: StartSigmas) -> Start {
        Start { sigmas, ..*self }
    }

    /// The same sigmas about another pose.
    pub fn about(&self, city_from_sfm: Similarity) -> Start {
        Start { city_from_sfm, ..*self }
    }
}

fn checked(name: &'static str, value: f64, most: f64, why: &'static str) -> Result<f64, StartError> {
    if !(value.is_finite() && value >= 0.0) {
        return Err(StartError::NotASigma { name, value });
    }
    if value > most {
        return Err(StartError::TooLarge { name, value, most, why });
    }
    Ok(value.max(SMALLEST_SIGMA))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(change: impl FnOnce(&mut StartSigmas)) -> Result<Start, StartError> {
        let mut sigmas = StartSigmas::default();
        change(&mut sigmas);
        Start::new(Similarity::identity(), sigmas)
    }

    #[test]
    fn a_sigma_of_zero_is_nearly_exact_and_no_division_by_zero() {
        let start = with(|s| (s.position_m, s.heading_rad, s.log_scale) = (0.0, 0.0, 0.0)).unwrap();
        let s = start.sigmas();
        assert!([s.position_m, s.heading_rad, s.log_scale].iter().all(|v| *v == SMALLEST_SIGMA));
    }

    #[test]
    fn sigmas_that_are_no_numbers_or_beyond_reason_are_refused_by_name() {
        for (change, name) in [
            ((|s| s.position_m = f64::NAN) as fn(&mut StartSigmas), "position_sigma"),
            (|s| s.position_m = 1e9, "position_sigma"),
            (|s| s.height_m = -1.0, "height_sigma"),
            (|s| s.height_m = f64::INFINITY, "height_sigma"),
            (|s| s.log_scale = 3.0, "scale_sigma"),
        ] {
            let message = with(change).unwrap_err().to_string();
            assert!(message.starts_with(name), "{message}");
        }
    }

    #[test]
    fn a_least_length_is_felt_at_the_radius_by_angles_and_scale() {
        let fine = StartSigmas { position_m: 0.01, height_m: 2.0, heading_rad: 0.0, tilt_rad: 0.1, log_scale: 1e-4 };
        let widened = fine.at_least(0.35, 70.0);
        assert_eq!((widened.position_m, widened.height_m), (0.35, 2.0));
        assert_eq!([widened.heading_rad, widened.tilt_rad, widened.log_scale], [0.005, 0.1, 0.005]);
        // A scene without extent is not divided by.
        assert_eq!(fine.at_least(0.35, 0.0).heading_rad, 1.0);
    }

    #[test]
    fn an_angle_beyond_half_a_turn_is_unknown() {
        let start = with(|s| (s.heading_rad, s.tilt_rad) = (1e308, 7.0)).unwrap();
        assert_eq!([start.sigmas().heading_rad, start.sigmas().tilt_rad], [PI, PI]);
    }
}
