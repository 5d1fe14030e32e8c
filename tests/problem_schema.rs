//! `assets/problem.schema.json` says what `cityweld solve` reads and writes: every golden problem keeps to it, every answer too,
//! and what breaks it is refused.

mod json_schema;

use cityweld::solvers::problem::{Refusal, answer_json, solve_json};
use json_schema::keeps;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn schema() -> Value {
    serde_json::from_str(include_str!("../assets/problem.schema.json")).unwrap()
}

fn golden() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let folder = std::env::var_os("CITYWELD_SHARED").map_or(beside, PathBuf::from).join("golden");
    folder.is_dir().then_some(folder)
}

#[test]
fn every_golden_problem_and_its_answer_keep_to_the_schema() {
    let Some(golden) = golden() else {
        println!("skipped: no golden vectors");
        return;
    };
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
