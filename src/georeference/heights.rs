//! Whether heights of satellite positions are above the ellipsoid or above the sea: cameras write either, and the city tells.
//!
//! Receivers measure heights above the ellipsoid; phones and some drones write heights above the sea (EXIF before 3.0 cannot say which).
//! Between the two lies the geoid, up to 100 m. City models stand on heights above the sea. Where the two readings are far apart, that one
//! is taken under which the foot of the cloud lies nearer to the city's.

use super::extent::middle;
use super::projection::ToCity;
use crate::city::CityModel;
use crate::geometry::{Point3, Similarity};
use crate::robust::quantile;

/// How the heights of a source were taken.
pub(super) struct HeightReading {
    /// Added to every height, metres.
    pub shift_m: f64,
    /// For the report; empty where there was no choice.
    pub words: String,
    /// Whether heights were of another system than the city's.
    pub is_foreign: bool,
}

/// Readings nearer to each other than this are covered by the height's sigma alike, metres. Chosen.
const DISTINCT_M: f64 = 15.0;
/// The city's foot is looked for within this distance, metres. Chosen: a few blocks.
const NEARBY_M: f64 = 300.0;
/// The share of heights below which a foot lies: some points and vertices are below the ground.
const FOOT: f64 = 0.1;

/// `city_from_sfm`: with the heights as they stand, to the city's local frame.
pub(super) fn reading(
    to_city: &ToCity,
    points: &[Point3<f64>],
    city_from_sfm: &Similarity,
    city: &CityModel,
) -> HeightReading {
    if to_city.keeps_heights() {
        return HeightReading { shift_m: 0.0, words: String::new(), is_foreign: false };
    }
    let mut heights: Vec<f64> = points.iter().map(|p| city_from_sfm.apply(p).z).collect();
    let place = city_from_sfm.apply(&middle(points));
    let Some(geoid_m) = geoid_m(to_city, &place, city) else {
        return HeightReading { shift_m: 0.0, words: String::new(), is_foreign: true };
    };
    let above_sea = HeightReading { shift_m: 0.0, words: ", heights taken above the sea".into(), is_foreign: true };
    let above_ellipsoid = HeightReading {
        shift_m: -geoid_m,
        words: format!(", heights taken above the ellipsoid, {geoid_m:.1} m above the sea here (EGM96)"),
        is_foreign: true,
    };
    let expects_ellipsoid = to_city.is_geographic();
    let feet = quantile(&mut heights, FOOT).zip(city_foot(city, &place)).filter(|_| geoid_m.abs() >= DISTINCT_M);
    let is_ellipsoid = match feet {
        Some((foot, city_foot)) => (foot - geoid_m - city_foot).abs() <= (foot - city_foot).abs(),
        None => expects_ellipsoid,
    };
    if is_ellipsoid { above_ellipsoid } else { above_sea }
}

/// The height of the sea above the ellipsoid at a place of the city's local frame.
fn geoid_m(to_city: &ToCity, place: &Point3<f64>, city: &CityModel) -> Option<f64> {
    let [longitude, latitude] = to_city.geographic([place.x + city.origin.x, place.y + city.origin.y])?;
    Some(egm96::egm96_compute_altitude_offset(latitude, longitude)).filter(|height| height.is_finite())
}

/// Where the city's lowest tenth of vertices begins, near a place or else anywhere.
fn city_foot(city: &CityModel, place: &Point3<f64>) -> Option<f64> {
    let near = city.vertices.iter().filter(|v| (v.xy() - place.xy()).norm() <= NEARBY_M).map(|v| v.z);
    let mut heights: Vec<f64> = near.collect();
    if heights.is_empty() {
        heights = city.vertices.iter().map(|v| v.z).collect();
    }
    quantile(&mut heights, FOOT)
}
