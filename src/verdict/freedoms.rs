//! Which of the seven freedoms the data fix, and how firmly.
//!
//! Input        the information that the data hold on the pose with all that errs together in model and reconstruction, the same without each
//!              of its witnesses, and that of the start
//! Method       eigenvectors of the information are the freedoms; a freedom is determined when the data alone hold it to within the accuracy
//!              that is asked for, and, no matter which witness is left out, to within a multiple of it. Its sigma includes the
//!              start, so that it is finite
//! Source       mathematics of the normalised Jacobian: Gelfand et al. (3DIM 2003) for the slippable motions of a surface

use super::{Freedom, words};
use crate::geometry::Vector3;
use crate::limits::VerdictLimits;
use crate::robust::{Chart, Matrix7, Motion, Vector7};

/// What holds a pose.
#[derive(Clone, Debug)]
pub struct Hold {
    pub chart: Chart,
    /// Information of the data, 1 / m^2 in the chart's unknowns.
    pub information: Matrix7,
    /// The same without each witness in turn.
    pub without: Vec<Matrix7>,
    /// Information of what is known beforehand.
    pub prior: Matrix7,
    /// The scale, where one was given. The chart's motion is rigid where it is held.
    pub given_scale: Option<GivenScale>,
    /// What a freedom must be held to, metres at the chart's radius.
    pub accuracy_m: f64,
    /// ... and how many times that without any one witness.
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
pub struct HeldDirection {
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

impl Hold {
    /// Whether the data tell a scale, and it is the given one.
    pub fn agrees_with_given_scale(&self, limits: &VerdictLimits) -> bool {
        let agrees = |s: GivenScale| s.bits >= limits.margin_bits() && !s.is_contradicted(self.chart.radius, limits);
        self.given_scale.is_some_and(agrees)
    }

    /// The freedoms that are not given, the loosest first.
    pub fn directions(&self) -> Vec<HeldDirection> {
        let spectrum = self.chart.spectrum(&self.information);
        let direction = |d: &crate::robust::Direction| {
            let along = |m: &Matrix7| d.unit.dot(&(m * d.unit)).max(0.0);
            let of_data = along(&self.information);
            let is_confirmed = || {
                let least = (self.confirmed_times * self.accuracy_m).powi(-2);
                self.without.iter().all(|m| along(m) >= least)
            };
            HeldDirection {
                unit: d.unit,
                sigma_m: (of_data + along(&self.prior)).sqrt().recip(),
                determined: of_data * self.accuracy_m * self.accuracy_m >= 1.0 && is_confirmed(),
            }
        };
        spectrum.directions().iter().map(direction).collect()
    }

    /// Covariance over (rotation vector about the centre, rad; translation of the centre, m; log scale).
    /// A scale that is given has none.
    pub fn covariance(&self) -> [[f64; 7]; 7] {
        let information = self.information + self.prior;
        let covariance = match self.chart.motion {
            Motion::Similarity => information.try_inverse().unwrap_or_else(Matrix7::zeros),
            Motion::Rigid => {
                let of_pose = information.fixed_view::<6, 6>(0, 0).into_owned().try_inverse();
                of_pose.map_or_else(Matrix7::zeros, |inverse| inverse.fixed_resize(0.0))
            }
        };
        let r = self.chart.radius;
        let unit = Vector7::from_column_slice(&[1.0 / r, 1.0 / r, 1.0 / r, 1.0, 1.0, 1.0, 1.0 / r]);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| unit[i] * (covariance[(i, j)] + covariance[(j, i)]) / 2.0 * unit[j])
        })
    }
}

/// The freedoms in words, the loosest first; a given scale that is held stands at the end.
pub fn freedoms(hold: &Hold, limits: &VerdictLimits) -> Vec<Freedom> {
    let r = hold.chart.radius;
    let in_words = |d: HeldDirection| {
        let part = |first: usize| Vector3::new(d.unit[first], d.unit[first + 1], d.unit[first + 2]);
        let (turn, shift, scale) = (part(0), part(3), d.unit[6]);
        let largest = turn.norm().max(shift.norm()).max(scale.abs());
        let (name, direction, sigma, unit) = if scale.abs() == largest {
            ("scale".to_owned(), Vector3::zeros(), d.sigma_m / r, "1")
        } else if shift.norm() == largest {
            (words::shift(&shift), upward(&shift), d.sigma_m, "m")
        } else {
            (words::turn(&turn), upward(&turn), (d.sigma_m / r).to_degrees(), "deg")
        };
        Freedom { name, direction, sigma, unit, determined: d.determined, given: false }
    };
    let held = hold.given_scale.filter(|_| hold.chart.motion == Motion::Rigid);
    let given = held.map(|scale| Freedom {
        name: "scale".to_owned(),
        direction: Vector3::zeros(),
        sigma: 0.0,
        unit: "1",
        determined: !scale.is_contradicted(r, limits),
        given: true,
    });
    hold.directions().into_iter().map(in_words).chain(given).collect()
}

/// The unit vector along `v` that points up, or east where level.
fn upward(v: &Vector3<f64>) -> Vector3<f64> {
    let unit = v.normalize();
    let sense = if unit.z.abs() > 1e-3 { unit.z } else { unit.x };
    if sense < 0.0 { -unit } else { unit }
}
