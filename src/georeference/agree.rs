//! Several estimates of one place: held against each other, then put together.
//!
//! Method       both say where the reconstruction's middle is, how it is turned and how large it is; each difference is compared with the sigmas
//!              of both. What agrees is averaged by information (one over variance), freedom by freedom.

use super::GeoreferenceError;
use super::estimate::Estimate;
use crate::geometry::{Point3, Rotation3, Similarity, Start, StartSigmas, Vector3};

/// Differences beyond so many sigmas of both are no chance: six in a hundred thousand of one freedom.
const MOST_SIGMAS: f64 = 4.0;

/// One estimate from all; `None` of none. The sigmas of a freedom are at most those of each.
pub fn agreed(estimates: Vec<Estimate>) -> Result<Option<Estimate>, GeoreferenceError> {
    let mut estimates = estimates.into_iter();
    let Some(mut all) = estimates.next() else { return Ok(None) };
    for next in estimates {
        all = both(all, next)?;
    }
    Ok(Some(all))
}

/// What turns and moves the first estimate into the second.
struct Difference {
    /// Of the middle, metres.
    shift: Vector3<f64>,
    /// About level axes and about up, radians.
    turn: Vector3<f64>,
    log_scale: f64,
}

fn both(a: Estimate, b: Estimate) -> Result<Estimate, GeoreferenceError> {
    let difference = Difference::between(&a, &b);
    let told = difference.told(a.start.sigmas(), b.start.sigmas());
    if !told.is_empty() {
        let (first, second) = (a.source, b.source);
        return Err(GeoreferenceError::Disagreement { first, second, differs: told.join(", ") });
    }
    let start = difference
        .averaged(&a, &b)
        .map_err(|error| GeoreferenceError::Start { source_name: b.source.clone(), error })?;
    let mut points = a.points;
    points.extend(b.points);
    let warnings = a.warnings.into_iter().chain(b.warnings).collect();
    Ok(Estimate { start, middle: a.middle, source: format!("{}; {}", a.source, b.source), warnings, points })
}

impl Difference {
    fn between(a: &Estimate, b: &Estimate) -> Difference {
        let (from, to) = (a.start.city_from_sfm(), b.start.city_from_sfm());
        let turn = to.rotation * from.rotation.inverse();
        let heading_rad = heading(&turn);
        let tilt = Rotation3::from_axis_angle(&Vector3::z_axis(), -heading_rad) * turn;
        let tilt = tilt.scaled_axis();
        Difference {
            shift: to.apply(&a.middle) - from.apply(&a.middle),
            turn: Vector3::new(tilt.x, tilt.y, heading_rad),
            log_scale: (to.scale / from.scale).ln(),
        }
    }

    /// What differs by more than the sigmas allow, in words.
    fn told(&self, a: &StartSigmas, b: &StartSigmas) -> Vec<String> {
        let mut told = Vec::new();
        let mut compare = |what: &str, by: f64, sigmas: [f64; 2], say: fn(f64) -> String| {
            let sigma = sigmas[0].hypot(sigmas[1]);
            if by.abs() > MOST_SIGMAS * sigma {
                told.push(format!("{what} by {} (one sigma of both is {})", say(by.abs()), say(sigma)));
            }
        };
        let metres = |m: f64| format!("{m:.2} m");
        let degrees = |rad: f64| format!("{:.2} degrees", rad.to_degrees());
        let percent = |log: f64| format!("{:.1} %", 100.0 * log.exp_m1());
        compare("place", self.shift.xy().norm(), [a.position_m, b.position_m], metres);
        compare("height", self.shift.z, [a.height_m, b.height_m], metres);
        compare("heading", self.turn.z, [a.heading_rad, b.heading_rad], degrees);
        compare("tilt", self.turn.xy().norm(), [a.tilt_rad, b.tilt_rad], degrees);
        compare("scale", self.log_scale, [a.log_scale, b.log_scale], percent);
        told
    }

    fn averaged(&self, a: &Estimate, b: &Estimate) -> Result<Start, crate::geometry::StartError> {
        let (s, t) = (a.start.sigmas(), b.start.sigmas());
        // The share of the second, and the sigma of both.
        let share = |s: f64, t: f64| (s * s / (s * s + t * t), s * t / s.hypot(t));
        let (of_place, position_m) = share(s.position_m, t.position_m);
        let (of_height, height_m) = share(s.height_m, t.height_m);
        let (of_heading, heading_rad) = share(s.heading_rad, t.heading_rad);
        let (of_tilt, tilt_rad) = share(s.tilt_rad, t.tilt_rad);
        let (of_scale, log_scale) = share(s.log_scale, t.log_scale);
        let from = a.start.city_from_sfm();
        let shift = self.shift.component_mul(&Vector3::new(of_place, of_place, of_height));
        let tilt = Rotation3::new(Vector3::new(self.turn.x * of_tilt, self.turn.y * of_tilt, 0.0));
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), self.turn.z * of_heading) * tilt;
        let image = Point3::from(from.apply(&a.middle) + shift);
        let scale = from.scale * (self.log_scale * of_scale).exp();
        let pose = Similarity::about(&a.middle, &image, scale, turn * from.rotation);
        Start::new(pose, StartSigmas { position_m, height_m, heading_rad, tilt_rad, log_scale })
    }
}

/// The turn about up that is nearest to a rotation, radians.
fn heading(rotation: &Rotation3<f64>) -> f64 {
    let r = rotation.matrix();
    (r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)])
}
