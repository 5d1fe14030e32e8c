//! Whether a start can reach the city at all, before anything is searched.

use super::extent::radius;
use super::{Estimate, GeoreferenceError};
use crate::city::CityModel;
use crate::geometry::Point3;

/// A start that is this many of its sigmas from the city, and the cloud's own radius, cannot reach it.
const REACH_SIGMAS: f64 = 3.0;
/// Slack, metres.
const MARGIN_M: f64 = 10.0;

impl Estimate {
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
