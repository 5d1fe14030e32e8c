use super::*;
use crate::city::{Facet, ObjectId};
use crate::geometry::Plane;
use crate::planes::PreparedCity;

/// Two walls, 0.4 m apart, back to back, 10 m wide and 6 m high: one looks to +x from x = 0.2, one to -x from x = -0.2.
fn two_walls() -> CityModel {
    let mut city = CityModel { objects: vec!["walls".to_owned()], ..CityModel::default() };
    for (x, side) in [(0.2, 1.0), (-0.2, -1.0)] {
        let first = city.vertices.len() as u32;
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 6.0), (0.0, 6.0)];
        city.vertices.extend(corners.iter().map(|&(y, z)| Point3::new(x, y, z)));
        let start = city.triangles.len() as u32;
        city.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        city.facets.push(Facet {
            holes: Vec::new(),
            kind: None,
            outline: (first..first + 4).collect(),
            plane: Plane::through(&Point3::new(x, 0.0, 0.0), &Vector3::new(side, 0.0, 0.0)).unwrap(),
            area: 60.0,
            object: ObjectId(0),
            triangles: start..start + 2,
        });
    }
    city
}

fn prepared() -> PreparedCity {
    PreparedCity::new(two_walls())
}

fn sample_point(x: f64, y: f64, z: f64, side: f64) -> OrientedPoint {
    OrientedPoint { position: Point3::new(x, y, z), normal: Vector3::new(side, 0.0, 0.0), sided: true, min_cos: 0.9 }
}

#[test]
fn finds_the_facet_that_faces_the_same_way_though_another_is_nearer() {
    let city = prepared();
    let grid = city.grid(1.5);
    let hit = city.nearest(&grid, &sample_point(-0.3, 5.0, 3.0, 1.0), 1.0).unwrap();
    assert!((hit.across_m + 0.5).abs() < 1e-12 && hit.outside_m == 0.0);
    assert_eq!(hit.normal, Vector3::x());
    let either = OrientedPoint { sided: false, ..sample_point(-0.3, 5.0, 3.0, 1.0) };
    assert_eq!(city.nearest(&grid, &either, 1.0).unwrap().normal, -Vector3::x());
}

#[test]
fn measures_to_the_edge_and_ends_at_the_gate() {
    let city = prepared();
    let grid = city.grid(1.5);
    let hit = city.nearest(&grid, &sample_point(0.2, 5.0, 6.7, 1.0), 1.0).unwrap();
    assert!(hit.across_m.abs() < 1e-12 && (hit.outside_m - 0.7).abs() < 1e-12);
    assert!(city.nearest(&grid, &sample_point(0.2, 5.0, 7.2, 1.0), 1.0).is_none());
    assert!(city.nearest(&grid, &sample_point(f64::NAN, 5.0, 3.0, 1.0), 1.0).is_none());
    assert!(city.nearest(&grid, &sample_point(1e9, 5.0, 3.0, 1.0), 1.0).is_none());
}

#[test]
fn parts_of_a_run_share_a_grid_and_a_gate_beyond_its_reach_is_cut_to_it() {
    let city = prepared();
    let grid = city.grid(1.5);
    assert!(std::sync::Arc::ptr_eq(&grid, &city.grid(1.51)) && grid.reach_m() >= 1.51);
    assert!(city.nearest(&grid, &sample_point(0.2 + 2.0, 5.0, 3.0, 1.0), 50.0).is_none());
}

#[test]
fn an_empty_city_has_no_facet_anywhere() {
    let city = PreparedCity::new(CityModel::default());
    assert!(city.nearest(&city.grid(1.0), &sample_point(0.0, 0.0, 0.0, 1.0), 1.0).is_none());
}

#[test]
fn memory_goes_by_the_model_and_not_by_its_extent() {
    let far = 5e6;
    let square = |z: f64| {
        let corners = [(-far, -far), (far, -far), (far, far), (-far, far)];
        ("ground".to_owned(), corners.map(|(x, y)| Point3::new(x, y, z)).to_vec())
    };
    let squares: Vec<(String, Vec<Point3<f64>>)> = (0..300).map(|k| square(0.01 * f64::from(k))).collect();
    let city = PreparedCity::new(CityModel::from_polygons(&squares).unwrap());
    let grid = city.grid(1.5);
    assert!(grid.filled.len() <= 65_536 && grid.near.len() <= 65_536, "{} {}", grid.filled.len(), grid.near.len());
}
