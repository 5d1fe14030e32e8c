//! `assets/problem.schema.json` says what `cityweld solve` reads and writes: every golden problem keeps to it, every answer too,
//! and what breaks it is refused.

mod json_schema;
mod needs;

use cityweld::problem::{Refusal, answer_json, solve_json};
use cityweld::solvers::scene::{Random, Sample, angle_between_rad, sample};
use cityweld::solvers::{Row, Sought, Up};
use json_schema::keeps;
use needs::shared;
use serde_json::{Value, json};

fn schema() -> Value {
    serde_json::from_str(include_str!("../assets/problem.schema.json")).unwrap()
}

#[test]
fn every_golden_problem_and_its_answer_keep_to_the_schema() {
    let Some(golden) = shared("golden") else { return };
    let schema = schema();
    let (mut sound, mut broken) = (0, 0);
    for name in ["rigid", "similarity", "gravity", "special", "hard", "degenerate"] {
        let text = std::fs::read_to_string(golden.join(format!("{name}.json"))).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        for problem in file["problems"].as_array().unwrap() {
            let answer = solve_json(&problem.to_string());
            assert!(keeps(&answer_json(&answer), &schema["$defs"]["answer"], &schema), "{}", answer_json(&answer));
            let ill_formed = matches!(answer, Err(Refusal::IllFormed(_)));
            if keeps(problem, &schema, &schema) {
                sound += usize::from(!ill_formed);
            } else {
                assert!(ill_formed, "{} breaks the schema and is answered", problem["name"]);
                broken += 1;
            }
        }
    }
    assert!(sound > 700 && broken > 5, "{sound} sound, {broken} broken");
}

#[test]
fn made_up_problems_and_their_answers_keep_to_the_schema_and_find_the_truth() {
    let schema = schema();
    let mut random = Random::stream(2, 0);
    for seed in 0..20 {
        let [sensor, object] = [random.direction(), random.direction()];
        let up = Up::new(&sensor, &object).unwrap();
        for (kind, sought, points_per_plane) in [
            ("rigid", Sought::Rigid, &[1; 6][..]),
            ("similarity", Sought::Similarity, &[1; 7]),
            ("rigid_gravity", Sought::UprightRigid(up), &[2, 1, 1]),
            ("similarity_gravity", Sought::UprightSimilarity(up), &[2, 1, 1, 1]),
        ] {
            let Sample { rows, truth } = sample(&mut random, &sought, points_per_plane);
            let points: Vec<Value> = rows.iter().map(|row| json!(row.point.as_slice())).collect();
            let plane = |row: &Row| json!({"normal": row.normal.as_slice(), "offset": row.offset});
            let planes: Vec<Value> = rows.iter().map(plane).collect();
            let pairs: Vec<[usize; 2]> = (0..rows.len()).map(|i| [i, i]).collect();
            let mut problem = json!({"kind": kind, "points": points, "planes": planes, "pairs": pairs});
            if kind.ends_with("gravity") {
                problem["up"] = json!({"sensor": sensor.as_slice(), "object": object.as_slice()});
            }
            assert!(keeps(&problem, &schema, &schema), "{problem}");
            let answer = solve_json(&problem.to_string());
            assert!(keeps(&answer_json(&answer), &schema["$defs"]["answer"], &schema), "{}", answer_json(&answer));
            let poses = answer.unwrap();
            let miss = poses.iter().map(|s| angle_between_rad(&s.object_from_sensor.rotation, &truth.rotation));
            assert!(miss.fold(f64::MAX, f64::min) < 1e-5, "{kind}, problem {seed}: truth missed");
        }
    }
}

#[test]
fn the_schema_takes_every_form_of_a_problem_and_refuses_what_is_none() {
    let schema = schema();
    let plane = json!({"normal": [0, 0, 2], "offset": -1.5});
    let line = json!({"point": [0, 0, 0], "direction": [1, 0, 0]});
    let up = json!({"sensor": [0, 0, 1], "object": [0, 0, 9.81]});
    for (problem, fits) in [
        (json!({"kind": "rigid", "points": [[1, 2, 3]], "planes": [plane], "pairs": [[0, 0]]}), true),
        (json!({"kind": "similarity", "sensor": [{"line": line}], "object": [{"plane": plane}], "more": 1}), true),
        (json!({"kind": "rigid_gravity", "points": [], "planes": [], "pairs": [], "up": up}), true),
        (json!({"kind": "rigid_gravity", "points": [], "planes": [], "pairs": []}), false),
        (json!({"kind": "affine", "points": [], "planes": [], "pairs": []}), false),
        (json!({"kind": "rigid", "points": [], "planes": []}), false),
        (json!({"kind": "rigid", "points": [[1, 2]], "planes": [], "pairs": []}), false),
        (json!({"kind": "rigid", "points": [[1, 2, null]], "planes": [], "pairs": []}), false),
        (json!({"kind": "rigid", "points": [], "planes": [], "pairs": [[0, -1]]}), false),
        (json!({"kind": "rigid", "points": [], "planes": [], "pairs": [[0, 0.5]]}), false),
        (json!({"kind": "rigid", "sensor": [{"disc": line}], "object": [{"plane": plane}]}), false),
        (json!([]), false),
    ] {
        assert_eq!(keeps(&problem, &schema, &schema), fits, "{problem}");
        if !fits {
            assert!(matches!(solve_json(&problem.to_string()), Err(Refusal::IllFormed(_))), "{problem}");
        }
    }
}
