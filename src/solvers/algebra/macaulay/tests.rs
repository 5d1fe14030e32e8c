use super::super::quaternion::form;
use super::*;
use crate::random::Random;

/// A quadric that three quadrics of rows give: n . R p + c |q|^2 with all its numbers random.
fn random_quadric(random: &mut Random) -> Quadric {
    std::array::from_fn(|_| random.normal())
}

/// The product of two linear forms in the four coordinates.
fn pair_of_planes(a: &[f64; 4], b: &[f64; 4]) -> Quadric {
    MONOMIALS.map(|(i, j)| if i == j { a[i] * b[j] } else { a[i] * b[j] + a[j] * b[i] })
}

#[test]
fn quadrics_at_random_meet_in_points() {
    let mut random = Random::stream(101, 0);
    for _ in 0..30 {
        assert!(meet_in_points(&std::array::from_fn(|_| random_quadric(&mut random))));
    }
}

#[test]
fn quadrics_that_share_a_line_or_a_plane_do_not_meet_in_points() {
    let mut random = Random::stream(102, 0);
    let linear = |random: &mut Random| -> [f64; 4] { std::array::from_fn(|_| random.normal()) };
    for _ in 0..30 {
        let shared = linear(&mut random);
        assert!(!meet_in_points(&std::array::from_fn(|_| pair_of_planes(&shared, &linear(&mut random)))));
        // All vanish where two linear forms do.
        let other = linear(&mut random);
        let through_line = |random: &mut Random| {
            let (one, two) = (pair_of_planes(&shared, &linear(random)), pair_of_planes(&other, &linear(random)));
            std::array::from_fn(|k| one[k] + two[k])
        };
        assert!(!meet_in_points(&std::array::from_fn(|_| through_line(&mut random))));
    }
}

#[test]
fn one_quadric_given_twice_leaves_a_curve() {
    let mut random = Random::stream(103, 0);
    let [a, b] = [random_quadric(&mut random), random_quadric(&mut random)];
    assert!(!meet_in_points(&[a, b, a.map(|v| 3.0 * v)]));
    let sum = std::array::from_fn(|k| a[k] - 2.0 * b[k]);
    assert!(!meet_in_points(&[a, b, sum]));
}

#[test]
fn the_unit_of_a_quadric_changes_nothing() {
    let mut random = Random::stream(104, 0);
    let rows: [(crate::geometry::Vector3<f64>, crate::geometry::Vector3<f64>); 3] =
        std::array::from_fn(|_| (random.direction(), random.normal_vector()));
    let plain = rows.map(|(n, p)| form(&n, &p));
    let answer = meet_in_points(&plain);
    let scaled = [plain[0].map(|v| 1e6 * v), plain[1].map(|v| 1e-6 * v), plain[2]];
    assert_eq!(meet_in_points(&scaled), answer);
}
