use super::*;
use crate::geometry::{Rotation3, distance_derivative};
use crate::random::Random;
use crate::solvers::up::Up;

#[test]
fn the_derivative_of_a_sum_is_the_sum_of_the_derivatives() {
    let mut random = Random::stream(91, 0);
    for _ in 0..50 {
        let (y, z, n) = (random.normal_vector(), random.normal_vector(), random.direction());
        let m = y * n.transpose() + z * n.transpose();
        let (one, other) = (distance_derivative(&y, &n), distance_derivative(&z, &n));
        let found = jacobian_of_sum(&m, &n);
        for k in 0..7 {
            // The shift is felt once, however many points there are.
            let expected = if (3..6).contains(&k) { one[k] } else { one[k] + other[k] };
            assert!((found[k] - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn singular_values_are_those_of_the_derivatives_by_what_is_sought() {
    let mut random = Random::stream(92, 0);
    let up = Up::new(&random.direction(), &random.direction()).unwrap();
    for rows in [9, 300] {
        let all: Vec<Derivative> = (0..rows).map(|_| std::array::from_fn(|_| random.normal())).collect();
        let vertical = up.in_object();
        for (sought, columns) in [(Sought::Rigid, 6), (Sought::Similarity, 7), (Sought::UprightSimilarity(up), 5)] {
            let of = |row: &Derivative, k: usize| match columns {
                5 if k == 0 => Vector3::new(row[0], row[1], row[2]).dot(&vertical),
                5 => row[k + 2],
                _ => row[k],
            };
            let dense = nalgebra::DMatrix::from_fn(rows, columns, |i, k| of(&all[i], k));
            let mut expected: Vec<f64> = dense.singular_values().iter().copied().collect();
            expected.sort_by(|a, b| b.total_cmp(a));
            let found = singular_of(&sought, all.iter().copied()).sorted();
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-10 * expected[0]), "{found:?}");
        }
    }
}

#[test]
fn a_known_up_turns_about_itself() {
    let mut random = Random::stream(93, 0);
    let up = Up::new(&random.direction(), &random.direction()).unwrap();
    let (turn, stretch) = turn_and_stretch(&Sought::UprightSimilarity(up), &[0.3, 0.0, 0.0, 0.0, 0.7]);
    assert!((Rotation3::new(turn) * up.in_object() - up.in_object()).norm() < 1e-12);
    assert!((turn.norm() - 0.3).abs() < 1e-12 && stretch == 0.7);
    assert_eq!(turn_and_stretch(&Sought::Rigid, &[0.1, 0.2, 0.3, 9.0, 9.0, 9.0]), (Vector3::new(0.1, 0.2, 0.3), 0.0));
}
