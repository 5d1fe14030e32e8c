use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;

/// An outline alone.
fn triangulate(ring: &[[f64; 2]]) -> Option<Triangles> {
    super::triangulate(ring, &[ring.len()])
}

/// Area of the triangles; all run counter-clockwise.
fn area(ring: &[[f64; 2]]) -> Option<f64> {
    let made = triangulate(ring)?;
    let points = [ring, &made.crossings].concat();
    let areas = made.triangles.iter().map(|&[a, b, c]| doubled_area(points[a], points[b], points[c]) / 2.0);
    assert!(areas.clone().all(|area| area >= 0.0));
    Some(areas.sum())
}

fn overlaps(ring: &[[f64; 2]]) -> bool {
    triangulate(ring).unwrap().overlaps
}

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];

#[test]
fn concave_rings_keep_their_area() {
    let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    assert_eq!(area(&l), Some(6.0));
    assert_eq!(triangulate(&l).unwrap().triangles.len(), 4);
    assert!(!overlaps(&l));
}

#[test]
fn a_star_of_many_corners_keeps_its_area() {
    let star: Vec<[f64; 2]> = (0..2000)
        .map(|at| {
            let (sin, cos) = (f64::from(at) * std::f64::consts::TAU / 2000.0).sin_cos();
            let radius = if at % 2 == 0 { 10.0 } else { 4.0 };
            [radius * cos, radius * sin]
        })
        .collect();
    let expected = 1000.0 * 10.0 * 4.0 * (std::f64::consts::TAU / 2000.0).sin();
    assert!((area(&star).unwrap() - expected).abs() < 1e-9 * expected);
    assert_eq!(triangulate(&star).unwrap().triangles.len(), 1998);
}

/// Of 4,000 corners and one kink, in which two neighbours stand in each other's place.
#[test]
fn a_long_outline_with_a_kink_is_kept() {
    let mut ring: Vec<[f64; 2]> = (0..4000)
        .map(|at| {
            let (sin, cos) = (f64::from(at) * std::f64::consts::TAU / 4000.0).sin_cos();
            [100.0 * cos, 100.0 * sin]
        })
        .collect();
    let whole = area(&ring).unwrap();
    ring.swap(1000, 1001);
    assert!((area(&ring).unwrap() / whole - 1.0).abs() < 1e-5);
    assert!(overlaps(&ring));
}

#[test]
fn a_bridged_hole_stays_a_hole() {
    let hole = [[2.0, 2.0], [2.0, 4.0], [4.0, 4.0], [4.0, 2.0], [2.0, 2.0]];
    let ring = [&SQUARE[..], &SQUARE[..1], &hole].concat();
    assert_eq!(area(&ring), Some(96.0));
    assert!(!overlaps(&ring));
}

#[test]
fn a_hole_that_shares_part_of_an_edge_stays_a_hole() {
    let hole = [[4.0, 0.0], [4.0, 2.0], [7.0, 2.0], [7.0, 0.0], [4.0, 0.0]];
    let ring = [&SQUARE[..1], &hole, &SQUARE[1..]].concat();
    assert_eq!(area(&ring), Some(94.0));
}

#[test]
fn a_spike_covers_nothing() {
    let ring = [&SQUARE[..2], &[[15.0, 0.0]], &SQUARE[1..]].concat();
    assert_eq!(area(&ring), Some(100.0));
    assert!(!overlaps(&ring));
}

#[test]
fn corners_on_an_edge_and_repeated_places_change_nothing() {
    let ring = [&SQUARE[..1], &[[3.0, 0.0], [6.0, 0.0], [6.0, 0.0]], &SQUARE[1..], &SQUARE[..1]].concat();
    assert_eq!(area(&ring), Some(100.0));
}

