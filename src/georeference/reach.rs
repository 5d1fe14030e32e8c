//! Whether a start can reach the city at all, and what of the city it can reach, before anything is searched.

use super::extent::{radius, within_which};
use super::{Estimate, GeoreferenceError};
use crate::city::{CityModel, PlanBox};
use crate::geometry::Point3;

/// A start that is this many of its sigmas from the city, and the cloud's own radius, cannot reach it.
const REACH_SIGMAS: f64 = 3.0;
/// Slack, metres.
const MARGIN_M: f64 = 10.0;
/// The share of points whose surroundings are read: all but those that `scene.glb` takes for stray.
const SEEN: f64 = 0.98;
/// What chance does is asked of poses as far off, metres, however well a start is known (`limits::NullPoseLimits::least_reach_m`).
const LEAST_REACH_M: f64 = 100.0;
/// A scene is shown with so much of the city around it, metres, and every facet that comes near it is asked for.
const SHOWN_M: f64 = 350.0;

impl Estimate {
    /// What of the city matters to an alignment from here, in plan; `fixed_scale` is one that is given besides.
    pub fn surroundings(&self, points: &[Point3<f64>], fixed_scale: Option<f64>) -> PlanBox {
        let (pose, sigmas) = (self.start.city_from_sfm(), self.start.sigmas());
        let place = pose.apply(&self.middle);
        let grown = (REACH_SIGMAS * sigmas.log_scale).exp();
        let scale = (pose.scale * grown).max(fixed_scale.unwrap_or(0.0));
        let radius_m = scale * within_which(points, &self.middle, SEEN);
        let reach_m = (REACH_SIGMAS * sigmas.position_m).max(LEAST_REACH_M);
        PlanBox::about([place.x, place.y], radius_m + reach_m + SHOWN_M)
    }

    /// Distance from the place of the reconstruction's middle to the nearest facet, metres; an error where nothing within the sigmas leads
    /// into the city. A city without facets is at no distance.
    pub fn distance_to_city(&self, points: &[Point3<f64>], city: &CityModel) -> Result<f64, GeoreferenceError> {
        let (pose, sigmas) = (self.start.city_from_sfm(), self.start.sigmas());
        let place = pose.apply(&self.middle);
        let Some(distance_m) = city.distance_to(&(place - city.origin)) else { return Ok(0.0) };
        let radius_m = pose.scale * radius(points, &self.middle) * (REACH_SIGMAS * sigmas.log_scale).exp();
        let reach_m = radius_m + REACH_SIGMAS * sigmas.position_m.hypot(sigmas.height_m) + MARGIN_M;
        if distance_m <= reach_m {
            return Ok(distance_m);
        }
        let (low, high) = city.bounds().map_or((place, place), |(low, high)| (low + city.origin, high + city.origin));
        Err(GeoreferenceError::FarFromTheCity {
            distance_m,
            reach_m,
            place,
            low,
            high,
            source_name: self.source.clone(),
        })
    }
}
