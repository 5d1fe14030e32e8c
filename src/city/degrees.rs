//! Latitude and longitude to metres about the model's middle: the transverse Mercator projection, true to scale there.

use crate::geometry::Point3;

/// Degrees to which the middle is rounded, so that its coordinates are short and tiles beside each other likely share it.
const MIDDLE_STEP_DEG: f64 = 1e-3;

/// Semi-major axis, metres, and flattening of GRS80; that of WGS84 differs from it by 0.1 mm in the axis.
const AXIS_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_222_101;

/// A projection about a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LocalProjection {
    /// Degrees.
    latitude: f64,
    longitude: f64,
}

impl LocalProjection {
    /// About the place nearest to this with short coordinates.
    pub fn about(latitude: f64, longitude: f64) -> LocalProjection {
        let rounded = |degrees: f64| (degrees / MIDDLE_STEP_DEG).round() * MIDDLE_STEP_DEG;
        LocalProjection { latitude: rounded(latitude), longitude: rounded(longitude) }
    }

    /// As PROJ spells it, so that results can be brought back.
    pub fn text(&self) -> String {
        let LocalProjection { latitude, longitude } = self;
        format!(
            "+proj=tmerc +lat_0={latitude:.3} +lon_0={longitude:.3} +k=1 +x_0=0 +y_0=0 +ellps=GRS80 +units=m +no_defs"
        )
    }

    /// (longitude, latitude, height) in degrees and metres to (east, north, height) in metres.
    pub fn project(&self, place: Point3<f64>) -> Point3<f64> {
        // The difference goes once around the world and stays on the shorter way.
        let longitude = (place.x - self.longitude + 540.0).rem_euclid(360.0) - 180.0;
        let [east, north] = from_equator(place.y.to_radians(), longitude.to_radians());
        let [_, middle] = from_equator(self.latitude.to_radians(), 0.0);
        Point3::new(east, north - middle, place.z)
    }
}

/// Metres east of the central meridian and north of the equator. Krueger's series to the fourth power of the third flattening, good to
/// a micrometre within 1,000 km of the meridian (Karney 2011, Transverse Mercator with an accuracy of a few nanometers, equations 7 to 11 and 35).
fn from_equator(latitude: f64, longitude: f64) -> [f64; 2] {
    let n = FLATTENING / (2.0 - FLATTENING);
    let alpha = [
        n / 2.0 - 2.0 / 3.0 * n.powi(2) + 5.0 / 16.0 * n.powi(3) + 41.0 / 180.0 * n.powi(4),
        13.0 / 48.0 * n.powi(2) - 3.0 / 5.0 * n.powi(3) + 557.0 / 1440.0 * n.powi(4),
        61.0 / 240.0 * n.powi(3) - 103.0 / 140.0 * n.powi(4),
        49_561.0 / 161_280.0 * n.powi(4),
    ];
    let radius = AXIS_M / (1.0 + n) * (1.0 + n.powi(2) / 4.0 + n.powi(4) / 64.0);
    let e = (FLATTENING * (2.0 - FLATTENING)).sqrt();
    // The tangent of the conformal latitude.
    let t = (latitude.sin().atanh() - e * (e * latitude.sin()).atanh()).sinh();
    let (xi, eta) = (t.atan2(longitude.cos()), (longitude.sin() / t.hypot(longitude.cos())).asinh());
    let (mut north, mut east) = (xi, eta);
    for (factor, twice) in alpha.iter().zip([2.0, 4.0, 6.0, 8.0]) {
        north += factor * (twice * xi).sin() * (twice * eta).cosh();
        east += factor * (twice * xi).cos() * (twice * eta).sinh();
    }
    [radius * east, radius * north]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The length of a quarter of the meridian on GRS80 is 10,001,965.729 m (Moritz 2000, Geodetic Reference System 1980).
    #[test]
    fn a_quarter_of_the_meridian_has_its_length() {
        let [east, north] = from_equator(std::f64::consts::FRAC_PI_2 - 1e-12, 0.0);
        assert!(east.abs() < 1e-3 && (north - 10_001_965.729).abs() < 1e-3, "{east} {north}");
    }

    /// Tangents of the ellipsoid at the middle: the radii of curvature give a metre north and a metre east.
    #[test]
    fn small_steps_are_metres_north_and_east() {
        let (latitude, step): (f64, f64) = (42.938, 1e-5);
        let projection = LocalProjection { latitude, longitude: 141.437 };
        let e_sq = FLATTENING * (2.0 - FLATTENING);
        let w = 1.0 - e_sq * latitude.to_radians().sin().powi(2);
        let across = AXIS_M / w.sqrt() * latitude.to_radians().cos() * step.to_radians();
        let along = AXIS_M * (1.0 - e_sq) / w.powf(1.5) * step.to_radians();
        let put = projection.project(Point3::new(141.437 + step, latitude, 97.9));
        assert!((put.x - across).abs() < 1e-6 && put.y.abs() < 1e-6 && put.z == 97.9, "{put} {across}");
        let put = projection.project(Point3::new(141.437, latitude + step, 97.9));
        assert!(put.x.abs() < 1e-9 && (put.y - along).abs() < 1e-6, "{put} {along}");
    }

    #[test]
    fn the_date_line_is_crossed_the_short_way() {
        let projection = LocalProjection::about(-17.0, 179.9995);
        assert!(projection.project(Point3::new(-179.9995, -17.0, 0.0)).x.abs() < 200.0);
    }

    #[test]
    fn the_middle_is_short_and_the_text_is_for_proj() {
        let text = LocalProjection::about(42.937_62, 141.436_9).text();
        assert!(text.starts_with("+proj=tmerc +lat_0=42.938 +lon_0=141.437 +k=1 "), "{text}");
    }
}
