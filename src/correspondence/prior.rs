//! What is known of a pose before any data are looked at.
//!
//! Search, refinement and verdict ask it four things and nothing else: where a pose may lie ([`Prior::reaches`], [`Prior::reach`]),
//! what leaving the expected place costs ([`Prior::cost`]), what scale and place are expected under a given rotation
//! ([`Prior::scale_and_place`]), and how much it holds ([`Prior::information`]). Today there is one kind: a Gaussian about a start, whose
//! sigmas no more than cover the city. Others (a disc, camera positions, control points) answer the same questions.
//!
//! Frames: `level` is centred on the cloud, z up, in metres of the start; the city frame is its own local one.

use nalgebra::{Matrix4, Vector4};

use crate::geometry::{LEAST_SPREAD_M, Matrix3, Point3, Similarity, Start, StartSigmas, Vector3};
use crate::limits::Limits;
use crate::robust::{Matrix7, Motion, MotionParameters};

/// Whether the level frame's z may be taken for up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vertical {
    Known,
    /// The pose may lean as far as the start allows.
    Free,
}

/// How likely poses within reach are beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Density {
    /// About a start, which a pose pays for leaving.
    Gaussian,
    /// All alike: nothing speaks for the place about which they are reached.
    Uniform,
}

/// What is known of the pose, in the level frame: a Gaussian about a start, or no more than how far poses reach.
#[derive(Clone, Debug)]
pub struct Prior {
    /// Where the start puts the level frame's origin.
    pub center_in_city: Point3<f64>,
    /// Rigid where the scale is given: then it is one, in metres of the start.
    pub motion: Motion,
    /// Whether the level frame's z may be taken for up; else the tilt is as free as the start says.
    pub vertical: Vertical,
    sigmas: StartSigmas,
    reach_sigmas: f64,
    density: Density,
    cost_of_sigma_sq: f64,
    least_tilt_rad: f64,
}

/// A box of the city.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    pub low: Point3<f64>,
    pub high: Point3<f64>,
}

impl Reach {
    /// The box about both.
    pub fn with(&self, other: &Reach) -> Reach {
        Reach { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    #[inline]
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        (0..3).all(|k| self.low[k] <= p[k] && p[k] <= self.high[k])
    }
}

/// The extent of a cloud about its middle, metres of the start.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Horizontal, beyond which no more than stray points lie.
    pub radius_m: f64,
    pub bottom_m: f64,
    pub top_m: f64,
}

/// Slack round everything, metres.
const MARGIN_M: f64 = 2.0;

impl Prior {
    /// `center_in_city` is where the start puts the cloud's middle; `city` bounds what a sigma can mean.
    /// `radius_m`: of the cloud, metres of the start. No start is better than the model that it is compared with, which stands off its own
    /// coordinate system by more than a plane's error: with less than [`LEAST_SPREAD_M`] the right pose can lie beyond reach.
    pub fn new(
        start: &Start,
        center_in_city: Point3<f64>,
        radius_m: f64,
        motion: Motion,
        vertical: Vertical,
        city: Option<(Point3<f64>, Point3<f64>)>,
        limits: &Limits,
    ) -> Prior {
        Prior {
            center_in_city,
            motion,
            vertical,
            sigmas: bounded(&start.sigmas().at_least(LEAST_SPREAD_M, radius_m), &center_in_city, city),
            reach_sigmas: limits.reach_sigmas,
            density: Density::Gaussian,
            cost_of_sigma_sq: limits.prior_cost,
            least_tilt_rad: limits.least_tilt_rad,
        }
    }

    /// The same reach, within which no pose is likelier than another: where no start was given.
    pub fn uniform(self) -> Prior {
        Prior { density: Density::Uniform, ..self }
    }

    /// The pose that is expected.
    pub fn expected(&self) -> Similarity {
        Similarity { translation: self.center_in_city.coords, ..Similarity::identity() }
    }

    /// Whether a pose lies within reach in every freedom.
    pub fn reaches(&self, city_from_level: &Similarity) -> bool {
        let tilt = city_from_level.rotation.matrix()[(2, 2)].clamp(-1.0, 1.0).acos();
        tilt <= self.reach_sigmas * self.sigmas.tilt_rad.max(self.least_tilt_rad)
            && self.offsets(city_from_level).iter().all(|o| o.abs() <= self.reach_sigmas)
    }

    /// Whether a start speaks against a pose, by more than it reaches.
    pub fn rules_out(&self, city_from_level: &Similarity) -> bool {
        self.density == Density::Gaussian && !self.reaches(city_from_level)
    }

    /// What leaving the expected pose costs, in the unit of the score.
    pub fn cost(&self, city_from_level: &Similarity) -> f64 {
        self.cost_of_sigma_sq * self.sigmas_sq(city_from_level)
    }

    /// What is known beforehand for a pose against the expected one, bits: the logarithm of the density.
    pub fn bits(&self, city_from_level: &Similarity) -> f64 {
        -0.5 * std::f64::consts::LOG2_E * self.sigmas_sq(city_from_level)
    }

