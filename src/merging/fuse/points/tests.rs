use super::*;
use crate::geometry::{Camera, CameraModel};
use crate::reconstruction::{Image, ImageIndex, Reconstruction};

/// So many points at these places, seen by two cameras from afar.
fn part(points: &[[f64; 3]]) -> Reconstruction {
    let camera = Camera {
        model: CameraModel::SimplePinhole,
        width_px: 1000,
        height_px: 1000,
        params: vec![800.0, 500.0, 500.0],
    };
    let image = |eye: [f64; 3]| Image { cam_from_sfm_translation: -Vector3::from(eye), ..Image::default() };
    let count = points.len() as u32;
    Reconstruction {
        cameras: vec![camera],
        images: vec![image([0.0, 0.0, -10.0]), image([10.0, 0.0, 0.0])],
        points: points.iter().map(|p| Point3::from(*p)).collect(),
        track_starts: (0..=count).map(|k| 2 * k).collect(),
        track_elements: (0..count).flat_map(|k| [(ImageIndex(0), k), (ImageIndex(1), k)]).collect(),
        ..Reconstruction::default()
    }
}

#[test]
fn points_of_two_parts_join_where_they_may_be_one_and_those_of_one_part_never() {
    let (one, other) =
        (part(&[[0.0; 3], [0.001, 0.0, 0.0], [3.0, 0.0, 0.0]]), part(&[[0.0, 0.001, 0.0], [3.0, 1.0, 0.0]]));
    let moved = [Moved::of(&one, None), Moved::of(&other, None)];
    let limits = MergeLimits::default();
    let mut sets = PointSets::of(&moved, &limits);
    let key = |sets: &PointSets<'_>, part: usize, point: u32| sets.key(part, PointIndex(point));
    let (a, b, far) = (key(&sets, 0, 0), key(&sets, 1, 0), key(&sets, 1, 1));
    assert_eq!((sets.count(), sets.part_of(far)), (5, (1, PointIndex(1))));
    assert!(!sets.join(key(&sets, 0, 0), key(&sets, 0, 1)), "two points of one part");
    assert!(!sets.join(key(&sets, 0, 2), far), "a metre apart");
    assert!(sets.join(a, b) && sets.join(b, a));
    assert!(sets.root(a) == sets.root(b) && sets.is_joined(sets.root(a)));
    // The set has a point of the first part already.
    assert!(!sets.join(b, key(&sets, 0, 1)));
}

#[test]
fn a_joined_point_lies_where_the_information_of_all_puts_it() {
    let (one, other) = (part(&[[0.0; 3], [2.0, 2.0, 0.0]]), part(&[[0.002, -0.001, 0.003], [-2.0, 2.0, 0.0]]));
    let moved = [Moved::of(&one, None), Moved::of(&other, None)];
    let limits = MergeLimits::default();
    let mut sets = PointSets::of(&moved, &limits);
    let (a, b) = (sets.key(0, PointIndex(0)), sets.key(1, PointIndex(0)));
    assert!(sets.join(a, b));
    let found = sets.position(sets.root(a));
    // The sum of squares, weighted by the inverse covariances, is least there.
    let loss = |x: &Point3<f64>| -> f64 {
        [a, b]
            .iter()
            .map(|key| {
                let (place, covariance) = sets.uncertainty(*key);
                let bent = covariance + Matrix3::identity() * (sets.bend * sets.bend);
                (x - place).dot(&(bent.try_inverse().unwrap() * (x - place)))
            })
            .sum()
    };
    for aside in [Vector3::x(), Vector3::y(), Vector3::z()] {
        assert!(loss(&(found + aside * 1e-4)) > loss(&found) && loss(&(found - aside * 1e-4)) > loss(&found));
    }
    let alone = sets.key(1, PointIndex(1));
    assert_eq!(sets.position(alone), Point3::new(-2.0, 2.0, 0.0));
}
