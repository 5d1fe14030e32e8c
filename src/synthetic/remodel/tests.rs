use super::*;
use crate::synthetic::Plinth;

fn houses() -> [House; 4] {
    let size = [10.0, 6.0, 8.0];
    let plinth = Plinth { height_m: 3.0, depth_m: 0.5 };
    [House::flat(size), House::gabled(size, 4.0), House::l_shaped(size, [4.0, 2.0]), House::on_plinth(size, plinth)]
        .map(|house| house.turned(0.4).at([30.0, -20.0, 2.0]))
}

#[test]
fn every_plane_is_moved_by_its_own_length_and_stays_flat() {
    for house in houses() {
        let out_m: Vec<f64> = (0..house.faces.len()).map(|i| 0.1 * (i as f64 - 2.5)).collect();
        let moved = house.with_planes_moved(&out_m);
        for ((before, after), out) in house.faces.iter().zip(&moved.faces).zip(&out_m) {
            let n = before.normal();
            for corner in &after.corners {
                assert!((n.dot(&(corner - before.corners[0])) - out).abs() < 1e-9, "{out} {corner}");
            }
        }
    }
}

#[test]
fn walls_stand_inside_the_edge_of_a_roof_that_stays() {
    for house in houses() {
        let built = house.under_eaves(0.4, |_| true);
        for (drawn, face) in house.faces.iter().zip(&built.faces) {
            let off = drawn.normal().dot(&(face.corners[0] - drawn.corners[0]));
            let expected = if drawn.surface == Surface::Wall { -0.4 } else { 0.0 };
            assert!((off - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn a_lid_keeps_the_footprint_and_lies_half_way_up_the_roof() {
    let lid = House::gabled([10.0, 6.0, 8.0], 4.0).as_lid();
    assert_eq!(lid, {
        let mut flat = House::flat([10.0, 6.0, 10.0]);
        // The gabled house names its walls in another order.
        flat.faces.sort_by_key(|face| face.surface == Surface::Roof);
        flat
    });
    let l_shaped = House::l_shaped([10.0, 6.0, 8.0], [4.0, 2.0]);
    assert_eq!(l_shaped.as_lid(), l_shaped);
}

#[test]
fn halves_make_up_the_face() {
    for face in houses().iter().flat_map(|house| &house.faces) {
        let halves = face.halves();
        assert!((halves.iter().map(Face::area).sum::<f64>() - face.area()).abs() < 1e-9);
        assert!(halves.iter().all(|half| (half.normal() - face.normal()).norm() < 1e-9 && half.area() > 0.0));
    }
}

#[test]
fn a_house_shifted_stands_where_it_was_told_and_turns_about_its_middle() {
    for house in houses() {
        let shift = Vector3::new(1.5, -0.5, 0.2);
        let moved = house.clone().shifted(shift, 0.3);
        assert!((moved.middle() - house.middle() - shift).norm() < 1e-9);
        let back = moved.shifted(Vector3::zeros(), -0.3).shifted(-shift, 0.0);
        for (a, b) in house.faces.iter().flat_map(|f| &f.corners).zip(back.faces.iter().flat_map(|f| &f.corners)) {
            assert!((a - b).norm() < 1e-9);
        }
    }
}

#[test]
fn a_house_stretched_up_keeps_its_foot_and_its_walls() {
    for house in houses() {
        let taller = house.clone().stretched_up(1.5);
        let low = house.foot()[0].z;
        for (a, b) in house.faces.iter().flat_map(|f| &f.corners).zip(taller.faces.iter().flat_map(|f| &f.corners)) {
            assert!((a.xy() - b.xy()).norm() < 1e-12 && (b.z - low - 1.5 * (a.z - low)).abs() < 1e-12);
        }
        assert!((taller.middle() - house.middle()).norm() < 1e-12);
    }
}

#[test]
fn planes_moved_by_nothing_leave_the_house() {
    for house in houses() {
        let same = house.with_planes_moved(&vec![0.0; house.faces.len()]);
        for (a, b) in house.faces.iter().flat_map(|f| &f.corners).zip(same.faces.iter().flat_map(|f| &f.corners)) {
            assert!((a - b).norm() < 1e-12);
        }
    }
}
