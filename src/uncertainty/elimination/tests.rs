use super::*;
use crate::robust::Random;

#[test]
fn what_is_left_is_what_least_squares_with_the_dense_covariance_says() {
    let mut random = Random::stream(5, 0);
    let mut draw = |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| 2.0 * random.unit() - 1.0);
    for (rows, keep, taken, sigma, spread) in [(40, 3, 2, 0.2, 0.1), (25, 5, 4, 0.05, 3.0), (9, 1, 3, 1.0, 1e-3)] {
        let (kept, gone) = (draw(rows, keep), draw(rows, taken));
        let both =
            DMatrix::from_fn(rows, keep + taken, |i, j| if j < keep { kept[(i, j)] } else { gone[(i, j - keep)] });
        let equations = both.transpose() * &both / (sigma * sigma);
        let found = eliminate(&equations, keep, 1.0 / f64::powi(spread, 2)).rest;
        // Errors of the rows are noise and what the unknowns that were taken out put into them.
        let covariance = DMatrix::identity(rows, rows) * (sigma * sigma) + &gone * gone.transpose() * (spread * spread);
        let expected = kept.transpose() * inverse(covariance) * &kept;
        assert!((&found - &expected).norm() < 1e-9 * expected.norm(), "{found} {expected}");
    }
}

#[test]
fn what_nothing_is_known_of_has_no_covariance_to_hand_on() {
    assert_eq!(inverse(DMatrix::zeros(3, 3)), DMatrix::zeros(3, 3));
}

#[test]
fn unknowns_taken_out_one_after_the_other_leave_what_all_at_once_leave() {
    let mut random = Random::stream(71, 0);
    for _ in 0..20 {
        let rows = DMatrix::from_fn(30, 9, |_, _| random.normal());
        let equations = rows.transpose() * &rows;
        let at_once = eliminate(&equations, 4, 0.5);
        let first = eliminate(&equations, 7, 0.5);
        let then = eliminate(&first.rest, 4, 0.5);
        assert!((&at_once.rest - &then.rest).norm() < 1e-9 * at_once.rest.norm());
    }
}

#[test]
fn what_stays_has_the_covariance_that_the_whole_gives_it() {
    let mut random = Random::stream(72, 0);
    let rows = DMatrix::from_fn(40, 8, |_, _| random.normal());
    let equations = rows.transpose() * &rows;
    let (keep, precision) = (3, 2.0);
    let mut whole = equations.clone();
    (keep..8).for_each(|k| whole[(k, k)] += precision);
    let of_whole = inverse(whole).view((0, 0), (keep, keep)).into_owned();
    let found = inverse(eliminate(&equations, keep, precision).rest);
    assert!((&found - &of_whole).norm() < 1e-12);
}
