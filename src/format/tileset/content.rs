//! Containers of tiles: a model with the names of its features (b3dm), several tiles in one (cmpt).

use serde::Deserialize;
use serde_json::Value;

use crate::format::surface_error::{Place, SurfaceError};

/// Magic, version, length, and the lengths of two tables, each JSON and bytes (3D Tiles 1.0, Batched 3D Model).
const B3DM_HEADER_BYTES: usize = 28;

/// Magic, version, length, number of tiles.
const CMPT_HEADER_BYTES: usize = 16;

/// Keys of the batch table under which writers keep what a feature is called, the best first.
const NAMES: [&str; 8] = ["gml_id", "gml:id", "gmlid", "gmlId", "id", "identificatie", "name", "Name"];

/// What a file holds, by its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Container {
    Batched,
    Composite,
    Instanced,
    Points,
    /// GLB, or JSON.
    Other,
}

impl Container {
    pub fn of(bytes: &[u8]) -> Container {
        match bytes {
            [b'b', b'3', b'd', b'm', ..] => Container::Batched,
            [b'c', b'm', b'p', b't', ..] => Container::Composite,
            [b'i', b'3', b'd', b'm', ..] => Container::Instanced,
            [b'p', b'n', b't', b's', ..] => Container::Points,
            _ => Container::Other,
        }
    }
}

/// Whether a file is a tile of 3D Tiles in a container of its own.
pub fn is_tile(bytes: &[u8]) -> bool {
    Container::of(bytes) != Container::Other
}

/// A batched model taken apart.
#[derive(Debug)]
pub(super) struct Batched<'a> {
    pub glb: &'a [u8],
    /// RTC_CENTER: added to every position of the model, once it is z up.
    pub center: [f64; 3],
    /// What the features are called, by their number; empty where the table does not say.
    pub names: Vec<String>,
}

#[derive(Deserialize)]
struct FeatureTable {
    #[serde(rename = "RTC_CENTER")]
    center: Option<Center>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Center {
    Numbers([f64; 3]),
    InBytes {
        #[serde(rename = "byteOffset")]
        byte_offset: u64,
    },
}

impl<'a> Batched<'a> {
    pub fn of(bytes: &'a [u8]) -> Result<Batched<'a>, SurfaceError> {
        let bytes = claimed(bytes, "b3dm")?;
        let lengths = [12, 16, 20, 24].map(|at| word(bytes, at).map(|length| length as usize));
        let [Some(features), Some(feature_bytes), Some(batch), Some(batch_bytes)] = lengths else {
            return Err(cut(bytes.len(), "the header of b3dm", B3DM_HEADER_BYTES));
        };
        // Headers of drafts are shorter: there the JSON, or the model, begins where a length stands now.
        if [batch, batch_bytes].into_iter().any(|length| [b'"', b'{', b'F'].contains(&((length >> 24) as u8))) {
            let problem = "the b3dm has the header of a draft of 3D Tiles; upgrade it: npx 3d-tiles-tools upgrade";
            return Err(SurfaceError::at(Place::Byte(12), problem));
        }
        let mut start = B3DM_HEADER_BYTES;
        let mut section = |what: &str, length: usize| {
            let found = start.checked_add(length).and_then(|end| bytes.get(start..end));
            let found = found.ok_or_else(|| cut(bytes.len().saturating_sub(start), what, length));
            start = start.saturating_add(length);
            found
        };
        let features = section("the feature table", features)?;
        let feature_bytes = section("the feature table's bytes", feature_bytes)?;
        let batch = section("the batch table", batch)?;
        section("the batch table's bytes", batch_bytes)?;
        let glb = bytes.get(start..).unwrap_or_default();
        Ok(Batched { glb, center: center(features, feature_bytes)?, names: names(batch)? })
    }
}

/// The tiles within a composite one.
pub(super) fn parts_of(bytes: &[u8]) -> Result<Vec<&[u8]>, SurfaceError> {
    let bytes = claimed(bytes, "cmpt")?;
    let count = word(bytes, 12).ok_or_else(|| cut(bytes.len(), "the header of cmpt", CMPT_HEADER_BYTES))?;
    let mut start = CMPT_HEADER_BYTES;
    let mut parts = Vec::new();
    for _ in 0..count {
        let rest = bytes.get(start..).unwrap_or_default();
        let length = word(rest, 8).ok_or_else(|| cut(rest.len(), "a tile within cmpt", 12))? as usize;
        let part = rest.get(..length).filter(|part| part.len() >= 12);
        parts.push(part.ok_or_else(|| cut(rest.len(), "a tile within cmpt", length))?);
        start += length;
    }
    Ok(parts)
}

/// The bytes that belong to the tile, by the length that it says.
fn claimed<'a>(bytes: &'a [u8], what: &str) -> Result<&'a [u8], SurfaceError> {
    let version = word(bytes, 4).ok_or_else(|| cut(bytes.len(), what, 12))?;
    if version != 1 {
        let problem = format!("{what} version {version}, expected 1; upgrade it: npx 3d-tiles-tools upgrade");
        return Err(SurfaceError::at(Place::Byte(4), problem));
    }
    let length = word(bytes, 8).ok_or_else(|| cut(bytes.len(), what, 12))? as usize;
    bytes.get(..length).ok_or_else(|| cut(bytes.len(), what, length))
}

