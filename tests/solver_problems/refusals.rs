//! Edges, vertices, twins, and what is refused.

use super::*;

#[test]
fn three_points_on_edges_are_enough() {
    let mut random = Random::stream(8, 0);
    for _ in 0..20 {
        let truth = pose(&mut random, &Sought::Rigid);
        let mut rows = Vec::new();
        for _ in 0..3 {
            let x = random.in_cube();
            let planes = [random.direction(), random.direction()].map(|n| (n, -n.dot(&x)));
            rows.extend(Row::on_edge(truth.inverse().apply(&x.into()).coords, planes));
        }
        let poses = cityweld::solvers::se3_6pt(rows[..].try_into().unwrap());
        let error = poses.iter().map(|p| angle_between_rad(&p.rotation, &truth.rotation)).fold(9.0, f64::min);
        assert!(error < 1e-8, "{error:e}");
    }
}

#[test]
fn a_box_corner_has_four_poses_and_level_ground_with_two_walls_has_two() {
    let mut random = Random::stream(9, 0);
    let skew = Vector3::new(0.6, 0.8, 0.0);
    for (normals, expected) in
        [([Vector3::x(), Vector3::y(), Vector3::z()], 4), ([Vector3::x(), skew, Vector3::z()], 2)]
    {
        let truth = pose(&mut random, &Sought::Rigid);
        let mut rows = Vec::new();
        for n in normals {
            for _ in 0..3 {
                let x = random.on_plane(&(n, -7.0));
                rows.push(Row { point: truth.inverse().apply(&x.into()).coords, normal: n, offset: -7.0 });
            }
        }
        assert_eq!(solve(&Sought::Rigid, &rows).unwrap().len(), expected);
        let minimal = cityweld::solvers::se3_333(rows[..].try_into().unwrap());
        assert_eq!(minimal.len(), expected);
    }
}

#[test]
fn turning_or_moving_either_frame_moves_the_poses_with_it() {
    let mut random = Random::stream(10, 0);
    let case = sample(&mut random, &Sought::Similarity, &[2, 2, 2, 1]);
    let shift = pose(&mut random, &Sought::Rigid);
    let moved: Vec<Row> = case
        .rows
        .iter()
        .map(|row| {
            let normal = shift.rotation * row.normal;
            Row { point: row.point, normal, offset: row.offset - normal.dot(&shift.translation) }
        })
        .collect();
    let (before, after) =
        (solve(&Sought::Similarity, &case.rows).unwrap(), solve(&Sought::Similarity, &moved).unwrap());
    assert_eq!(before.len(), after.len());
    for solution in &before {
        let expected = shift * solution.object_from_sensor;
        let near = after.iter().map(|s| (s.object_from_sensor.translation - expected.translation).norm());
        assert!(near.fold(f64::INFINITY, f64::min) < 1e-8);
        let condition = after.iter().map(|s| (s.condition / solution.condition - 1.0).abs());
        assert!(condition.fold(f64::INFINITY, f64::min) < 1e-6, "the condition moved with the origin");
    }
}

#[test]
fn walls_without_ground_are_refused_with_their_reason() {
    let mut random = Random::stream(12, 0);
    let mut rows = sample(&mut random, &Sought::Rigid, &[2, 2, 1, 1]).rows;
    for row in &mut rows {
        row.normal = Vector3::new(row.normal.x, row.normal.y, 0.0).normalize();
    }
    assert_eq!(solve(&Sought::Rigid, &rows), Err(Degeneracy::CoplanarNormals));
    let rows = sample(&mut random, &Sought::Rigid, &[3, 2]).rows;
    assert!(matches!(solve(&Sought::Rigid, &rows), Err(Degeneracy::TooFewRows { rows: 5, unknowns: 6 })));
    let rows = sample(&mut random, &Sought::Similarity, &[3, 3, 3]).rows;
    assert_eq!(solve(&Sought::Similarity, &rows), Err(Degeneracy::ConcurrentPlanes));
    let rows = sample(&mut random, &Sought::Rigid, &[4, 1, 1]).rows;
    assert_eq!(solve(&Sought::Rigid, &rows), Err(Degeneracy::CrowdedPlane));
}

