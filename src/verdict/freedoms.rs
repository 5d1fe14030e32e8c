//! Which of the seven freedoms the data fix, and how firmly.
//!
//! Input        the information that the data hold on the pose with all that errs together in model and reconstruction, the same without each
//!              front of a building, and that of the start
//! Method       eigenvectors of the information are the freedoms; a freedom is determined when the data alone hold it to within the accuracy
//!              that is asked for, and, no matter which front is left out, to within a multiple of it. Its sigma includes the
//!              start, so that it is finite
//! Source       docs/mathematics.md 10.1 and 17.4; Gelfand et al. 2003 for the slippable motions of a surface

use super::{Freedom, FreedomKind, FreedomUnit, words};
use crate::geometry::Vector3;
use crate::limits::VerdictLimits;
use crate::robust::{Matrix7, Motion, MotionParameters, Vector7};

/// What holds a pose.
#[derive(Clone, Debug)]
pub struct PoseInformation {
    pub parameters: MotionParameters,
    /// Information of the data, 1 / m^2 in the motion's unknowns.
    pub information: Matrix7,
    /// The same without each front of a building in turn.
    pub without: Vec<Matrix7>,
    /// Information of what is known beforehand.
    pub prior: Matrix7,
    /// The scale, where one was given. The motion's motion is rigid where it is held.
    pub given_scale: Option<GivenScale>,
    /// What a freedom must be held to, metres at the motion's radius.
    pub accuracy_m: f64,
    /// How many times `accuracy_m` a freedom may be off without any one front of a building.
    pub confirmed_times: f64,
}

/// A scale that was given, beside that of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenScale {
    /// Metres per sfm unit.
    pub given: f64,
    /// What the data say with the scale free, metres per sfm unit.
    pub of_data: f64,
    /// One sigma of the logarithm of that; infinite where the data do not hold it.
    pub log_sigma: f64,
    /// Evidence of the pose with the scale free, bits.
    pub bits: f64,
}

/// A freedom in numbers.
#[derive(Clone, Debug)]
pub struct DirectionEstimate {
    /// Over (rotation, translation, log scale), each times the radius.
    pub unit: Vector7,
    /// With what is known beforehand, metres at the radius.
    pub sigma_m: f64,
    pub determined: bool,
}

impl GivenScale {
    /// Logarithm of the data's scale over the given one.
    pub fn log_off(&self) -> f64 {
        (self.of_data / self.given).ln()
    }

    /// Whether the data say another scale than the given one, for a scene of this radius.
    pub fn is_contradicted(&self, radius_m: f64, limits: &VerdictLimits) -> bool {
        let off = self.log_off().abs();
        off > limits.scale_sigmas * self.log_sigma && off * radius_m > limits.scale_m
    }
}

impl PoseInformation {
    /// Whether the data tell a scale, and it is the given one.
    pub fn agrees_with_given_scale(&self, limits: &VerdictLimits) -> bool {
        let agrees =
            |s: GivenScale| s.bits >= limits.margin_bits() && !s.is_contradicted(self.parameters.radius, limits);
        self.given_scale.is_some_and(agrees)
    }

    /// The freedoms that are not given, the loosest first.
    pub fn directions(&self) -> Vec<DirectionEstimate> {
        let spectrum = self.parameters.spectrum(&self.information);
        let all = self.with_prior(&self.information);
        let without: Vec<Posterior> = self.without.iter().map(|information| self.with_prior(information)).collect();
        let direction = |d: &crate::robust::Direction| {
            let of_data = along(&self.information, &d.unit);
            let most_m = self.confirmed_times * self.accuracy_m;
            let is_confirmed = |information: &Matrix7, posterior: &Posterior| {
                along(information, &d.unit) * most_m * most_m >= 1.0 && posterior.sigma_along(&d.unit) <= most_m
            };
            let mut left_out = self.without.iter().zip(&without);
            DirectionEstimate {
                unit: d.unit,
                sigma_m: all.sigma_along(&d.unit),
                determined: of_data * self.accuracy_m * self.accuracy_m >= 1.0
                    && left_out.all(|(information, posterior)| is_confirmed(information, posterior)),
            }
        };
        spectrum.directions().iter().map(direction).collect()
    }