fn center(json: &[u8], bytes: &[u8]) -> Result<[f64; 3], SurfaceError> {
    let table: Option<FeatureTable> = table(json, "feature table")?;
    let center = match table.and_then(|table| table.center) {
        None => [0.0; 3],
        Some(Center::Numbers(center)) => center,
        Some(Center::InBytes { byte_offset }) => {
            let at = |axis: u64| usize::try_from(byte_offset.checked_add(4 * axis)?).ok();
            let number = |axis: u64| Some(f64::from(f32::from_bits(word(bytes, at(axis)?)?)));
            match [0, 1, 2].map(number) {
                [Some(x), Some(y), Some(z)] => [x, y, z],
                _ => return Err(cut(bytes.len(), "RTC_CENTER in the feature table", 12)),
            }
        }
    };
    if !center.iter().all(|value| value.is_finite()) {
        return Err(SurfaceError::at(
            Place::Part("RTC_CENTER".to_owned()),
            "RTC_CENTER is not finite; expected metres",
        ));
    }
    Ok(center)
}

fn names(json: &[u8]) -> Result<Vec<String>, SurfaceError> {
    let table: Option<serde_json::Map<String, Value>> = table(json, "batch table")?;
    let Some(mut table) = table else { return Ok(Vec::new()) };
    let found = NAMES.iter().find_map(|key| match table.remove(*key) {
        Some(Value::Array(values)) => Some(values),
        _ => None,
    });
    let text = |value: Value| match value {
        Value::String(text) => text,
        other => other.to_string(),
    };
    Ok(found.into_iter().flatten().map(text).collect())
}

/// Writers fill tables up with spaces or zeros; an empty one is none.
fn table<T: for<'de> Deserialize<'de>>(json: &[u8], what: &str) -> Result<Option<T>, SurfaceError> {
    let end = json.iter().rposition(|&byte| byte != 0 && !byte.is_ascii_whitespace()).map_or(0, |last| last + 1);
    if end == 0 {
        return Ok(None);
    }
    serde_json::from_slice(&json[..end]).map(Some).map_err(|error| {
        SurfaceError::at(Place::Part(what.to_owned()), format!("the {what} is no JSON: {error}; write the tile again"))
    })
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

fn cut(found: usize, what: &str, claimed: usize) -> SurfaceError {
    SurfaceError::whole(format!("the tile is cut off: {what} says {claimed} bytes, {found} are there; get it again"))
}