#[test]
fn hostile_problems_are_refused_with_their_place() {
    for (text, place) in [
        ("", "no JSON"),
        ("[]", "kind"),
        (r#"{"kind":"affine"}"#, "kind is \"affine\""),
        (r#"{"kind":"rigid"}"#, "points is missing"),
        (r#"{"kind":"rigid","points":[[0,0]],"planes":[],"pairs":[]}"#, "points[0]"),
        (r#"{"kind":"rigid","points":[[0,0,"NaN"]],"planes":[],"pairs":[]}"#, "points[0]"),
        (
            r#"{"kind":"rigid","points":[[0,0,1e999]],"planes":[],"pairs":[]}"#,
            "points[0] is [0,0,1e999]: number out of",
        ),
        (
            r#"{"kind":"rigid","points":[[0,0,0],[0,-1e308,0]],"planes":[],"pairs":[]}"#,
            "points[1] is -1e+308, expected",
        ),
        (
            r#"{"kind":"rigid","points":[],"planes":[{"normal":[0,0,1],"offset":1.7e308}],"pairs":[]}"#,
            "planes[0].offset is 1.7e+308",
        ),
        ("{\"kind\":\"\u{9b}2J\u{202e}\"}", "kind is \"\\u{9b}2J\\u{202e}\""),
        (r#"{"kind":"rigid","points":"\u001b[2J","planes":[],"pairs":[]}"#, "points is missing or no list"),
        ("{\"kind\":\"rigid\"", "no JSON"),
        (
            r#"{"kind":"rigid","points":[],"planes":[{"normal":[0,0,0],"offset":1}],"pairs":[]}"#,
            "planes[0].normal is zero",
        ),
        (r#"{"kind":"rigid","points":[[0,0,0]],"planes":[],"pairs":[[0,-1]]}"#, "pairs[0]"),
        (
            r#"{"kind":"rigid","points":[[0,0,0]],"planes":[],"pairs":[[0,4000000000]]}"#,
            "pairs[0] names plane 4000000000",
        ),
        (r#"{"kind":"rigid","sensor":[{"point":[0,0,0]}],"object":[]}"#, "sensor has 1 entries"),
        (
            r#"{"kind":"rigid","sensor":[{"line":{"point":[0,0,0],"direction":[1,0,0]}}],"object":[{"point":[0,0,0]}]}"#,
            "exchange",
        ),
        (
            r#"{"kind":"rigid_gravity","points":[],"planes":[],"pairs":[],"up":{"sensor":[0,0,0],"object":[0,0,1]}}"#,
            "up has no direction",
        ),
    ] {
        match solve_json(text) {
            Err(Refusal::IllFormed(message)) => assert!(message.contains(place), "{text}: {message}"),
            other => panic!("{text}: {other:?}"),
        }
    }
}

#[test]
fn coordinates_at_the_limits_of_numbers_leave_no_nan() {
    let mut random = Random::stream(13, 0);
    for exponent in [-1070, -900, -300, 300, 900, 1020] {
        let factor = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
        let mut rows = sample(&mut random, &Sought::Rigid, &[2, 2, 2]).rows;
        for row in &mut rows {
            row.point *= factor;
            row.offset *= factor;
        }
        for solution in solve(&Sought::Rigid, &rows).unwrap_or_default() {
            assert!(solution.residual.is_finite() && solution.condition.is_finite());
            assert!(solution.object_from_sensor.translation.iter().all(|v| v.is_finite()));
        }
    }
}

/// Rows that a known pose satisfies: `points` points, each on one of `planes` planes in turn, or all on their own.
fn many(random: &mut Random, points: usize, planes: usize) -> (Vec<Row>, Similarity) {
    let pose = Similarity {
        scale: 2.5,
        rotation: Rotation3::from_euler_angles(0.3, -0.4, 1.9),
        translation: Vector3::new(5.0, -7.0, 0.5),
    };
    let known: Vec<(Vector3<f64>, f64)> = (0..planes).map(|_| (random.direction(), 10.0 * random.normal())).collect();
    let row = |i: usize| {
        let (normal, offset) = known[i % planes];
        let anywhere = 20.0 * random.normal_vector();
        let image = anywhere - normal * (normal.dot(&anywhere) + offset);
        Row { point: pose.inverse().apply(&Point3::from(image)).coords, normal, offset }
    };
    ((0..points).map(row).collect(), pose)
}

#[test]
fn tens_of_thousands_of_rows_have_their_one_pose() {
    let mut random = Random::stream(31, 0);
    for planes in [4, 50, 20_000] {
        let (rows, pose) = many(&mut random, 20_000, planes);
        let doubled: Vec<Row> = rows.iter().chain(&rows).copied().collect();
        for rows in [rows, doubled] {
            let solutions = solve(&Sought::Similarity, &rows).unwrap();
            assert_eq!(solutions.len(), 1, "{planes} planes");
            let found = &solutions[0].object_from_sensor;
            assert!((found.rotation.matrix() - pose.rotation.matrix()).norm() < 1e-9);
            assert!((found.scale - pose.scale).abs() < 1e-9 && (found.translation - pose.translation).norm() < 1e-8);
            assert!(solutions[0].residual < 1e-11 && solutions[0].condition > 1e-3);
        }
    }
}

#[test]
fn many_rows_with_a_known_up_have_their_one_pose() {
    let mut random = Random::stream(32, 0);
    let (rows, pose) = many(&mut random, 5_000, 5_000);
    let up_in_sensor = pose.rotation.inverse() * Vector3::z();
    let sought = Sought::UprightSimilarity(Up::new(&up_in_sensor, &Vector3::z()).unwrap());
    let solutions = solve(&sought, &rows).unwrap();
    assert_eq!(solutions.len(), 1);
    assert!((solutions[0].object_from_sensor.rotation.matrix() - pose.rotation.matrix()).norm() < 1e-9);
}

#[test]
fn many_rows_that_no_pose_satisfies_have_none() {
    let mut random = Random::stream(33, 0);
    let (mut rows, _) = many(&mut random, 5_000, 30);
    rows[4_000].offset += 0.1;
    assert_eq!(solve(&Sought::Similarity, &rows).unwrap(), []);
}