    /// What is known with such information of the data and what is known beforehand.
    fn with_prior(&self, information: &Matrix7) -> Posterior {
        let information = information + self.prior;
        let covariance = match self.parameters.motion {
            Motion::Similarity => information.try_inverse(),
            Motion::Rigid => {
                let of_pose = information.fixed_view::<6, 6>(0, 0).into_owned().try_inverse();
                of_pose.map(|inverse| inverse.fixed_resize(0.0))
            }
        };
        Posterior { information, covariance }
    }

    /// Covariance over (rotation vector about the centre, rad; translation of the centre, m; log scale).
    /// A scale that is given has none.
    pub fn covariance(&self) -> [[f64; 7]; 7] {
        let covariance = self.with_prior(&self.information).covariance.unwrap_or_else(Matrix7::zeros);
        let r = self.parameters.radius;
        let unit = Vector7::from_column_slice(&[1.0 / r, 1.0 / r, 1.0 / r, 1.0, 1.0, 1.0, 1.0 / r]);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| unit[i] * (covariance[(i, j)] + covariance[(j, i)]) / 2.0 * unit[j])
        })
    }
}

/// Information and its inverse, in the motion's unknowns, 1 / m^2 and m^2; a scale that is given has no variance.
struct Posterior {
    information: Matrix7,
    covariance: Option<Matrix7>,
}

impl Posterior {
    /// One sigma along a direction, whatever the others are, metres. Where the information is singular, with the others held.
    fn sigma_along(&self, unit: &Vector7) -> f64 {
        let held = along(&self.information, unit).sqrt().recip();
        self.covariance.as_ref().map_or(held, |covariance| along(covariance, unit).sqrt().max(held))
    }
}

fn along(matrix: &Matrix7, unit: &Vector7) -> f64 {
    unit.dot(&(matrix * unit)).max(0.0)
}

/// The freedoms in words, the loosest first; a given scale that is held stands at the end.
pub fn freedoms(hold: &PoseInformation, limits: &VerdictLimits) -> Vec<Freedom> {
    let r = hold.parameters.radius;
    let in_words = |d: DirectionEstimate| {
        let part = |first: usize| Vector3::new(d.unit[first], d.unit[first + 1], d.unit[first + 2]);
        let (turn, shift, scale) = (part(0), part(3), d.unit[6]);
        let largest = turn.norm().max(shift.norm()).max(scale.abs());
        let determined = d.determined;
        if scale.abs() == largest {
            Freedom { determined, ..scale_freedom(d.sigma_m / r) }
        } else if shift.norm() == largest {
            let (kind, unit) = (FreedomKind::Shift, FreedomUnit::Metre);
            let (name, direction) = (words::shift(&shift), upward(&shift));
            Freedom { kind, name, direction, sigma: d.sigma_m, unit, determined, given: false }
        } else {
            let (kind, unit) = (FreedomKind::Turn, FreedomUnit::Degree);
            let (name, direction) = (words::turn(&turn), upward(&turn));
            Freedom { kind, name, direction, sigma: (d.sigma_m / r).to_degrees(), unit, determined, given: false }
        }
    };
    let held = hold.given_scale.filter(|_| hold.parameters.motion == Motion::Rigid);
    let given =
        held.map(|scale| Freedom { determined: !scale.is_contradicted(r, limits), given: true, ..scale_freedom(0.0) });
    hold.directions().into_iter().map(in_words).chain(given).collect()
}

fn scale_freedom(log_sigma: f64) -> Freedom {
    Freedom {
        kind: FreedomKind::Scale,
        name: "scale".to_owned(),
        direction: Vector3::zeros(),
        sigma: log_sigma,
        unit: FreedomUnit::LogScale,
        determined: false,
        given: false,
    }
}

/// The unit vector along `v` that points up, or east where level.
fn upward(v: &Vector3<f64>) -> Vector3<f64> {
    let unit = v.normalize();
    let sense = if unit.z.abs() > 1e-3 { unit.z } else { unit.x };
    if sense < 0.0 { -unit } else { unit }
}