#[test]
fn a_ring_that_crosses_itself_keeps_what_lies_inside_an_odd_number_of_times() {
    // Two squares of 1 and 9 that meet in a crossing.
    let ring = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [4.0, 4.0], [4.0, 3.0], [0.0, 3.0]];
    assert!((area(&ring).unwrap() - 10.0).abs() < 1e-12);
    assert!(overlaps(&ring));
}

#[test]
fn a_ball_of_wool_is_given_up_soon() {
    let at = |step: u64| (step * 7919 % 1999) as f64;
    let ring: Vec<[f64; 2]> = (0..1999).map(|step| [at(step), at(step * step)]).collect();
    assert!(triangulate(&ring).is_none());
}

/// Quadratic in the corners, each of these would take minutes.
#[test]
fn rings_of_many_corners_take_about_linear_time() {
    let count = 200_000;
    let steps = |count: usize| (0..count).map(move |at| at as f64 / count as f64);
    // Both long edges of a wall full of corners, as it stands and turned, so that rounding bends the lines.
    let wall: Vec<[f64; 2]> =
        steps(count / 2).map(|t| [t, 0.0]).chain(steps(count / 2).map(|t| [1.0 - t, 3e-3])).collect();
    let (sin, cos) = 0.3_f64.sin_cos();
    let turned: Vec<[f64; 2]> = wall.iter().map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect();
    // One corner off a line; a comb; a circle; triangles that all meet in one corner; spikes out of one corner.
    let apex: Vec<[f64; 2]> = steps(count).map(|t| [t, 0.0]).chain([[0.5, 1.0]]).collect();
    let comb: Vec<[f64; 2]> =
        (0..count).map(|at| [at as f64, (at % 2) as f64]).chain([[count as f64, 9.0], [0.0, 9.0]]).collect();
    let circle: Vec<[f64; 2]> = steps(count).map(|t| (t * std::f64::consts::TAU).sin_cos().into()).collect();
    let on_rim = |at: usize| <[f64; 2]>::from((3.0 * at as f64 / count as f64).sin_cos()).map(|v| 2.0 * v);
    let flower: Vec<[f64; 2]> =
        (0..count / 3).flat_map(|at| [[0.0, 0.0], on_rim(3 * at + 1), on_rim(3 * at)]).collect();
    let spikes: Vec<[f64; 2]> =
        SQUARE.into_iter().chain((0..count / 2).flat_map(|at| [[0.0, 0.0], on_rim(at)])).collect();
    for (name, ring, expected) in [
        ("wall", wall, 3e-3),
        ("turned", turned, 3e-3),
        ("apex", apex, 0.5),
        ("comb", comb, 8.5 * count as f64),
        ("circle", circle, std::f64::consts::PI),
        ("flower", flower, 2.0),
        ("spikes", spikes, 100.0),
    ] {
        let covered = area(&ring).unwrap_or_else(|| panic!("{name} is given up"));
        assert!((covered - expected).abs() < 1e-4 * expected, "{name}: {covered}");
    }
}

#[test]
fn a_line_walked_up_and_down_is_given_up_soon() {
    let count = 50_000;
    let line = (0..count).map(|at| if at % 2 == 0 { [at as f64, 0.0] } else { [(count - at) as f64, 0.0] });
    let ring: Vec<[f64; 2]> = line.chain([[0.0, 1.0]]).collect();
    assert!(triangulate(&ring).is_none());
}

#[test]
fn no_ring_makes_it_panic() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for round in 0..3000 {
        let corners = 3 + random.next_u64() % 9;
        // A coarse grid makes collinear, repeated and touching corners the rule.
        let grid = if round % 2 == 0 { 5.0 } else { 1e6 };
        let mut coordinate = || (grid * (random.next_u64() as f64 / u64::MAX as f64)).round();
        let ring: Vec<[f64; 2]> = (0..corners).map(|_| [coordinate(), coordinate()]).collect();
        area(&ring);
    }
}

