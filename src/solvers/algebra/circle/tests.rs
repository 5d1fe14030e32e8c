use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn finds_both_angles_of_a_line_through_the_circle() {
    let (points, len) = on_circle(3.0, -4.0, 2.5, 25.0);
    assert_eq!(len, 2);
    for [c, s] in points {
        assert!((3.0 * c - 4.0 * s + 2.5).abs() < 1e-15);
        assert!((c * c + s * s - 1.0).abs() < 1e-15);
    }
}

#[test]
fn a_tangent_gives_one_point_and_a_line_beside_the_circle_none() {
    let (points, len) = on_circle(3.0, 4.0, 5.0, 25.0);
    assert_eq!((points[0], len), ([-0.6, -0.8], 1));
    assert_eq!(on_circle(3.0, 4.0, 5.1, 25.0).1, 0);
    assert_eq!(on_circle(1e-14, 0.0, 0.0, 1.0).1, 0);
    assert_eq!(on_circle(f64::NAN, 4.0, 5.0, 25.0).1, 0);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(22), failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn the_points_are_on_line_and_circle_and_there_are_two_where_the_line_is_nearer_than_the_radius(
        a in -5.0..5.0f64,
        b in -5.0..5.0f64,
        g in -8.0..8.0f64,
    ) {
        let distance = g.abs() / a.hypot(b);
        prop_assume!((distance - 1.0).abs() > 1e-6 && a.hypot(b) > 1e-3);
        let (points, len) = on_circle(a, b, g, a * a + b * b);
        prop_assert_eq!(len, if distance < 1.0 { 2 } else { 0 });
        for [c, s] in &points[..len] {
            prop_assert!((a * c + b * s + g).abs() < 1e-9 && (c * c + s * s - 1.0).abs() < 1e-9);
        }
        if len == 2 {
            let chord = (points[0][0] - points[1][0]).hypot(points[0][1] - points[1][1]);
            prop_assert!((chord - 2.0 * (1.0 - distance * distance).sqrt()).abs() < 1e-7);
        }
    }
}
