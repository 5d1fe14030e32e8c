//! The problem file that `cityweld solve` reads: points on planes as JSON.
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
//! ```
//!
//! Further keys are ignored. The same as a JSON schema, with the answer: `assets/problem.schema.json` (tests/problem_schema.rs holds
//! it to the golden problems).

use std::collections::BTreeMap;

use serde_json::Value;
use serde_json::error::Category;
use serde_json::value::RawValue;

use crate::geometry::Vector3;

/// The longest problem that is read, bytes. Chosen: some three million pairs.
pub const LARGEST_PROBLEM_BYTES: u64 = 256 << 20;

/// A problem file is not one: the place, what stands there, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct IllFormed(pub String);

/// A problem as its file has it.
#[derive(Clone, Debug)]
pub struct StoredProblem {
    pub kind: ProblemKind,
    pub pairs: StoredPairs,
}

/// What is sought; with known vertical, the vertical in both frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProblemKind {
    Rigid,
    Similarity,
    RigidGravity(StoredUp),
    SimilarityGravity(StoredUp),
}

/// The vertical in both frames, of any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredUp {
    pub sensor: Vector3<f64>,
    pub object: Vector3<f64>,
}

/// What lies on what.
#[derive(Clone, Debug, PartialEq)]
pub enum StoredPairs {
    /// Points, and the plane that each lies on.
    PointsOnPlanes(Vec<(Vector3<f64>, StoredPlane)>),
    /// Points, lines and planes of the sensor, and what of the object each lies on.
    Mixed(Vec<(Primitive, Primitive)>),
}

/// `normal . x + offset = 0`; the normal has any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredPlane {
    pub normal: Vector3<f64>,
    pub offset: f64,
}

/// A point, a line or a plane; a direction may have any length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    Point(Vector3<f64>),
    Line { point: Vector3<f64>, direction: Vector3<f64> },
    Plane(StoredPlane),
}

/// The problem's members, still as text: of a long list only one entry at a time becomes JSON.
type Members<'t> = BTreeMap<String, &'t RawValue>;

/// Reads a problem; every message names the place.
pub fn read_problem(text: &str) -> Result<StoredProblem, IllFormed> {
    let members: Members = serde_json::from_str(text).map_err(|error| match error.classify() {
        Category::Data => IllFormed("the kind is missing: expected an object {\"kind\": ..}".to_owned()),
        _ => IllFormed(format!("no JSON: {error}")),
    })?;
    let kind = kind(&members)?;
    let pairs = if members.contains_key("sensor") { mixed_pairs(&members)? } else { points_on_planes(&members)? };
    Ok(StoredProblem { kind, pairs })
}

fn kind(members: &Members) -> Result<ProblemKind, IllFormed> {
    let kind = member(members, "kind")?;
    match kind.as_str() {
        Some("rigid") => Ok(ProblemKind::Rigid),
        Some("similarity") => Ok(ProblemKind::Similarity),
        Some("rigid_gravity") => Ok(ProblemKind::RigidGravity(up(members)?)),
        Some("similarity_gravity") => Ok(ProblemKind::SimilarityGravity(up(members)?)),
        _ => {
            let expected = "expected rigid, similarity, rigid_gravity or similarity_gravity";
            Err(IllFormed(format!("kind is {}, {expected}", shown(&kind))))
        }
    }
}

fn up(members: &Members) -> Result<StoredUp, IllFormed> {
    let up = member(members, "up")?;
    let side = |name: &str| vector(up.get(name).unwrap_or(&Value::Null), &format!("up.{name}"));
    let (sensor, object) = (side("sensor")?, side("object")?);
    if sensor.amax() == 0.0 || object.amax() == 0.0 {
        return Err(IllFormed("up has no direction: a vector is zero".to_owned()));
    }
    Ok(StoredUp { sensor, object })
}

fn points_on_planes(members: &Members) -> Result<StoredPairs, IllFormed> {
    let points: Vec<Vector3<f64>> = entries(members, "points", vector)?;
    let planes = entries(members, "planes", plane)?;
    let pairs = entries(members, "pairs", |pair, place| {
        let indices: Option<Vec<usize>> = pair
            .as_array()
            .and_then(|pair| pair.iter().map(|v| v.as_u64().and_then(|i| usize::try_from(i).ok())).collect());
        let Some([point, plane]) = indices.as_deref() else {
            return Err(IllFormed(format!("{place} is {}, expected two indices [point, plane]", shown(pair))));
        };
        let missing = |what: &str, index: usize, count: usize| {
            IllFormed(format!("{place} names {what} {index}, but there are {count} (counted from 0)"))
        };
        let &point = points.get(*point).ok_or_else(|| missing("point", *point, points.len()))?;
        let &plane = planes.get(*plane).ok_or_else(|| missing("plane", *plane, planes.len()))?;
        Ok((point, plane))
    })?;
    Ok(StoredPairs::PointsOnPlanes(pairs))
}

