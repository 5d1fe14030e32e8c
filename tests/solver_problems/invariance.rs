//! What must not move an answer, and what must not spoil one.

use super::*;

fn whole(random: &mut Random, most: i32) -> Vector3<f64> {
    Vector3::from_fn(|_, _| ((2 * most + 1) as f64 * random.unit()).floor() - f64::from(most))
}

/// Minimal problems on small whole numbers, sound ones and degenerate ones: shifts and powers of two change them exactly.
fn exact_problems(random: &mut Random) -> Vec<(Sought, Vec<Row>)> {
    let mut problems = Vec::new();
    for (sought, configurations) in [(Sought::Rigid, &RIGID_MINIMAL[..]), (Sought::Similarity, &SIMILARITY_MINIMAL)] {
        for points in configurations {
            let mut rows = Vec::new();
            for &count in *points {
                let normal = whole(random, 9) + Vector3::new(0.0, 0.0, 0.5);
                let offset = -normal.dot(&whole(random, 50));
                rows.extend((0..count).map(|_| Row { point: whole(random, 50), normal, offset }));
            }
            problems.extend(spoilt(random, &rows).into_iter().map(|rows| (sought, rows)));
            problems.push((sought, rows));
        }
    }
    problems
}

const RIGID_MINIMAL: [&[usize]; 6] =
    [&[3, 2, 1], &[3, 1, 1, 1], &[2, 2, 2], &[2, 2, 1, 1], &[2, 1, 1, 1, 1], &[1, 1, 1, 1, 1, 1]];
const SIMILARITY_MINIMAL: [&[usize]; 6] =
    [&[3, 2, 1, 1], &[3, 1, 1, 1, 1], &[2, 2, 2, 1], &[2, 2, 1, 1, 1], &[2, 1, 1, 1, 1, 1], &[1, 1, 1, 1, 1, 1, 1]];

/// The rows made degenerate: all points on a line, upright planes only, planes through one point, the first three points collinear.
fn spoilt(random: &mut Random, rows: &[Row]) -> [Vec<Row>; 4] {
    let (from, along, vertex) = (whole(random, 50), whole(random, 3) + Vector3::x() * 4.0, whole(random, 50));
    let on_line = |k: usize| from + along * k as f64;
    let changed = |change: &dyn Fn(usize, &mut Row)| {
        let mut rows = rows.to_vec();
        rows.iter_mut().enumerate().for_each(|(k, row)| change(k, row));
        rows
    };
    [
        changed(&|k, row| row.point = on_line(k)),
        changed(&|_, row| row.normal.z = 0.0),
        changed(&|_, row| row.offset = -row.normal.dot(&vertex)),
        changed(&|k, row| row.point = if k < 3 { on_line(k) } else { row.point }),
    ]
}

/// An answer without what shifts and units change: the refusal, or condition and rotation of each pose, best held first.
fn essence(sought: &Sought, rows: &[Row]) -> Result<Vec<(f64, Matrix3<f64>)>, Degeneracy> {
    let solutions = solve(sought, rows)?;
    let mut poses: Vec<_> =
        solutions.iter().map(|s| (s.condition, s.object_from_sensor.rotation.into_inner())).collect();
    poses.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(poses)
}

#[test]
fn neither_a_far_origin_nor_another_unit_moves_an_answer_or_a_refusal() {
    const FAR: f64 = 1_048_576.0; // 2^20, about a million, so that whole numbers stay exact.
    let mut random = Random::stream(14, 0);
    let (mut answered, mut refused) = (0, 0);
    for _ in 0..10 {
        for (sought, rows) in exact_problems(&mut random) {
            let before = essence(&sought, &rows);
            *if before.is_ok() { &mut answered } else { &mut refused } += 1;
            let shift = whole(&mut random, 5) * FAR;
            let free = if sought.is_similarity() { 1.0 / FAR } else { 1.0 };
            let change = |change: &dyn Fn(&Row) -> Row| -> Vec<Row> { rows.iter().map(change).collect() };
            for (what, moved) in [
                ("object shifted", change(&|r| Row { offset: r.offset - r.normal.dot(&shift), ..*r })),
                ("sensor shifted", change(&|r| Row { point: r.point + shift, ..*r })),
                ("larger unit", change(&|r| Row { point: r.point / FAR, offset: r.offset / FAR, ..*r })),
                ("smaller unit", change(&|r| Row { point: r.point * FAR, offset: r.offset * FAR, ..*r })),
                ("other scale", change(&|r| Row { point: r.point * free, ..*r })),
                ("long normals", change(&|r| Row { normal: r.normal * -FAR, offset: r.offset * -FAR, ..*r })),
            ] {
                match (&before, essence(&sought, &moved)) {
                    (Err(before), Err(after)) => assert_eq!(*before, after, "{what}: {rows:?}"),
                    (Ok(before), Ok(after)) => {
                        assert!(agree(before, &after), "{what}: {rows:?}\n{before:?}\n{after:?}")
                    }
                    (before, after) => panic!("{what}: {rows:?}\n{before:?}\n{after:?}"),
                }
            }
        }
    }
    assert!(answered > 100 && refused > 100, "{answered} answered, {refused} refused");
}