use proptest::test_runner::RngSeed;

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(5), failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn a_ring_that_does_not_cross_itself_has_the_area_of_its_corners(
        radii in prop::collection::vec(0.2..10.0f64, 3..40),
        shift in prop::array::uniform2(-1e3..1e3f64),
    ) {
        // Corners at rising angles about one point never cross.
        let step = std::f64::consts::TAU / radii.len() as f64;
        let corner = |(k, r): (usize, &f64)| {
            let (sin, cos) = (step * k as f64).sin_cos();
            [shift[0] + r * cos, shift[1] + r * sin]
        };
        let ring: Vec<[f64; 2]> = radii.iter().enumerate().map(corner).collect();
        let twice: f64 = (0..ring.len())
            .map(|k| {
                let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
                (a[0] - shift[0]) * (b[1] - shift[1]) - (b[0] - shift[0]) * (a[1] - shift[1])
            })
            .sum();
        let made = area(&ring).unwrap();
        prop_assert!((made - twice / 2.0).abs() < 1e-6 * twice, "{} {}", made, twice / 2.0);
        prop_assert!(!overlaps(&ring));
    }
}

/// The square and holes of their own: triangles, their area, and whether something overlaps.
fn with_holes(holes: &[&[[f64; 2]]]) -> (usize, f64, bool) {
    let rings: Vec<&[[f64; 2]]> = std::iter::once(&SQUARE[..]).chain(holes.iter().copied()).collect();
    let points = rings.concat();
    let ends: Vec<usize> = (1..=rings.len()).map(|count| rings[..count].concat().len()).collect();
    let made = super::triangulate(&points, &ends).unwrap();
    let points = [points, made.crossings].concat();
    let areas = made.triangles.iter().map(|&[a, b, c]| doubled_area(points[a], points[b], points[c]) / 2.0);
    (made.triangles.len(), areas.sum(), made.overlaps)
}

const HOLE: [[f64; 2]; 4] = [[2.0, 2.0], [2.0, 4.0], [4.0, 4.0], [4.0, 2.0]];

#[test]
fn holes_of_their_own_stay_open_whichever_way_round_they_run() {
    let backwards: Vec<_> = HOLE.iter().rev().copied().collect();
    assert_eq!(with_holes(&[&HOLE]), (8, 96.0, false));
    assert_eq!(with_holes(&[&backwards]), (8, 96.0, false));
    let other = HOLE.map(|[x, y]| [x + 4.0, y + 4.0]);
    assert_eq!(with_holes(&[&HOLE, &other]), (14, 92.0, false));
}

#[test]
fn a_hole_that_touches_the_outline_or_another_hole_in_a_corner_is_clean() {
    assert_eq!(with_holes(&[&[[0.0, 0.0], [4.0, 2.0], [2.0, 4.0]]]).1, 94.0);
    let beside = [[4.0, 4.0], [4.0, 6.0], [6.0, 6.0], [6.0, 4.0]];
    let (_, area, overlaps) = with_holes(&[&HOLE, &beside]);
    assert_eq!((area, overlaps), (92.0, false));
}

#[test]
fn holes_that_stick_out_or_overlap_or_repeat_are_told() {
    for (holes, area) in [
        (vec![HOLE.map(|[x, y]| [x - 3.0, y])], 98.0 + 2.0),
        (vec![HOLE.map(|[x, y]| [x + 20.0, y])], 104.0),
        (vec![HOLE, HOLE.map(|[x, y]| [x + 1.0, y])], 100.0 - 4.0),
        (vec![HOLE, HOLE], 100.0),
    ] {
        let holes: Vec<&[[f64; 2]]> = holes.iter().map(|hole| &hole[..]).collect();
        let found = with_holes(&holes);
        assert!((found.1 - area).abs() < 1e-9 && found.2, "{found:?}, expected {area}");
    }
}