    fn sigmas_sq(&self, city_from_level: &Similarity) -> f64 {
        match self.density {
            Density::Gaussian => self.offsets(city_from_level).iter().map(|o| o * o).sum(),
            Density::Uniform => 0.0,
        }
    }

    /// How many sigmas a pose is from the expected one: heading, log scale, two horizontal axes, height.
    fn offsets(&self, city_from_level: &Similarity) -> [f64; 5] {
        let s = &self.sigmas;
        let shift = city_from_level.translation - self.center_in_city.coords;
        let any_heading = self.reach_sigmas * s.heading_rad >= std::f64::consts::PI;
        let heading = if any_heading { 0.0 } else { heading_of(city_from_level.rotation.matrix()) / s.heading_rad };
        [
            heading,
            city_from_level.scale.ln() / s.log_scale,
            shift.x / s.position_m,
            shift.y / s.position_m,
            shift.z / s.height_m,
        ]
    }

    /// How far the heading may be off, and how far up, radians.
    pub fn most_heading_rad(&self) -> f64 {
        self.reach_sigmas * self.sigmas.heading_rad
    }

    pub fn most_tilt_rad(&self) -> f64 {
        self.reach_sigmas * self.sigmas.tilt_rad
    }

    /// The largest scale within reach, relative to the start.
    pub fn most_scale(&self) -> f64 {
        match self.motion {
            Motion::Rigid => 1.0,
            Motion::Similarity => (self.reach_sigmas * self.sigmas.log_scale).exp(),
        }
    }

    /// How far a scene may spin about a direction of the city, one sigma: heading about up, tilt about level axes.
    pub fn spin_sigma_about(&self, axis: &Vector3<f64>) -> Vector3<f64> {
        axis * (axis.z * self.sigmas.heading_rad).hypot(axis.xy().norm() * self.sigmas.tilt_rad)
    }

    /// Mean and covariance of (scale, translation), whatever the rotation.
    pub fn scale_and_place(&self) -> (Vector4<f64>, Matrix4<f64>) {
        let StartSigmas { position_m, height_m, log_scale, .. } = self.sigmas;
        let scale_sigma = match self.motion {
            Motion::Rigid => 0.0,
            Motion::Similarity => log_scale,
        };
        let variances = Vector4::new(scale_sigma, position_m, position_m, height_m).map(|s| s * s);
        let c = self.center_in_city;
        (Vector4::new(1.0, c.x, c.y, c.z), Matrix4::from_diagonal(&variances))
    }

    /// The box that a cloud can come to lie in.
    pub fn reach(&self, cloud: &Extent) -> Reach {
        let grow = self.most_scale();
        let (bottom, top) = (cloud.bottom_m.min(0.0) * grow, cloud.top_m.max(0.0) * grow);
        let radius = cloud.radius_m * grow;
        // A scene that leans rises by what it is wide, and is wider by what it is high.
        let lean = if self.vertical == Vertical::Known {
            0.0
        } else {
            self.most_tilt_rad().min(std::f64::consts::FRAC_PI_2).sin()
        };
        let side = radius + lean * top.max(-bottom) + self.reach_sigmas * self.sigmas.position_m + MARGIN_M;
        let rise = lean * radius + self.reach_sigmas * self.sigmas.height_m + MARGIN_M;
        let c = self.center_in_city;
        Reach {
            low: Point3::new(c.x - side, c.y - side, c.z + bottom - rise),
            high: Point3::new(c.x + side, c.y + side, c.z + top + rise),
        }
    }

    /// Information in the motion's unknowns, 1 / m^2.
    pub fn information(&self, parameters: &MotionParameters) -> Matrix7 {
        let StartSigmas { position_m, height_m, heading_rad, tilt_rad, log_scale } = self.sigmas;
        let r = parameters.radius;
        let sigmas = [r * tilt_rad, r * tilt_rad, r * heading_rad, position_m, position_m, height_m, r * log_scale];
        Matrix7::from_diagonal(&sigmas.map(|s: f64| s.powi(-2)).into())
    }
}

/// The turn about up that is nearest to a rotation, radians.
pub fn heading_of(rotation: &Matrix3<f64>) -> f64 {
    (rotation[(1, 0)] - rotation[(0, 1)]).atan2(rotation[(0, 0)] + rotation[(1, 1)])
}

/// Where one sigma covers the whole city a larger one says no more, and would only spread the samples.
fn bounded(sigmas: &StartSigmas, center: &Point3<f64>, city: Option<(Point3<f64>, Point3<f64>)>) -> StartSigmas {
    let Some((low, high)) = city else { return *sigmas };
    let farthest = |k: usize| (center[k] - low[k]).abs().max((high[k] - center[k]).abs()) + MARGIN_M;
    StartSigmas {
        position_m: sigmas.position_m.min(farthest(0).hypot(farthest(1))),
        height_m: sigmas.height_m.min(farthest(2)),
        ..*sigmas
    }
}

#[cfg(test)]
mod tests;
