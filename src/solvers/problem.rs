//! One problem as JSON, and its answer: what `cityweld solve` reads and writes.
//!
//! ```text
//! problem = { "kind": "rigid" | "similarity" | "rigid_gravity" | "similarity_gravity",
//!             "points": [[x, y, z], ..],                             sensor frame
//!             "planes": [{"normal": [a, b, c], "offset": d}, ..],    object frame; a x + b y + c z + d = 0, any length
//!             "pairs":  [[point, plane], ..],                        zero based; a point may lie on several planes
//!             "up":     {"sensor": [..], "object": [..]} }           gravity kinds only; any length
//!
//!           or, instead of points, planes and pairs, entry i of "sensor" lying on entry i of "object":
//!           { "sensor": [{"point": [..]} | {"line": {"point": [..], "direction": [..]}} | {"plane": {"normal": [..], "offset": d}}, ..],
//!             "object": [{"plane": {..}} | {"line": {..}} | {"point": [..]}, ..] }
//!
//! answer  = { "solutions": [{ "scale": s, "rotation": [[..], [..], [..]], "translation": [..],   object from sensor
//!                             "residual": largest distance from a plane over the spread of the images,
//!                             "condition": 0 (not isolated) .. 1, below 1e-3 weak }, ..] }
//!         | { "refused": "degenerate: reason" }  | { "refused": "ill-formed: reason" }
//! ```
//!
//! An empty list of solutions is an answer: the problem is sound and has no real pose. Further keys are ignored. The same as a JSON
//! schema, the answer included: `assets/problem.schema.json` (tests/problem_schema.rs holds it to the golden problems).

use super::primitives::{ObjectPrimitive, PrimitiveError, SensorPrimitive, rows_of};
use super::{Degeneracy, Row, Solution, Sought, Up, solve};
use crate::geometry::Vector3;
use serde_json::error::Category;
use serde_json::value::RawValue;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The longest problem that is read, bytes. Chosen: some three million pairs.
pub const LARGEST_PROBLEM_BYTES: u64 = 256 << 20;

/// Why a problem has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    #[error("ill-formed: {0}")]
    IllFormed(String),
    #[error("degenerate: {0}")]
    Degenerate(#[from] Degeneracy),
}

impl From<PrimitiveError> for Refusal {
    fn from(error: PrimitiveError) -> Refusal {
        Refusal::IllFormed(error.to_string())
    }
}

/// A problem that has been read.
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

/// The problem's members, still as text: of a long list only one entry at a time becomes JSON.
type Members<'t> = BTreeMap<String, &'t RawValue>;

/// Reads a problem; every message names the place.
pub fn parse_problem(text: &str) -> Result<Problem, Refusal> {
    let members: Members = serde_json::from_str(text).map_err(|error| match error.classify() {
        Category::Data => ill_formed("the kind is missing: expected an object {\"kind\": ..}".to_owned()),
        _ => ill_formed(format!("no JSON: {error}")),
    })?;
    let kind = member(&members, "kind")?;
    let kind = kind.as_str().ok_or(&kind);
    let sought = match kind {
        Ok("rigid") => Sought::Rigid,
        Ok("similarity") => Sought::Similarity,
        Ok("rigid_gravity") => Sought::UprightRigid(up(&members)?),
        Ok("similarity_gravity") => Sought::UprightSimilarity(up(&members)?),
        other => {
            let found = other.map_or_else(shown, |word| shown(&Value::from(word)));
            let expected = "expected rigid, similarity, rigid_gravity or similarity_gravity";
            return Err(ill_formed(format!("kind is {found}, {expected}")));
        }
    };
    let rows = if members.contains_key("sensor") { mixed_rows(&members)? } else { point_rows(&members)? };
    Ok(Problem { sought, rows })
}

fn point_rows(members: &Members) -> Result<Vec<Row>, Refusal> {
    let points: Vec<Vector3<f64>> = entries(members, "points", vector)?;
    let planes = entries(members, "planes", plane)?;
    entries(members, "pairs", |pair, place| {
        let indices: Option<Vec<usize>> = pair
            .as_array()
            .and_then(|pair| pair.iter().map(|v| v.as_u64().and_then(|i| usize::try_from(i).ok())).collect());
        let Some([point, plane]) = indices.as_deref() else {
            return Err(ill_formed(format!("{place} is {}, expected two indices [point, plane]", shown(pair))));
        };
        let missing = |what: &str, index: usize, count: usize| {
            ill_formed(format!("{place} names {what} {index}, but there are {count} (counted from 0)"))
        };
        let &point = points.get(*point).ok_or_else(|| missing("point", *point, points.len()))?;
        let &(normal, offset) = planes.get(*plane).ok_or_else(|| missing("plane", *plane, planes.len()))?;
        Ok(Row { point, normal, offset })
    })
}