fn mixed_pairs(members: &Members) -> Result<StoredPairs, IllFormed> {
    let sensor = entries(members, "sensor", |v, place| primitive(v, place, ["point", "line", "plane"]))?;
    let object = entries(members, "object", |v, place| primitive(v, place, ["plane", "line", "point"]))?;
    if sensor.len() != object.len() {
        return Err(IllFormed(format!("sensor has {} entries, object {}", sensor.len(), object.len())));
    }
    Ok(StoredPairs::Mixed(sensor.into_iter().zip(object).collect()))
}

/// The first of the keys that an entry has tells what it is.
fn primitive(value: &Value, place: &str, keys: [&str; 3]) -> Result<Primitive, IllFormed> {
    let Some((key, given)) = keys.iter().find_map(|&key| Some((key, value.get(key)?))) else {
        let [a, b, c] = keys;
        return Err(IllFormed(format!("{place} is no {a}, {b} or {c}")));
    };
    let place = format!("{place}.{key}");
    Ok(match key {
        "point" => Primitive::Point(vector(given, &place)?),
        "line" => {
            let part = |key: &str| vector(given.get(key).unwrap_or(&Value::Null), &format!("{place}.{key}"));
            Primitive::Line { point: part("point")?, direction: part("direction")? }
        }
        _ => Primitive::Plane(plane(given, &place)?),
    })
}

/// One member of the problem; null where it is missing.
fn member(members: &Members, key: &str) -> Result<Value, IllFormed> {
    members.get(key).map_or(Ok(Value::Null), |text| parsed(text, key))
}

/// Every entry of a list, read.
fn entries<T>(
    members: &Members,
    key: &str,
    read: impl Fn(&Value, &str) -> Result<T, IllFormed>,
) -> Result<Vec<T>, IllFormed> {
    let list: Option<Vec<&RawValue>> = members.get(key).and_then(|text| serde_json::from_str(text.get()).ok());
    let list = list.ok_or_else(|| IllFormed(format!("{key} is missing or no list")))?;
    let read_one = |(i, text): (usize, &&RawValue)| {
        let place = format!("{key}[{i}]");
        read(&parsed(text, &place)?, &place)
    };
    list.iter().enumerate().map(read_one).collect()
}

/// JSON that may still hold numbers beyond all that there are, or lists in lists without end.
fn parsed(text: &RawValue, place: &str) -> Result<Value, IllFormed> {
    serde_json::from_str(text.get()).map_err(|error| {
        let error = error.to_string();
        let reason = error.split(" at line ").next().unwrap_or_default();
        IllFormed(format!("{place} is {}: {reason}", shortened(text.get())))
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

fn number(value: &Value, place: &str) -> Result<f64, IllFormed> {
    let number = value.as_f64().filter(|v| v.abs() <= LARGEST_NUMBER);
    number.ok_or_else(|| {
        IllFormed(format!(
            "{place} is {}, expected a number between -{LARGEST_NUMBER:e} and {LARGEST_NUMBER:e}",
            shown(value)
        ))
    })
}

fn vector(value: &Value, place: &str) -> Result<Vector3<f64>, IllFormed> {
    let Some([x, y, z]) = value.as_array().map(Vec::as_slice) else {
        return Err(IllFormed(format!("{place} is {}, expected three numbers", shown(value))));
    };
    Ok(Vector3::new(number(x, place)?, number(y, place)?, number(z, place)?))
}

fn plane(value: &Value, place: &str) -> Result<StoredPlane, IllFormed> {
    let normal = vector(value.get("normal").unwrap_or(&Value::Null), &format!("{place}.normal"))?;
    let offset = number(value.get("offset").unwrap_or(&Value::Null), &format!("{place}.offset"))?;
    if normal.amax() == 0.0 {
        return Err(IllFormed(format!("{place}.normal is zero")));
    }
    Ok(StoredPlane { normal, offset })
}
