use super::*;

const SIZE: [f64; 3] = [10.0, 6.0, 8.0];

fn houses() -> [(House, f64, f64); 4] {
    let plinth = Plinth { height_m: 3.0, depth_m: 0.5 };
    // Volume in cubic metres, area of walls and roofs in square metres.
    [
        (House::flat(SIZE), 480.0, 316.0),
        (House::gabled(SIZE, 4.0), 600.0, 256.0 + 24.0 + 100.0),
        (House::l_shaped(SIZE, [4.0, 2.0]), 416.0, 256.0 + 52.0),
        (House::on_plinth(SIZE, plinth), 495.0, 316.0 + 5.0 + 3.0),
    ]
}

#[test]
fn every_house_is_closed_but_for_its_floor_and_looks_outwards() {
    for (house, volume, area) in houses() {
        let house = house.turned(0.7).at([30.0, -20.0, 0.0]);
        // With z = 0 as the floor, the tetrahedra over a point of the floor fill the house.
        let over = Point3::new(30.0, -20.0, 0.0);
        let tetrahedron = |t: &[Point3<f64>; 3]| (t[0] - over).dot(&across(t)) / 6.0;
        let found: f64 = house.faces.iter().flat_map(Face::triangles).map(|t| tetrahedron(&t)).sum();
        assert!((found - volume).abs() < 1e-9, "{found} {volume}");
        let found: f64 = house.faces.iter().map(Face::area).sum();
        assert!((found - area).abs() < 1e-9, "{found} {area}");
    }
}

#[test]
fn fans_cover_their_faces_without_folds() {
    for (house, ..) in houses() {
        for face in &house.faces {
            let n = face.normal();
            assert!(face.triangles().all(|t| across(&t).dot(&n) > 0.0), "{face:?}");
            assert_eq!(face.surface == Surface::Wall, n.z.abs() < 1e-12, "{face:?}");
        }
    }
}

#[test]
fn a_house_turned_or_moved_keeps_its_shape() {
    for (house, _, area) in houses() {
        let moved = house.clone().turned(1.1).at([5.0, -3.0, 2.0]);
        assert!((moved.faces.iter().map(Face::area).sum::<f64>() - area).abs() < 1e-9);
        for (before, after) in house.faces.iter().zip(&moved.faces) {
            for k in 0..before.corners.len() {
                let edge = |face: &Face| face.corners[(k + 1) % face.corners.len()] - face.corners[k];
                assert!((edge(before).norm() - edge(after).norm()).abs() < 1e-12);
            }
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), 1.1) * before.normal();
            assert!((turned - after.normal()).norm() < 1e-12);
        }
    }
}

#[test]
fn every_edge_above_the_floor_is_walked_once_each_way() {
    for (house, ..) in houses() {
        let key = |p: &Point3<f64>| [p.x, p.y, p.z].map(|v| (v * 1e6).round() as i64);
        let mut balance = std::collections::BTreeMap::new();
        for face in &house.faces {
            for k in 0..face.corners.len() {
                let (a, b) = (key(&face.corners[k]), key(&face.corners[(k + 1) % face.corners.len()]));
                *balance.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
        let open = balance.iter().filter(|(_, sum)| **sum != 0);
        assert!(open.clone().all(|((a, b), _)| a[2] == 0 && b[2] == 0) && open.count() >= 4);
    }
}
