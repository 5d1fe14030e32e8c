use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn the_smallest_singular_value_keeps_its_digits() {
    // Orthogonal columns of lengths 3, 1e-9 and 2, mixed by a rotation in the plane of the first two.
    let (c, s) = (0.6, 0.8);
    let rows = [[3.0 * c, -3.0 * s, 0.0], [1e-9 * s, 1e-9 * c, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]];
    let sorted = Singular::of(&rows).sorted();
    assert!((sorted[0] - 3.0).abs() < 1e-15 && (sorted[1] - 2.0).abs() < 1e-15);
    assert!((sorted[2] / 1e-9 - 1.0).abs() < 1e-6, "{sorted:?}");
}

#[test]
fn least_squares_leaves_a_residual_orthogonal_to_the_columns() {
    let rows = [[1.0, 2.0], [3.0, -1.0], [0.5, 0.25], [2.0, 2.0]];
    let b = [1.0, 2.0, 3.0, 4.0];
    let x = Singular::of(&rows).least_squares(&b, 1e-13);
    for j in 0..2 {
        let slope: f64 = rows.iter().zip(b).map(|(row, b)| row[j] * (row[0] * x[0] + row[1] * x[1] - b)).sum();
        assert!(slope.abs() < 1e-14);
    }
}

/// A matrix of so many rows and four columns.
fn matrix() -> impl Strategy<Value = Vec<[f64; 4]>> {
    prop::collection::vec(prop::array::uniform4(-3.0..3.0f64), 4..9)
}

fn dense(rows: &[[f64; 4]]) -> nalgebra::DMatrix<f64> {
    nalgebra::DMatrix::from_fn(rows.len(), 4, |i, j| rows[i][j])
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(25), failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn singular_values_are_those_of_another_method(rows in matrix()) {
        let found = Singular::of(&rows);
        let mut expected: Vec<f64> = dense(&rows).singular_values().iter().copied().collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        for (a, b) in found.sorted().iter().zip(&expected) {
            prop_assert!((a - b).abs() < 1e-11 * expected[0]);
        }
        prop_assert!(found.largest() == found.sorted()[0] && found.smallest() == found.sorted()[3]);
    }

    #[test]
    fn least_squares_is_that_of_another_method(rows in matrix(), right in prop::collection::vec(-3.0..3.0f64, 9)) {
        let found = Singular::of(&rows);
        prop_assume!(found.smallest() > 1e-3);
        let b = nalgebra::DVector::from_column_slice(&right[..rows.len()]);
        let expected = dense(&rows).svd(true, true).solve(&b, 1e-13).unwrap();
        for (x, y) in found.least_squares(&right[..rows.len()], 1e-13).iter().zip(expected.iter()) {
            prop_assert!((x - y).abs() < 1e-8 * (1.0 + y.abs()));
        }
    }

    #[test]
    fn of_a_lost_rank_the_shortest_solution_is_taken(rows in matrix(), share in -2.0..2.0f64, right in prop::collection::vec(-3.0..3.0f64, 9)) {
        let rows: Vec<[f64; 4]> = rows.iter().map(|r| [r[0], r[1], r[2], share * r[0]]).collect();
        let found = Singular::of(&rows);
        prop_assert!(found.smallest() < 1e-12 * found.largest());
        prop_assume!(found.sorted()[2] > 1e-2);
        let x = found.least_squares(&right[..rows.len()], 1e-10);
        // Nothing along what the matrix does not see: (share, 0, 0, -1).
        prop_assert!((share * x[0] - x[3]).abs() < 1e-9);
    }
}