/// Rounding at a distance of a million is 1e-12 of the scene, which the condition multiplies.
fn agree(before: &[(f64, Matrix3<f64>)], after: &[(f64, Matrix3<f64>)]) -> bool {
    let near = |(condition, rotation): &(f64, Matrix3<f64>)| {
        let tolerance = 1e-10 / condition;
        after.iter().any(|(c, r)| (c / condition - 1.0).abs() < 1e-3 + tolerance && (r - rotation).norm() < tolerance)
    };
    before.len() == after.len() && before.iter().all(near)
}

#[test]
fn problems_on_their_way_to_degeneracy_leave_no_nan() {
    let mut random = Random::stream(15, 0);
    for exponent in 0..=20 {
        let share = 10f64.powi(-exponent);
        for (sought, rows) in exact_problems(&mut random) {
            let points: Vec<usize> =
                rows.chunk_by(|a, b| (a.normal, a.offset) == (b.normal, b.offset)).map(<[_]>::len).collect();
            let noisy: Vec<Row> =
                rows.iter().map(|r| Row { point: r.point + random.normal_vector() * share, ..*r }).collect();
            let unit = |r: &Row| Row { normal: r.normal.normalize(), offset: r.offset / r.normal.norm(), ..*r };
            let minimal: Vec<Row> = noisy.iter().map(unit).collect();
            let general = solve(&sought, &noisy).unwrap_or_default();
            let poses = solve_minimal(&sought, &points, &minimal);
            for pose in poses.iter().chain(general.iter().map(|s| &s.object_from_sensor)) {
                let numbers = pose.rotation.matrix().iter().chain(pose.translation.iter()).chain([&pose.scale]);
                assert!(numbers.into_iter().all(|v| v.is_finite()) && pose.scale > 0.0, "{pose:?}");
            }
            assert!(general.iter().all(|s| s.residual.is_finite() && s.condition >= cityweld::solvers::NOT_ISOLATED));
        }
    }
}

#[test]
fn nearly_parallel_planes_lose_no_pose_far_away() {
    let mut random = Random::stream(16, 0);
    for _ in 0..60 {
        let sensor_from_object = pose(&mut random, &Sought::Rigid).inverse();
        let (first, third) = (random.plane(), random.plane());
        let nearly = (first.0 + random.direction().cross(&first.0) * 1e-4).normalize();
        let second = (nearly, -nearly.dot(&random.in_cube()));
        let mut rows = Vec::new();
        for plane in [first, first, first, second, second, third] {
            let point = sensor_from_object.apply(&random.on_plane(&plane).into()).coords;
            rows.push(Row { point, normal: plane.0, offset: plane.1 });
        }
        let found = solve(&Sought::Rigid, &rows).unwrap().len();
        assert_eq!(found, 4, "poses of (3,2,1)");
    }
}

/// Planes along the axes, points anywhere or in pairs along the axes, poses from the identity over half-turns to any.
fn aligned_problem(random: &mut Random, sought: &Sought, points: &[usize], variant: usize) -> Sample {
    let turns = [
        Matrix3::identity(),
        Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)),
        Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0)),
        Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
        Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0),
        Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0),
    ];
    let mut truth = pose(random, sought);
    if let Some(turn) = turns.get(variant / 2) {
        truth.rotation = Rotation3::from_matrix_unchecked(*turn);
    }
    let mut rows: Vec<Row> = Vec::new();
    for (i, &count) in points.iter().enumerate() {
        let mut normal = Vector3::zeros();
        normal[i % 3] = 1.0;
        let plane = (normal, -100.0 * (random.unit() - 0.5));
        let first = random.on_plane(&plane);
        for k in 0..count {
            let mut x = if k == 0 { first } else { random.on_plane(&plane) };
            if k == 1 && variant.is_multiple_of(2) {
                x = first;
                x[(i + 1 + (random.unit() * 2.0) as usize) % 3] += 10.0 + 30.0 * random.unit();
            }
            rows.push(Row { point: truth.inverse().apply(&x.into()).coords, normal: plane.0, offset: plane.1 });
        }
    }
    Sample { rows, truth }
}

