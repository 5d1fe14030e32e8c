//! One problem file solved: its text becomes rows, the rows are solved, the answer becomes JSON.
//!
//! ```text
//! answer  = { "solutions": [{ "scale": s, "rotation": [[..], [..], [..]], "translation": [..],   object from sensor
//!                             "residual": largest distance from a plane over the spread of the images,
//!                             "condition": 0 (not isolated) .. 1, below 1e-3 weak }, ..] }
//!         | { "refused": "degenerate: reason" }  | { "refused": "ill-formed: reason" }
//! ```
//!
//! An empty list of solutions is an answer: the problem is sound and has no real pose. `format/problem.rs` describes the file,
//! `solvers` solves; they do not know of each other.

use serde_json::{Value, json};

use crate::format::{self, IllFormed, Primitive, ProblemKind, StoredPairs, StoredUp};
use crate::solvers::primitives::{ObjectPrimitive, PrimitiveError, SensorPrimitive, rows_of};
use crate::solvers::{Degeneracy, Row, Solution, Sought, Up, solve};

pub use crate::format::LARGEST_PROBLEM_BYTES;

/// Why a problem has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    #[error("ill-formed: {0}")]
    IllFormed(String),
    #[error("degenerate: {0}")]
    Degenerate(#[from] Degeneracy),
}

impl From<IllFormed> for Refusal {
    fn from(IllFormed(message): IllFormed) -> Refusal {
        Refusal::IllFormed(message)
    }
}

impl From<PrimitiveError> for Refusal {
    fn from(error: PrimitiveError) -> Refusal {
        Refusal::IllFormed(error.to_string())
    }
}

/// What a problem file asks.
#[derive(Clone, Debug)]
pub struct Problem {
    pub sought: Sought,
    /// Normals of any length.
    pub rows: Vec<Row>,
}

/// Reads a problem and solves it.
pub fn solve_json(text: &str) -> Result<Vec<Solution>, Refusal> {
    let problem = parse_problem(text)?;
    Ok(solve(&problem.sought, &problem.rows)?)
}

/// Reads a problem; every message names the place.
pub fn parse_problem(text: &str) -> Result<Problem, Refusal> {
    let stored = format::read_problem(text)?;
    let sought = match stored.kind {
        ProblemKind::Rigid => Sought::Rigid,
        ProblemKind::Similarity => Sought::Similarity,
        ProblemKind::RigidGravity(vertical) => Sought::UprightRigid(up(&vertical)?),
        ProblemKind::SimilarityGravity(vertical) => Sought::UprightSimilarity(up(&vertical)?),
    };
    let rows = match stored.pairs {
        StoredPairs::PointsOnPlanes(pairs) => {
            let row = |(point, on): (_, format::StoredPlane)| Row { point, normal: on.normal, offset: on.offset };
            pairs.into_iter().map(row).collect()
        }
        StoredPairs::Mixed(pairs) => {
            let pairs: Vec<_> = pairs.iter().map(|(sensor, object)| (of_sensor(sensor), of_object(object))).collect();
            rows_of(&pairs)?
        }
    };
    Ok(Problem { sought, rows })
}

fn up(stored: &StoredUp) -> Result<Up, Refusal> {
    Up::new(&stored.sensor, &stored.object).ok_or_else(|| Refusal::IllFormed("up has no direction".to_owned()))
}

fn of_sensor(stored: &Primitive) -> SensorPrimitive {
    match *stored {
        Primitive::Point(point) => SensorPrimitive::Point(point),
        Primitive::Line { point, direction } => SensorPrimitive::Line { point, direction },
        Primitive::Plane(plane) => SensorPrimitive::Plane { normal: plane.normal, offset: plane.offset },
    }
}

fn of_object(stored: &Primitive) -> ObjectPrimitive {
    match *stored {
        Primitive::Point(point) => ObjectPrimitive::Point(point),
        Primitive::Line { point, direction } => ObjectPrimitive::Line { point, direction },
        Primitive::Plane(plane) => ObjectPrimitive::Plane { normal: plane.normal, offset: plane.offset },
    }
}

/// The answer as JSON.
pub fn answer_json(answer: &Result<Vec<Solution>, Refusal>) -> Value {
    match answer {
        Err(refusal) => json!({ "refused": refusal.to_string() }),
        Ok(solutions) => json!({ "solutions": solutions.iter().map(solution_json).collect::<Vec<_>>() }),
    }
}

fn solution_json(solution: &Solution) -> Value {
    let pose = &solution.object_from_sensor;
    let r = pose.rotation.matrix();
    let t = &pose.translation;
    json!({
        "scale": pose.scale,
        "rotation": [[r[(0, 0)], r[(0, 1)], r[(0, 2)]], [r[(1, 0)], r[(1, 1)], r[(1, 2)]], [r[(2, 0)], r[(2, 1)], r[(2, 2)]]],
        "translation": [t.x, t.y, t.z],
        "residual": solution.residual,
        "condition": solution.condition,
    })
}

#[cfg(test)]
mod tests;
