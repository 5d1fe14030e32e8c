use super::*;
use crate::random::Random;
use crate::solvers::up::Up;

/// Rows of a random scene.
fn rows(random: &mut Random, count: usize) -> Vec<Row> {
    let row = |_| Row { point: random.normal_vector(), normal: random.direction(), offset: random.normal() };
    (0..count).map(row).collect()
}

#[test]
fn the_condition_is_that_of_small_motions() {
    let mut random = Random::stream(108, 0);
    for _ in 0..20 {
        let (rows, rotation) = (rows(&mut random, 9), random.rotation());
        let images: Vec<Vector3<f64>> = rows.iter().map(|row| 1.7 * (rotation * row.point)).collect();
        let mean = images.iter().sum::<Vector3<f64>>() / 9.0;
        let spread = (images.iter().map(|x| (x - mean).norm_squared()).sum::<f64>() / 9.0).sqrt();
        let jacobian = nalgebra::DMatrix::from_fn(9, 7, |i, k| {
            let (y, n) = ((images[i] - mean) / spread, rows[i].normal);
            let step = 1e-6;
            let moved = |by: f64| match k {
                0..3 => {
                    let mut omega = Vector3::zeros();
                    omega[k] = by;
                    crate::geometry::Rotation3::new(omega) * y
                }
                3..6 => {
                    let mut shifted = y;
                    shifted[k - 3] += by;
                    shifted
                }
                _ => y * by.exp(),
            };
            n.dot(&(moved(step) - moved(-step))) / (2.0 * step)
        });
        let singular = jacobian.singular_values();
        let expected = singular.min() / singular.max();
        let found = condition_at(&Sought::Similarity, &rows, 1.7, rotation.matrix());
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

#[test]
fn neither_unit_nor_origin_nor_sense_of_normals_changes_the_condition() {
    let mut random = Random::stream(109, 0);
    let (given, rotation) = (rows(&mut random, 8), random.rotation());
    let up = Up::new(&random.direction(), &random.direction()).unwrap();
    for sought in [Sought::Rigid, Sought::Similarity, Sought::UprightRigid(up), Sought::UprightSimilarity(up)] {
        let plain = condition_at(&sought, &given, 1.0, rotation.matrix());
        let other: Vec<Row> = given
            .iter()
            .map(|row| Row { point: row.point * 1e3 + Vector3::repeat(5e3), normal: row.normal * -7.0, ..*row })
            .collect();
        let found = condition_at(&sought, &other, 1.0, rotation.matrix());
        assert!((found / plain - 1.0).abs() < 1e-9, "{found} {plain}");
    }
}

#[test]
fn what_leaves_a_motion_free_has_the_condition_zero() {
    let mut random = Random::stream(110, 0);
    let (given, rotation) = (rows(&mut random, 9), random.rotation());
    let level: Vec<Row> = given.iter().map(|row| Row { normal: Vector3::z(), ..*row }).collect();
    assert!(condition_at(&Sought::Rigid, &level, 1.0, rotation.matrix()) < 1e-12);
    let one_point: Vec<Row> = given.iter().map(|row| Row { point: Vector3::x(), ..*row }).collect();
    assert_eq!(condition_at(&Sought::Rigid, &one_point, 1.0, rotation.matrix()), 0.0);
    assert_eq!(condition_at(&Sought::Rigid, &given[..5], 1.0, rotation.matrix()), 0.0);
}
