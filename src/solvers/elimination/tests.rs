use super::*;

#[test]
fn triangular_rows_keep_the_solutions_of_the_rows() {
    let x = [0.3, -1.2, 2.5];
    let mut rows = [[1.0, 2.0, -0.5, 0.0], [0.0, 1.5, 4.0, 0.0], [-3.0, 0.2, 0.7, 0.0], [0.4, 0.1, 0.9, 0.0]];
    for row in &mut rows {
        row[3] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
    }
    triangular(&mut rows, 3);
    assert!(rows[3].iter().all(|v| v.abs() < 1e-15), "{rows:?}");
    for (k, row) in rows[..3].iter().enumerate() {
        assert!(row[..k].iter().all(|&v| v == 0.0));
        assert!((row[0] * x[0] + row[1] * x[1] + row[2] * x[2] - row[3]).abs() < 1e-14);
    }
}

#[test]
fn scale_and_translation_come_back_at_the_rotation() {
    let (scale, translation) = (1.7, [0.3, -1.2]);
    let mut rows = [[1.0, 2.0, 0.0, 0.7], [0.3, 1.5, 0.0, -2.0], [-3.0, 0.2, 0.0, 1.1], [0.4, 0.1, 0.0, 0.2]];
    for row in &mut rows {
        row[2] = -(row[0] * translation[0] + row[1] * translation[1] + scale * row[3]);
    }
    let eliminated = Eliminated::<2, 4, 4>::new(rows, Scale::Sought).unwrap();
    let [equation] = eliminated.equations();
    assert!(equation.iter().all(|v| v.abs() < 1e-15), "{equation:?}");
    let (found_scale, found) = eliminated.scale_and_translation(|row| row[3]).unwrap();
    assert!((found_scale - scale).abs() < 1e-14);
    assert!(found.iter().zip(translation).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[test]
fn a_column_of_zeros_is_passed_over() {
    let mut rows = [[0.0, 1.0], [0.0, 2.0]];
    triangular(&mut rows, 1);
    assert_eq!(rows, [[0.0, 1.0], [0.0, 2.0]]);
    assert!(Eliminated::<1, 2, 2>::new(rows, Scale::Given).is_none());
}

/// Some rows of six numbers.
fn some_rows(seed: u64) -> [[f64; 6]; 5] {
    let mut random = crate::random::Random::stream(seed, 0);
    std::array::from_fn(|_| std::array::from_fn(|_| random.normal()))
}

#[test]
fn reflections_keep_the_lengths_and_products_of_columns() {
    for seed in 0..50 {
        let (before, mut after) = (some_rows(seed), some_rows(seed));
        triangular(&mut after, 3);
        for i in 0..6 {
            for j in 0..6 {
                let product = |rows: &[[f64; 6]; 5]| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
                assert!((product(&before) - product(&after)).abs() < 1e-12);
            }
        }
        for k in 0..3 {
            assert!(after[k + 1..].iter().all(|row| row[k].abs() < 1e-12), "{after:?}");
        }
    }
}
