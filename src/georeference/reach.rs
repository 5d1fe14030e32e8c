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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation3, Similarity, Start, StartSigmas, Vector3};
    use crate::random::Random;

    fn estimate(points: &[Point3<f64>], sigmas: StartSigmas) -> Estimate {
        let pose = Similarity {
            scale: 2.5,
            rotation: Rotation3::from_euler_angles(0.1, -0.2, 2.0),
            translation: Vector3::new(1000.0, -500.0, 30.0),
        };
        Estimate::given(Start::new(pose, sigmas).unwrap(), points, "start".into())
    }

    fn sigmas() -> StartSigmas {
        StartSigmas { position_m: 20.0, height_m: 3.0, heading_rad: 0.5, tilt_rad: 0.03, log_scale: 0.2 }
    }

    #[test]
    fn surroundings_hold_the_cloud_wherever_three_sigmas_put_it() {
        let mut random = Random::stream(4, 0);
        let points: Vec<Point3<f64>> = (0..300).map(|_| Point3::from(20.0 * random.normal_vector())).collect();
        let estimate = estimate(&points, sigmas());
        let around = estimate.surroundings(&points, None);
        let middle = estimate.start.city_from_sfm().apply(&estimate.middle);
        let farthest = crate::georeference::extent::within_which(&points, &estimate.middle, SEEN);
        for _ in 0..500 {
            let mut within = |most: f64| most * (2.0 * random.unit() - 1.0);
            // Within three sigmas to any side, the scale three sigmas up, turned anyhow.
            let shift = [within(60.0), within(60.0)];
            let grown = 2.5 * within(0.6).exp();
            let turned = Rotation3::from_euler_angles(within(3.0), within(3.0), within(3.0));
            for point in points.iter().filter(|point| (*point - estimate.middle).norm() <= farthest) {
                let off = grown * (turned * (point - estimate.middle));
                let place = [0, 1].map(|k| middle[k] + shift[k] + off[k]);
                let is_in = (0..2).all(|k| (around.low[k]..=around.high[k]).contains(&place[k]));
                assert!(is_in, "{place:?} is not in {around:?}");
            }
        }
    }

    #[test]
    fn a_given_scale_widens_them_and_none_narrows_them() {
        let points: Vec<Point3<f64>> = (0..100).map(|k| Point3::new(f64::from(k), 0.0, 0.0)).collect();
        let estimate = estimate(&points, sigmas());
        let width = |scale: Option<f64>| {
            let around = estimate.surroundings(&points, scale);
            around.high[0] - around.low[0]
        };
        assert_eq!(width(Some(0.1)), width(None));
        assert!(width(Some(25.0)) > 2.0 * width(None));
    }
}
