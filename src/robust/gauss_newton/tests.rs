use super::*;

const PARAMETERS: MotionParameters =
    MotionParameters { center: Point3::new(3.0, -2.0, 1.0), radius: 10.0, motion: Motion::Similarity };
const RIGID: MotionParameters = MotionParameters { motion: Motion::Rigid, ..PARAMETERS };

#[test]
fn row_is_the_derivative_of_the_distance() {
    let x = Point3::new(7.0, 4.0, -3.0);
    let n = Vector3::new(0.48, -0.6, 0.64);
    let row = PARAMETERS.row(&x, &n);
    for k in 0..7 {
        let mut unknowns = Vector7::zeros();
        unknowns[k] = 1e-6;
        let moved = PARAMETERS.moved(&Similarity::identity(), &unknowns).apply(&x);
        assert!((n.dot(&(moved - x)) / 1e-6 - row[k]).abs() < 1e-6, "unknown {k}");
    }
}

#[test]
fn the_motion_between_two_poses_leads_from_one_to_the_other() {
    let from = Similarity { scale: 2.0, ..Similarity::identity() };
    let unknowns = Vector7::from_column_slice(&[0.3, -0.1, 0.2, 1.0, 2.0, -0.5, 0.4]);
    let found = PARAMETERS.between(&from, &PARAMETERS.moved(&from, &unknowns));
    assert!((found - unknowns).norm() < 1e-12, "{found}");
}

/// Rows of a level plane.
fn of_a_floor() -> NormalEquations {
    let mut sums = NormalEquations::default();
    for (x, y) in [(0.0, 0.0), (5.0, 1.0), (-3.0, 4.0), (2.0, -6.0)] {
        let p = PARAMETERS.center + Vector3::new(x, y, 0.0);
        sums.add(&PARAMETERS.row(&p, &Vector3::z()), 0.5, 100.0);
    }
    sums
}

#[test]
fn moves_only_what_is_held() {
    let step = PARAMETERS.step(&of_a_floor(), 1.0);
    assert!((step[5] + 0.5).abs() < 1e-9, "{step}");
    assert!(step.iter().enumerate().all(|(k, v)| k == 5 || v.abs() < 1e-9), "{step}");
}

#[test]
fn a_rigid_motion_has_no_direction_of_scale_and_keeps_the_scale_to_the_bit() {
    // Rows that would like another scale above all.
    let mut sums = of_a_floor();
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        for side in [4.0, -4.0] {
            let place = PARAMETERS.center + axis * side;
            sums.add(&RIGID.row(&place, &(axis * side.signum())), 0.4, 100.0);
        }
    }
    let spectrum = RIGID.spectrum(&sums.full());
    assert_eq!(spectrum.directions().len(), 6);
    assert!(spectrum.directions().iter().all(|d| d.unit[6] == 0.0));
    assert!(PARAMETERS.step(&sums, f64::INFINITY)[6].abs() > 0.1);
    let pose = Similarity { scale: 0.1 + 0.2, ..Similarity::identity() };
    let moved = RIGID.moved(&pose, &RIGID.step(&sums, f64::INFINITY));
    assert_eq!(moved.scale.to_bits(), pose.scale.to_bits());
}

#[test]
fn the_loosest_direction_comes_first_and_what_nothing_holds_is_infinitely_loose() {
    let spectrum = PARAMETERS.spectrum(&of_a_floor().full());
    let sigmas: Vec<f64> = spectrum.directions().iter().map(|d| d.sigma_m).collect();
    assert!(sigmas.is_sorted_by(|a, b| a >= b) && sigmas.len() == 7, "{sigmas:?}");
    assert!(sigmas[0] > 1e3 && sigmas[6] < 0.1, "{sigmas:?}");
}

/// Rows in random places and directions, their residuals, and weights.
fn rows(seed: u64, count: usize) -> Vec<(Vector7, f64, f64)> {
    let mut random = crate::random::Random::stream(seed, 0);
    (0..count)
        .map(|_| {
            let place = PARAMETERS.center + 8.0 * random.normal_vector();
            (PARAMETERS.row(&place, &random.direction()), 0.1 * random.normal(), 0.5 + random.unit())
        })
        .collect()
}

fn sums_of(rows: &[(Vector7, f64, f64)]) -> NormalEquations {
    let mut sums = NormalEquations::default();
    rows.iter().for_each(|(row, residual, weight)| sums.add(row, *residual, *weight));
    sums
}

#[test]
fn the_step_is_the_least_squares_of_the_dense_rows() {
    for seed in 0..20 {
        let rows = rows(seed, 40);
        let dense = nalgebra::DMatrix::from_fn(40, 7, |i, k| rows[i].2.sqrt() * rows[i].0[k]);
        let right = nalgebra::DVector::from_fn(40, |i, _| -rows[i].2.sqrt() * rows[i].1);
        let expected = dense.svd(true, true).solve(&right, 1e-12).unwrap();
        let step = PARAMETERS.step(&sums_of(&rows), f64::INFINITY);
        assert!((step - Vector7::from_column_slice(expected.as_slice())).norm() < 1e-9, "{step} {expected}");
    }
}

#[test]
fn sums_of_two_halves_are_those_of_the_whole() {
    let rows = rows(4, 30);
    let (whole, mut halves) = (sums_of(&rows), sums_of(&rows[..11]));
    halves.merge(&sums_of(&rows[11..]), 1.0);
    assert!((whole.full() - halves.full()).norm() < 1e-12 && (whole.gradient - halves.gradient).norm() < 1e-12);
    let mut twice = NormalEquations::default();
    twice.merge(&whole, 2.0);
    assert!((twice.full() - whole.full() * 2.0).norm() < 1e-12);
}

#[test]
fn directions_put_the_information_together_again() {
    for parameters in [PARAMETERS, RIGID] {
        let full = sums_of(&rows(9, 25)).full();
        let spectrum = parameters.spectrum(&full);
        let mut again = Matrix7::zeros();
        for direction in spectrum.directions() {
            again += direction.unit * direction.unit.transpose() / (direction.sigma_m * direction.sigma_m);
        }
        let unknowns = parameters.motion.unknowns();
        let off = (again - full).view((0, 0), (unknowns, unknowns)).norm();
        assert!(off < 1e-9 * full.norm(), "{off}");
        assert!(spectrum.directions().windows(2).all(|two| two[0].sigma_m >= two[1].sigma_m));
    }
}

#[test]
fn a_motion_there_and_back_leaves_the_pose() {
    let mut random = crate::random::Random::stream(8, 0);
    for _ in 0..50 {
        let from = Similarity {
            scale: 0.5 + random.unit(),
            rotation: random.rotation(),
            translation: 5.0 * random.normal_vector(),
        };
        let unknowns = Vector7::from_fn(|_, _| random.normal());
        let to = PARAMETERS.moved(&from, &unknowns);
        let found = PARAMETERS.moved(&from, &PARAMETERS.between(&from, &to));
        let x = Point3::new(1.0, 2.0, -1.0);
        assert!((found.apply(&x) - to.apply(&x)).norm() < 1e-9);
    }
}
