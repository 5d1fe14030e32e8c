use super::*;
use crate::random::Random;

/// What is meant, row by row against every plane before it.
fn one_by_one(normals: &[Vector3<f64>], offsets: &[f64]) -> Vec<usize> {
    let mut firsts: Vec<usize> = Vec::new();
    let mut plane_of = Vec::new();
    for a in 0..normals.len() {
        let same = |&b: &usize| {
            let sense = if normals[a].dot(&normals[b]) > 0.0 { 1.0 } else { -1.0 };
            let size = offsets[a].abs() + offsets[b].abs();
            parallel(&normals[a], &normals[b]) && (offsets[a] - sense * offsets[b]).abs() <= SAME_PLANE * size
        };
        plane_of.push(firsts.iter().position(same).unwrap_or_else(|| {
            firsts.push(a);
            firsts.len() - 1
        }));
    }
    plane_of
}

#[test]
fn cells_tell_the_planes_that_comparing_all_tells() {
    let base = [
        (Vector3::new(1.0, 0.0, 0.0), 0.0),
        (Vector3::new(0.0, 0.0, 1.0), 5.0),
        (Vector3::new(0.6, 0.0, -0.8), -1e-300),
        (Vector3::new(1.0, 2.0, 3.0).normalize(), 1e200),
        (Vector3::new(-0.3, 0.5, 0.1).normalize(), 0.123),
    ];
    let (mut normals, mut offsets) = (Vec::new(), Vec::new());
    for round in 0..600 {
        let (normal, offset) = base[round % base.len()];
        // Half of the steps stay within the tolerance, half leave it.
        let step = (round as f64 * 0.7).sin() * 2.0 * SAME_PLANE;
        let sense = if round % 3 == 0 { -1.0 } else { 1.0 };
        let moved = (normal + Vector3::new(step, -0.5 * step, 0.3 * step) * f64::from(round % 2 == 0)).normalize();
        normals.push(moved * sense);
        offsets.push(offset * (1.0 + 0.7 * step) * sense);
    }
    let found = SamePlanes::of(&normals, &offsets);
    assert_eq!(found.plane_of, one_by_one(&normals, &offsets));
    assert_eq!(found.planes, 1 + found.plane_of.iter().max().unwrap());
    assert!(found.planes > base.len());
}

#[test]
fn rows_of_one_plane_are_told_whatever_its_sense_and_the_order() {
    let mut random = Random::stream(107, 0);
    for _ in 0..30 {
        let planes: Vec<(Vector3<f64>, f64)> = (0..6).map(|_| (random.direction(), 50.0 * random.normal())).collect();
        let rows: Vec<(usize, f64)> =
            (0..60).map(|_| (random.below(6), if random.unit() < 0.5 { 1.0 } else { -1.0 })).collect();
        let rounded = |v: f64| v * (1.0 + 1e-15);
        let normals: Vec<Vector3<f64>> = rows.iter().map(|(p, sense)| planes[*p].0.map(rounded) * *sense).collect();
        let offsets: Vec<f64> = rows.iter().map(|(p, sense)| rounded(planes[*p].1) * sense).collect();
        let found = SamePlanes::of(&normals, &offsets);
        for i in 0..60 {
            for j in 0..60 {
                assert_eq!(found.plane_of[i] == found.plane_of[j], rows[i].0 == rows[j].0);
            }
        }
        let used: std::collections::BTreeSet<usize> = rows.iter().map(|(p, _)| *p).collect();
        assert_eq!(found.planes, used.len());
    }
}

#[test]
fn planes_are_numbered_as_their_first_rows_come() {
    let (x, y) = (Vector3::x(), Vector3::y());
    let found = SamePlanes::of(&[y, x, -y, x, x], &[1.0, 2.0, -1.0, -2.0, 2.0]);
    assert_eq!((found.plane_of, found.planes), (vec![0, 1, 0, 2, 1], 3));
}
