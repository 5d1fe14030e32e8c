use super::*;
use crate::geometry::Vector3;

const RIGID: &str = r#"{"kind": "rigid", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[2,1,1],[1,2,1]],
    "planes": [{"normal": [0,0,1], "offset": 0}, {"normal": [0,1,0], "offset": 0}, {"normal": [1,0,0], "offset": 0}],
    "pairs": [[0,0],[1,0],[2,0],[0,1],[1,1],[0,2]]}"#;

#[test]
fn a_problem_becomes_rows_in_the_order_of_its_pairs() {
    let problem = parse_problem(RIGID).unwrap();
    assert!(matches!(problem.sought, Sought::Rigid));
    assert_eq!(problem.rows.len(), 6);
    assert_eq!((problem.rows[4].point, problem.rows[4].normal), (Vector3::x(), Vector3::y()));
}

#[test]
fn the_answer_in_json_holds_every_pose_with_its_numbers() {
    let solutions = solve_json(RIGID).unwrap();
    assert!(!solutions.is_empty());
    let json = answer_json(&Ok(solutions.clone()));
    let told = json["solutions"].as_array().unwrap();
    assert_eq!(told.len(), solutions.len());
    for (one, solution) in told.iter().zip(&solutions) {
        let r = solution.object_from_sensor.rotation.matrix();
        for i in 0..3 {
            for k in 0..3 {
                assert_eq!(one["rotation"][i][k].as_f64(), Some(r[(i, k)]));
            }
            assert_eq!(one["translation"][i].as_f64(), Some(solution.object_from_sensor.translation[i]));
        }
        assert_eq!(one["residual"].as_f64(), Some(solution.residual));
    }
}

#[test]
fn a_refusal_says_whether_the_problem_or_its_form_is_at_fault() {
    let ill_formed = solve_json("{").unwrap_err();
    assert!(matches!(ill_formed, Refusal::IllFormed(_)), "{ill_formed}");
    let two_planes = RIGID.replace("[0,2]]", "[2,1]]");
    let degenerate = solve_json(&two_planes).unwrap_err();
    assert!(matches!(degenerate, Refusal::Degenerate(_)), "{degenerate}");
    let json = answer_json(&Err(degenerate.clone()));
    assert_eq!(json["refused"].as_str(), Some(degenerate.to_string().as_str()));
}
