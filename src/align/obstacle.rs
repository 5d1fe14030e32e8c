//! Why a search cannot find anything, said before it begins.

use std::fmt;

use crate::city::CityModel;
use crate::correspondence::{LevelCloud, Prior, Vertical};
use crate::geometry::{Point3, Start, Vector3};
use crate::limits::Limits;
use crate::place_search::PlaceObstacle;
use crate::planes::{Patches, Upright};
use crate::reconstruction::Reconstruction;
use crate::robust::Motion;

/// What stands in the way of any alignment.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Obstacle {
    EmptyCity,
    NoPoints {
        images: usize,
    },
    NoPatches {
        points: usize,
        /// In units of the reconstruction.
        noise: f64,
    },
    /// At the start's scale the cloud is smaller than a gate, or beyond all measure.
    OddSize {
        radius_m: f64,
        scale: f64,
    },
    FarFromTheCity {
        place: Point3<f64>,
        distance_m: f64,
        reach_m: f64,
        city: [Point3<f64>; 2],
    },
    /// Without a start: why walls tell no place.
    NoPlace(PlaceObstacle),
    /// Without a start: no place in the city lets the walls lie on its own better than chance.
    NothingFits,
    /// ... nor in the share of the city that was searched before the time was over.
    NothingFitsInPart {
        share: f64,
    },
}

/// No cloud of a city is larger, metres: the Earth's radius.
const LARGEST_RADIUS_M: f64 = 6.4e6;

/// What stands in the way wherever the reconstruction is sought.
pub(super) fn of_inputs(city: &CityModel, reconstruction: &Reconstruction, patches: &Patches) -> Option<Obstacle> {
    if city.whole_size().triangles == 0 || city.bounds().is_none() {
        return Some(Obstacle::EmptyCity);
    }
    if reconstruction.points.is_empty() {
        return Some(Obstacle::NoPoints { images: reconstruction.images.len() });
    }
    patches
        .patches
        .is_empty()
        .then_some(Obstacle::NoPatches { points: reconstruction.points.len(), noise: patches.noise })
}

/// A start, in the city's local frame, from which no point can reach the city.
pub(super) fn of_start(city: &CityModel, patches: &Patches, start: &Start, limits: &Limits) -> Option<Obstacle> {
    let (low, high) = city.bounds()?;
    let up = start.city_from_sfm().rotation.inverse() * Vector3::z();
    let upright = Upright { up, sigma_rad: start.sigmas().tilt_rad, known: false };
    let level_cloud = LevelCloud::new(patches, start.city_from_sfm(), &upright, limits);
    let place = level_cloud.center_in_city;
    let scale = start.city_from_sfm().scale;
    let grown_m = level_cloud.radius_m * (limits.reach_sigmas * start.sigmas().log_scale).exp();
    if !(grown_m >= limits.model_unit_m && level_cloud.radius_m <= LARGEST_RADIUS_M) {
        return Some(Obstacle::OddSize { radius_m: level_cloud.radius_m, scale });
    }
    // The sigmas as they were given: bounded by the city they always reach it.
    let prior = Prior::new(start, place, level_cloud.radius_m, Motion::Similarity, Vertical::Free, None, limits);
    let reach = prior.reach(&level_cloud.extent());
    let apart = |k: usize| (low[k] - reach.high[k]).max(reach.low[k] - high[k]).max(0.0);
    if (0..3).all(|k| apart(k) == 0.0) {
        return None;
    }
    let beside = |k: usize| (low[k] - place[k]).max(place[k] - high[k]).max(0.0);
    Some(Obstacle::FarFromTheCity {
        place: place + city.origin,
        distance_m: Vector3::new(beside(0), beside(1), beside(2)).norm(),
        reach_m: (reach.high - place).norm(),
        city: [low + city.origin, high + city.origin],
    })
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Obstacle::EmptyCity => write!(f, "the city model has no facets; give one with walls, roofs or ground"),
            Obstacle::NoPoints { images: 0 } => {
                write!(f, "the reconstruction has no points; give a cloud, or a COLMAP model with points3D")
            }
            Obstacle::NoPoints { images } => write!(
                f,
                "the reconstruction has no points, only {images} images; triangulate its points first (COLMAP: point_triangulator)"
            ),
            Obstacle::NoPatches { points, noise } => write!(
                f,
                "no planar patch among {points} points (their noise is {noise:.3} units of the reconstruction); walls, roofs or ground \
                 with eight points and more on each are needed"
            ),
            Obstacle::NoPlace(obstacle) => write!(f, "{obstacle}"),
            Obstacle::NothingFits => write!(
                f,
                "at no place do the walls of the reconstruction lie on the city's better than chance lets them; check that the city covers this \
                 place, or give a start"
            ),
            Obstacle::NothingFitsInPart { share } => write!(
                f,
                "in the {:.1} % of the city that were searched in the time given no place lets the walls of the reconstruction lie on its own \
                 better than chance; give it more time (--budget), a start, or --near",
                100.0 * share
            ),
            Obstacle::OddSize { radius_m, scale } => write!(
                f,
                "at {scale:e} metres per reconstruction unit the reconstruction has a radius of {radius_m:.3e} m, which is that of no place; \
                 check the scale of the start (or --scale)"
            ),
            Obstacle::FarFromTheCity { place, distance_m, reach_m, city: [low, high] } => write!(
                f,
                "the start puts the reconstruction {} from the city (its middle at {:.0}, {:.0}, {:.0}; the city lies from {:.0}, {:.0}, \
                 {:.0} to {:.0}, {:.0}, {:.0}), and its sigmas reach {} at most; check that start and city are in the same frame and unit",
                length(*distance_m),
                place.x,
                place.y,
                place.z,
                low.x,
                low.y,
                low.z,
                high.x,
                high.y,
                high.z,
                length(*reach_m)
            ),
        }
    }
}

/// Metres up to ten kilometres, then kilometres, thousands set apart.
fn length(metres: f64) -> String {
    if metres < 10_000.0 {
        return format!("{metres:.0} m");
    }
    let digits = format!("{:.0}", metres / 1000.0);
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped + " km"
}

#[cfg(test)]
mod tests;