#[test]
fn minimal_solvers_find_on_boxes_and_at_half_turns_what_the_thorough_solver_finds() {
    let mut random = Random::stream(17, 0);
    let (mut asked, mut wrong) = (0, Vec::new());
    for (sought, configurations) in [(Sought::Rigid, &RIGID_MINIMAL[..]), (Sought::Similarity, &SIMILARITY_MINIMAL)] {
        for points in configurations {
            for k in 0..14 * 20 {
                let Sample { rows, truth } = aligned_problem(&mut random, &sought, points, k % 14);
                let Ok(general) = solve(&sought, &rows) else { continue };
                // A singular pose, which `solve` leaves out, may be two for a minimal solver.
                let held = condition_at(&sought, &rows, truth.scale, truth.rotation.matrix());
                if general.iter().fold(held, |least, s| least.min(s.condition)) < 1e-5 {
                    continue;
                }
                let poses = solve_minimal(&sought, points, &rows);
                let found = |s: &Solution| {
                    let r = s.object_from_sensor.rotation.matrix();
                    poses.iter().any(|p| (p.rotation.matrix() - r).norm() < 1e-6)
                };
                asked += 1;
                if poses.len() != general.len() || !general.iter().all(found) {
                    wrong.push(format!("{points:?} variant {}: {} of {}", k % 14, poses.len(), general.len()));
                }
            }
        }
    }
    assert!(asked > 1000 && wrong.is_empty(), "{} of {asked}\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn right_angled_corners_give_all_their_twins() {
    let mut random = Random::stream(18, 0);
    let skew = Vector3::new(0.6, 0.8, 0.0);
    for (normals, points, expected) in [
        ([Vector3::x(), Vector3::y(), Vector3::z()], [3, 3, 1], 4),
        ([Vector3::x(), Vector3::y(), Vector3::z()], [3, 3, 2], 4),
        ([Vector3::x(), Vector3::y(), Vector3::z()], [3, 2, 2], 4),
        ([Vector3::z(), skew, Vector3::x()], [3, 3, 2], 2),
        ([Vector3::z(), skew, Vector3::x()], [3, 2, 2], 2),
        ([Vector3::x(), skew, Vector3::z()], [3, 2, 2], 2),
    ] {
        for _ in 0..20 {
            let truth = pose(&mut random, &Sought::Rigid);
            let mut rows = Vec::new();
            for (normal, count) in normals.into_iter().zip(points) {
                for _ in 0..count {
                    let x = random.on_plane(&(normal, 11.0));
                    rows.push(Row { point: truth.inverse().apply(&x.into()).coords, normal, offset: 11.0 });
                }
            }
            assert_eq!(solve(&Sought::Rigid, &rows).unwrap().len(), expected, "{normals:?} {points:?}");
            assert_eq!(solve_minimal(&Sought::Rigid, &points, &rows).len(), expected, "{normals:?} {points:?}");
        }
    }
}

#[test]
fn a_vertex_an_edge_and_a_face_are_enough() {
    let mut random = Random::stream(19, 0);
    for _ in 0..20 {
        let truth = pose(&mut random, &Sought::Rigid);
        let to_sensor = |x: Vector3<f64>| truth.inverse().apply(&x.into()).coords;
        let planes_through = |random: &mut Random, x: &Vector3<f64>| {
            let normal = random.direction();
            (normal, -normal.dot(x))
        };
        let [vertex, edge, face] = [0; 3].map(|_| random.in_cube());
        let mut rows = Row::on_vertex(to_sensor(vertex), [0; 3].map(|_| planes_through(&mut random, &vertex))).to_vec();
        rows.extend(Row::on_edge(to_sensor(edge), [0; 2].map(|_| planes_through(&mut random, &edge))));
        let (normal, offset) = planes_through(&mut random, &face);
        rows.push(Row { point: to_sensor(face), normal, offset });
        let minimal = cityweld::solvers::se3_6pt(rows[..].try_into().unwrap());
        let general = solve(&Sought::Rigid, &rows).unwrap();
        assert!(minimal.len() == general.len() && minimal.len() <= 4, "{} {}", minimal.len(), general.len());
        let error = minimal.iter().map(|p| angle_between_rad(&p.rotation, &truth.rotation)).fold(9.0, f64::min);
        assert!(error < 1e-8, "{error:e}");
    }
}