fn mixed_rows(members: &Members) -> Result<Vec<Row>, Refusal> {
    let sensor = entries(members, "sensor", |v, place| {
        if let Some(point) = v.get("point") {
            Ok(SensorPrimitive::Point(vector(point, &format!("{place}.point"))?))
        } else if let Some(l) = v.get("line") {
            let (point, direction) = line(l, &format!("{place}.line"))?;
            Ok(SensorPrimitive::Line { point, direction })
        } else if let Some(p) = v.get("plane") {
            let (normal, offset) = plane(p, &format!("{place}.plane"))?;
            Ok(SensorPrimitive::Plane { normal, offset })
        } else {
            Err(ill_formed(format!("{place} is no point, line or plane")))
        }
    })?;
    let object = entries(members, "object", |v, place| {
        if let Some(p) = v.get("plane") {
            let (normal, offset) = plane(p, &format!("{place}.plane"))?;
            Ok(ObjectPrimitive::Plane { normal, offset })
        } else if let Some(l) = v.get("line") {
            let (point, direction) = line(l, &format!("{place}.line"))?;
            Ok(ObjectPrimitive::Line { point, direction })
        } else if let Some(point) = v.get("point") {
            Ok(ObjectPrimitive::Point(vector(point, &format!("{place}.point"))?))
        } else {
            Err(ill_formed(format!("{place} is no plane, line or point")))
        }
    })?;
    if sensor.len() != object.len() {
        return Err(ill_formed(format!("sensor has {} entries, object {}", sensor.len(), object.len())));
    }
    let pairs: Vec<_> = sensor.into_iter().zip(object).collect();
    Ok(rows_of(&pairs)?)
}

fn up(members: &Members) -> Result<Up, Refusal> {
    let up = member(members, "up")?;
    let side = |name: &str| {
        let given = up.get(name);
        vector(given.unwrap_or(&Value::Null), &format!("up.{name}"))
    };
    let (sensor, object) = (side("sensor")?, side("object")?);
    Up::new(&sensor, &object).ok_or_else(|| ill_formed("up has no direction: a vector is zero".to_owned()))
}

fn ill_formed(message: String) -> Refusal {
    Refusal::IllFormed(message)
}

/// One member of the problem; null where it is missing.
fn member(members: &Members, key: &str) -> Result<Value, Refusal> {
    members.get(key).map_or(Ok(Value::Null), |text| parsed(text, key))
}

/// Every entry of a list, read.
fn entries<T>(
    members: &Members,
    key: &str,
    read: impl Fn(&Value, &str) -> Result<T, Refusal>,
) -> Result<Vec<T>, Refusal> {
    let list: Option<Vec<&RawValue>> = members.get(key).and_then(|text| serde_json::from_str(text.get()).ok());
    let list = list.ok_or_else(|| ill_formed(format!("{key} is missing or no list")))?;
    let read_one = |(i, text): (usize, &&RawValue)| {
        let place = format!("{key}[{i}]");
        read(&parsed(text, &place)?, &place)
    };
    list.iter().enumerate().map(read_one).collect()
}

/// JSON that may still hold numbers beyond all that there are, or lists in lists without end.
fn parsed(text: &RawValue, place: &str) -> Result<Value, Refusal> {
    serde_json::from_str(text.get()).map_err(|error| {
        let error = error.to_string();
        let reason = error.split(" at line ").next().unwrap_or_default();
        ill_formed(format!("{place} is {}: {reason}", shortened(text.get())))
    })
}

/// Characters of a value that a message repeats at most.
const SHOWN_CHARACTERS: usize = 60;

fn shown(value: &Value) -> String {
    shortened(&value.to_string())
}

/// The beginning, with all that could steer a terminal written out.
fn shortened(text: &str) -> String {
    let mut shown = String::new();
    for c in text.chars().take(SHOWN_CHARACTERS) {
        if c == ' ' || c.is_ascii_graphic() { shown.push(c) } else { shown.extend(c.escape_default()) }
    }
    if text.chars().nth(SHOWN_CHARACTERS).is_some() { shown + "..." } else { shown }
}

/// Numbers up to here can be added, and multiplied by few others, without leaving the finite. Far beyond any unit: golden
/// problems go to 1e151.
const LARGEST_NUMBER: f64 = 1e200;

fn number(value: &Value, place: &str) -> Result<f64, Refusal> {
    let number = value.as_f64().filter(|v| v.abs() <= LARGEST_NUMBER);
    number.ok_or_else(|| {
        ill_formed(format!(
            "{place} is {}, expected a number between -{LARGEST_NUMBER:e} and {LARGEST_NUMBER:e}",
            shown(value)
        ))
    })
}

fn vector(value: &Value, place: &str) -> Result<Vector3<f64>, Refusal> {
    let Some([x, y, z]) = value.as_array().map(Vec::as_slice) else {
        return Err(ill_formed(format!("{place} is {}, expected three numbers", shown(value))));
    };
    Ok(Vector3::new(number(x, place)?, number(y, place)?, number(z, place)?))
}

fn line(value: &Value, place: &str) -> Result<(Vector3<f64>, Vector3<f64>), Refusal> {
    let part = |key: &str| vector(value.get(key).unwrap_or(&Value::Null), &format!("{place}.{key}"));
    Ok((part("point")?, part("direction")?))
}

fn plane(value: &Value, place: &str) -> Result<(Vector3<f64>, f64), Refusal> {
    let normal = vector(value.get("normal").unwrap_or(&Value::Null), &format!("{place}.normal"))?;
    let offset = number(value.get("offset").unwrap_or(&Value::Null), &format!("{place}.offset"))?;
    if normal.amax() == 0.0 {
        return Err(ill_formed(format!("{place}.normal is zero")));
    }
    Ok((normal, offset))
}
