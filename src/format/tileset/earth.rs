//! Whether coordinates are earth-centred (ECEF, EPSG:4978), and the turn to a frame that stands upright: x east, y north, z up.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::Similarity;

/// WGS 84: half the longer axis in metres, and how much flatter the shorter one is.
const EQUATOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// Heights at which anything is built, with room for the geoid and for mistakes, metres.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = -12_000.0..=12_000.0;

/// Steps after which latitude and height stand still to 1e-9 m.
const STEPS: usize = 8;

/// The turn from earth-centred coordinates to east, north and height above the ellipsoid, about the middle of the positions;
/// nothing where they are none.
pub(super) fn local_from_ecef(positions: &[[f64; 3]]) -> Option<Similarity> {
    let middle = middle(positions)?;
    let Geodetic { latitude, longitude, height } = geodetic(middle);
    if !HEIGHTS_M.contains(&height) {
        return None;
    }
    let rotation = east_north_up(latitude, longitude);
    if HEIGHTS_M.contains(&middle.z) && !is_flat_about(positions, rotation.row(2).transpose()) {
        return None;
    }
    let foot = on_ellipsoid(latitude, longitude);
    Similarity::try_new(1.0, rotation, -(rotation * foot)).ok()
}

/// Near the equator the numbers alone do not tell: at 57 degrees north a national grid may also be as far from zero as the
/// earth is thick. A city is wider than it is high: along its up it is thinner than along z where z is north.
fn is_flat_about(positions: &[[f64; 3]], up: Vector3<f64>) -> bool {
    let spread = |axis: Vector3<f64>| {
        let along = positions.iter().map(|position| axis.dot(&Vector3::from(*position)));
        let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
        high - low
    };
    spread(up) < spread(Vector3::z())
}

fn middle(positions: &[[f64; 3]]) -> Option<Vector3<f64>> {
    let first = Vector3::from(*positions.first()?);
    let (low, high) = positions.iter().fold((first, first), |(low, high), position| {
        let position = Vector3::from(*position);
        (low.inf(&position), high.sup(&position))
    });
    Some((low + high) / 2.0)
}

struct Geodetic {
    latitude: f64,
    longitude: f64,
    height: f64,
}

/// Latitude and longitude in radians, height above the ellipsoid in metres, by the fixed point of
/// `tan latitude = (z + e^2 N sin latitude) / p`, with N the radius of curvature and p the distance from the axis.
fn geodetic(at: Vector3<f64>) -> Geodetic {
    let from_axis = at.x.hypot(at.y);
    let eccentricity_sq = FLATTENING * (2.0 - FLATTENING);
    let mut latitude = at.z.atan2(from_axis * (1.0 - eccentricity_sq));
    for _ in 0..STEPS {
        latitude = (at.z + eccentricity_sq * curvature(latitude) * latitude.sin()).atan2(from_axis);
    }
    let foot_from_axis = curvature(latitude) * latitude.cos();
    let foot_z = curvature(latitude) * (1.0 - eccentricity_sq) * latitude.sin();
    let height = (from_axis - foot_from_axis) * latitude.cos() + (at.z - foot_z) * latitude.sin();
    Geodetic { latitude, longitude: at.y.atan2(at.x), height }
}

fn curvature(latitude: f64) -> f64 {
    EQUATOR_M / (1.0 - FLATTENING * (2.0 - FLATTENING) * latitude.sin().powi(2)).sqrt()
}

fn on_ellipsoid(latitude: f64, longitude: f64) -> Vector3<f64> {
    let from_axis = curvature(latitude) * latitude.cos();
    let z = curvature(latitude) * (1.0 - FLATTENING).powi(2) * latitude.sin();
    Vector3::new(from_axis * longitude.cos(), from_axis * longitude.sin(), z)
}

/// Rows: east, north, up.
fn east_north_up(latitude: f64, longitude: f64) -> Matrix3<f64> {
    let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = (latitude.sin_cos(), longitude.sin_cos());
    Matrix3::new(
        -sin_lon,
        cos_lon,
        0.0,
        -sin_lat * cos_lon,
        -sin_lat * sin_lon,
        cos_lat,
        cos_lat * cos_lon,
        cos_lat * sin_lon,
        sin_lat,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_on_earth_is_found_again_from_its_latitude_and_height() {
        for (latitude, longitude, height) in
            [(52.0, 4.4, 43.0), (-33.9, 151.2, 900.0), (89.9, 10.0, 0.0), (0.5, -78.5, 2850.0)]
        {
            let (latitude, longitude) = (f64::to_radians(latitude), f64::to_radians(longitude));
            let up = east_north_up(latitude, longitude).row(2).transpose();
            let found = geodetic(on_ellipsoid(latitude, longitude) + height * up);
            assert!((found.latitude - latitude).abs() < 1e-11 && (found.longitude - longitude).abs() < 1e-12);
            assert!((found.height - height).abs() < 1e-7);
        }
    }

    /// A street of 300 x 100 x 20 m about a place, in axes x, y, z.
    fn street(origin: Vector3<f64>, axes: Matrix3<f64>) -> Vec<[f64; 3]> {
        let corners =
            (0..8).map(|at| Vector3::new(300.0 * f64::from(at & 1), 50.0 * f64::from(at & 2), 5.0 * f64::from(at & 4)));
        corners.map(|corner| (origin + axes.transpose() * corner).into()).collect()
    }

    #[test]
    fn what_stands_on_the_earth_is_set_upright_at_its_height() {
        for (latitude, longitude) in [(0.9_f64, 0.1_f64), (0.0003, -1.4), (-1.2, 3.0)] {
            let axes = east_north_up(latitude, longitude);
            let origin = on_ellipsoid(latitude, longitude) + 40.0 * axes.row(2).transpose();
            let positions = street(origin, axes);
            let local = local_from_ecef(&positions).unwrap();
            for (position, low) in positions.iter().zip([-150.0, 150.0].iter().cycle()) {
                let placed = local.rotation * Vector3::from(*position) + local.translation;
                assert!((placed.x - low).abs() < 0.1, "{placed}");
                assert!((placed.z - 40.0).abs() < 0.1 || (placed.z - 60.0).abs() < 0.1, "{placed}");
            }
        }
    }

    #[test]
    fn grids_and_local_frames_are_left_alone() {
        // 57 degrees north in UTM: as far from zero as the pole.
        for origin in
            [[500_000.0, 6_350_000.0, 20.0], [0.0; 3], [90_000.0, 435_000.0, 0.0], [32_500_000.0, 5_750_000.0, 0.0]]
        {
            assert_eq!(local_from_ecef(&street(Vector3::from(origin), Matrix3::identity())), None, "{origin:?}");
        }
        assert_eq!(local_from_ecef(&[]), None);
    }
}