/// Corners on an ellipse, which are convex whatever the shares of the way round are, with digits as files have them.
fn convex() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let shares = proptest::collection::vec(0.05_f64..1.0, 3..=12);
    (shares, 1.0_f64..40.0, 1.0_f64..40.0, 0.0_f64..TAU).prop_map(|(shares, wide, high, turn)| {
        let whole: f64 = shares.iter().sum();
        let mut along = turn;
        let mut corner = |share: f64| {
            along += share / whole * TAU;
            [wide * along.cos(), high * along.sin()].map(|v| (v * 1000.0).round() / 1000.0)
        };
        let mut ring: Vec<[f64; 2]> = shares.into_iter().map(&mut corner).collect();
        ring.dedup();
        ring
    })
}

proptest! {
    #[test]
    fn a_fan_of_a_convex_outline_covers_what_the_mesh_covers(ring in convex()) {
        let by_mesh = triangulate(&ring).unwrap();
        if let Some(fan) = convex_fan(&ring, 1e-3) {
            let areas: Vec<f64> = fan.map(|[a, b, c]| doubled_area(ring[a], ring[b], ring[c]) / 2.0).collect();
            let covered = area(&ring).unwrap();
            prop_assert!(areas.iter().all(|area| *area > 0.0));
            prop_assert!((areas.iter().sum::<f64>() - covered).abs() < 1e-9 * (1.0 + covered));
            prop_assert!(!by_mesh.overlaps && by_mesh.crossings.is_empty());
            prop_assert_eq!(areas.len(), ring.len() - 2);
        } else {
            // Three corners in line are the least that a file's digits leave of a triangle.
            prop_assert!(area(&ring).unwrap() < 1.0);
        }
    }

    #[test]
    fn a_fan_of_any_outline_is_none_or_covers_it_without_overlaps(ring in proptest::collection::vec([-9..9_i32, -9..9_i32], 3..9)) {
        let ring: Vec<[f64; 2]> = ring.into_iter().map(|corner| corner.map(f64::from)).collect();
        if let Some(fan) = convex_fan(&ring, 1e-3) {
            let fan: f64 = fan.map(|[a, b, c]| doubled_area(ring[a], ring[b], ring[c]) / 2.0).sum();
            prop_assert_eq!(area(&ring), Some(fan));
            prop_assert!(!overlaps(&ring));
        }
    }
}

#[test]
fn a_fan_begins_where_its_smallest_triangle_is_largest() {
    let gable = [[0.0, 0.0], [8.0, 0.0], [8.0, 6.0], [4.0, 9.0], [0.0, 6.0]];
    let fan: Vec<[usize; 3]> = convex_fan(&gable, 1e-3).unwrap().collect();
    assert_eq!(fan, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let low_eaves = [[0.0, 0.0], [8.0, 0.0], [8.0, 1.0], [4.0, 9.0], [0.0, 1.0]];
    let fan: Vec<[usize; 3]> = convex_fan(&low_eaves, 1e-3).unwrap().collect();
    assert_eq!(fan, [[2, 3, 4], [2, 4, 0], [2, 0, 1]]);
    // Corners in the middle of an edge, to the file's digits in or out.
    for off in [-4e-4, 0.0, 4e-4] {
        let wall = [[0.0, 0.0], [4.0, off], [8.0, 0.0], [8.0, 6.0], [4.0, 6.0 + off], [0.0, 6.0]];
        let fan = convex_fan(&wall, 1e-3).unwrap();
        assert!(fan.map(|[a, b, c]| doubled_area(wall[a], wall[b], wall[c])).all(|area| area > 1.0));
    }
}

#[test]
fn what_is_not_convex_has_no_fan() {
    let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let star = [0, 2, 4, 1, 3].map(|at| {
        let (sin, cos) = (f64::from(at) * TAU / 5.0).sin_cos();
        [cos, sin]
    });
    let clockwise = [SQUARE[3], SQUARE[2], SQUARE[1], SQUARE[0]];
    for ring in [&l[..], &star, &clockwise, &[SQUARE, SQUARE].concat()] {
        assert!(convex_fan(ring, 1e-3).is_none(), "{ring:?}");
    }
}
