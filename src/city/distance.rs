//! How far a place is from the city.

use super::CityModel;
use crate::geometry::{Point3, Vector3};

impl CityModel {
    /// Distance from a place (local coordinates) to the nearest facet, metres; `None` of a city without facets.
    pub fn distance_to(&self, place: &Point3<f64>) -> Option<f64> {
        let corners = |t: &[u32; 3]| t.map(|corner| self.vertices[corner as usize]);
        let squares = self.triangles.iter().map(|t| (nearest(place, &corners(t)) - place).norm_squared());
        squares.min_by(f64::total_cmp).map(f64::sqrt)
    }
}

/// The point of a triangle that is nearest to a place: within it, or on one of its edges.
fn nearest(place: &Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> Point3<f64> {
    let normal = (b - a).cross(&(c - a));
    let foot = place - normal * ((place - a).dot(&normal) / normal.norm_squared().max(f64::MIN_POSITIVE));
    let inside = |p: &Point3<f64>, q: &Point3<f64>| (q - p).cross(&(foot - p)).dot(&normal) >= 0.0;
    if normal != Vector3::zeros() && inside(a, b) && inside(b, c) && inside(c, a) {
        return foot;
    }
    let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
        let along = q - p;
        p + along * ((place - p).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    });
    let distance_sq = |p: &Point3<f64>| (p - place).norm_squared();
    edges.into_iter().min_by(|p, q| distance_sq(p).total_cmp(&distance_sq(q))).unwrap_or(*a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_to_a_triangle_is_that_to_its_inside_edge_or_corner() {
        let city = CityModel {
            vertices: vec![Point3::origin(), Point3::new(4.0, 0.0, 0.0), Point3::new(0.0, 4.0, 0.0)],
            triangles: vec![[0, 1, 2]],
            ..CityModel::default()
        };
        for (place, distance) in [
            ([1.0, 1.0, 3.0], 3.0),
            ([1.0, -3.0, 4.0], 5.0),
            ([-3.0, -4.0, 0.0], 5.0),
            ([4.0, 4.0, 0.0], 8f64.sqrt()),
            ([2.0, 2.0, 0.0], 0.0),
        ] {
            let found = city.distance_to(&Point3::from(place)).unwrap();
            assert!((found - distance).abs() < 1e-12, "{place:?}: {found}");
        }
        assert_eq!(CityModel::default().distance_to(&Point3::origin()), None);
    }

    #[test]
    fn a_triangle_without_area_is_met_at_its_edges() {
        let city = CityModel {
            vertices: vec![Point3::origin(), Point3::new(4.0, 0.0, 0.0), Point3::new(8.0, 0.0, 0.0)],
            triangles: vec![[0, 1, 2]],
            ..CityModel::default()
        };
        assert_eq!(city.distance_to(&Point3::new(6.0, 3.0, 4.0)), Some(5.0));
    }
}
