use super::*;
use crate::geometry::{Point3, Rotation3, Similarity};
use crate::random::Random;

/// How far a pose leaves the rows.
fn worst(rows: &[Row], pose: &Similarity) -> f64 {
    let off =
        |row: &Row| (row.normal.dot(&pose.apply(&Point3::from(row.point)).coords) + row.offset) / row.normal.norm();
    rows.iter().map(|row| off(row).abs()).fold(0.0, f64::max)
}

fn pose(random: &mut Random) -> Similarity {
    Similarity { scale: 0.5 + random.unit(), rotation: random.rotation(), translation: 4.0 * random.normal_vector() }
}

#[test]
fn every_kind_of_pair_is_satisfied_by_the_pose_that_made_it() {
    let mut random = Random::stream(94, 0);
    for _ in 0..40 {
        let truth = pose(&mut random);
        let inverse = truth.inverse();
        let back = |x: &Vector3<f64>| inverse.apply(&Point3::from(*x)).coords;
        let (x, v) = (5.0 * random.normal_vector(), random.direction());
        let across = v.cross(&random.direction()).normalize();
        let plane = ObjectPrimitive::Plane { normal: across * 2.0, offset: -2.0 * across.dot(&x) };
        let line = ObjectPrimitive::Line { point: x, direction: v * 3.0 };
        let seen_line = SensorPrimitive::Line { point: back(&(x + v)), direction: inverse.rotation * v * -0.5 };
        let normal = inverse.rotation * across;
        let seen_plane = SensorPrimitive::Plane { normal: normal * 7.0, offset: -7.0 * normal.dot(&back(&x)) };
        let pairs = [
            (SensorPrimitive::Point(back(&x)), plane),
            (SensorPrimitive::Point(back(&x)), line),
            (SensorPrimitive::Point(back(&x)), ObjectPrimitive::Point(x)),
            (seen_line, plane),
            (seen_line, line),
            (seen_plane, plane),
        ];
        let counts = [1, 2, 3, 2, 4, 3];
        for (pair, count) in pairs.into_iter().zip(counts) {
            let rows = rows_of(&[pair]).unwrap();
            assert_eq!(rows.len(), count, "{pair:?}");
            assert!(worst(&rows, &truth) < 1e-10, "{pair:?}");
            // Another pose does not satisfy them.
            let other = Similarity { rotation: Rotation3::new(Vector3::new(0.3, 0.2, -0.1)) * truth.rotation, ..truth };
            let other = Similarity { translation: other.translation + Vector3::new(0.5, -0.3, 0.7), ..other };
            assert!(worst(&rows, &other) > 1e-4, "{pair:?}");
        }
    }
}

#[test]
fn pairs_the_wrong_way_round_and_without_a_direction_are_named() {
    let point = SensorPrimitive::Point(Vector3::x());
    let line = SensorPrimitive::Line { point: Vector3::x(), direction: Vector3::y() };
    let plane = SensorPrimitive::Plane { normal: Vector3::z(), offset: 1.0 };
    let on_plane = ObjectPrimitive::Plane { normal: Vector3::z(), offset: 0.0 };
    let on_line = ObjectPrimitive::Line { point: Vector3::zeros(), direction: Vector3::z() };
    let on_point = ObjectPrimitive::Point(Vector3::zeros());
    for wrong in [(line, on_point), (plane, on_point), (plane, on_line)] {
        assert_eq!(rows_of(&[(point, on_plane), wrong]), Err(PrimitiveError::Exchanged(1)));
    }
    let nowhere = [
        (SensorPrimitive::Line { point: Vector3::x(), direction: Vector3::zeros() }, on_plane),
        (SensorPrimitive::Plane { normal: Vector3::zeros(), offset: 1.0 }, on_plane),
        (point, ObjectPrimitive::Plane { normal: Vector3::zeros(), offset: 1.0 }),
        (point, ObjectPrimitive::Line { point: Vector3::x(), direction: Vector3::zeros() }),
    ];
    for pair in nowhere {
        assert_eq!(rows_of(&[pair]), Err(PrimitiveError::NoDirection(0)));
    }
}
