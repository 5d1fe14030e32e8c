//! The golden vectors.

use super::*;

#[test]
fn every_golden_problem_is_answered_or_refused_as_it_should_be() {
    let Some(golden) = shared("golden") else { return };
    let (mut total, mut wrong) = (0, Vec::new());
    for name in ["rigid", "similarity", "gravity", "special", "hard", "degenerate"] {
        let text = std::fs::read_to_string(golden.join(format!("{name}.json"))).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        for problem in file["problems"].as_array().unwrap() {
            total += 1;
            if let Err(why) = agrees(problem) {
                wrong.push(format!("{name}: {}: {why}", problem["name"]));
            }
        }
    }
    assert!(wrong.is_empty() && total == 760, "{} of {total} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

fn agrees(problem: &Value) -> Result<(), String> {
    let text = problem.to_string();
    let answer = solve_json(&text);
    if let Some(expected) = problem["expect"]["refused"].as_str() {
        let class = match &answer {
            Ok(solutions) => return Err(format!("{} poses instead of a refusal", solutions.len())),
            Err(Refusal::IllFormed(_)) => "ill-formed",
            Err(Refusal::Degenerate(_)) => "degenerate",
        };
        return if expected.starts_with(class) { Ok(()) } else { Err(format!("{class}, expected {expected}")) };
    }
    let mut left = answer.map_err(|refusal| refusal.to_string())?;
    let rows = parse_problem(&text).map_err(|refusal| refusal.to_string())?.rows;
    let expected = problem["expect"]["solutions"].as_array().unwrap();
    let tolerance = problem["expect"]["tolerance"].as_f64().unwrap_or(1e-7);
    for want in expected {
        let nearest = (0..left.len())
            .min_by(|&a, &b| distance(&rows, &left[a], want).total_cmp(&distance(&rows, &left[b], want)));
        let near = nearest.ok_or("a solution is missing")?;
        let apart = distance(&rows, &left[near], want);
        if apart > tolerance {
            return Err(format!("a solution is missing (nearest at {apart:e})"));
        }
        left.swap_remove(near);
    }
    if left.is_empty() { Ok(()) } else { Err(format!("{} solutions too many", left.len())) }
}

/// Of rotations, relative scales, and images of the centroid in units of the spread, the largest.
fn distance(rows: &[Row], solution: &Solution, want: &Value) -> f64 {
    let number = |v: &Value| v.as_f64().unwrap();
    let pose = &solution.object_from_sensor;
    let rotation = Matrix3::from_fn(|i, j| number(&want["rotation"][i][j]));
    let translation = Vector3::from_fn(|i, _| number(&want["translation"][i]));
    let scale = number(&want["scale"]);
    let centroid = rows.iter().map(|row| row.point / rows.len() as f64).sum::<Vector3<f64>>();
    let extent = rows.iter().map(|row| (row.point - centroid).amax()).fold(0.0, f64::max);
    let spread_sq: f64 = rows.iter().map(|row| ((row.point - centroid) / extent).norm_squared()).sum();
    let spread = extent * (spread_sq / rows.len() as f64).sqrt();
    let image = scale * (rotation * centroid) + translation;
    let apart = (pose.apply(&centroid.into()).coords - image).norm() / (scale * spread);
    (pose.rotation.matrix() - rotation).norm().max((pose.scale / scale - 1.0).abs()).max(apart)
}
