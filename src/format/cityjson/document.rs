//! The parts of a CityJSON text that `serde_json` reads. What is long stays text.

use std::borrow::Cow;
use std::fmt;

use serde::Deserialize;
use serde::de::{MapAccess, Visitor};
use serde_json::value::RawValue;

use crate::format::surfaces::Lod;

/// A CityJSON object, or one feature of a sequence.
#[derive(Deserialize)]
pub(super) struct Document<'a> {
    #[serde(rename = "type")]
    pub kind: Option<String>,
    pub version: Option<serde_json::Value>,
    pub transform: Option<Transform>,
    #[serde(borrow)]
    pub metadata: Option<&'a RawValue>,
    #[serde(borrow, rename = "CityObjects")]
    pub objects: Option<Entries<'a>>,
    #[serde(borrow)]
    pub vertices: Option<&'a RawValue>,
    #[serde(borrow, rename = "geometry-templates")]
    pub templates: Option<Templates<'a>>,
}

/// Vertex times scale plus translation is the coordinate.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Transform {
    pub scale: [f64; 3],
    pub translate: [f64; 3],
}

impl Default for Transform {
    /// CityJSON 1.0 may do without: vertices are coordinates.
    fn default() -> Transform {
        Transform { scale: [1.0; 3], translate: [0.0; 3] }
    }
}

#[derive(Deserialize)]
pub(super) struct Templates<'a> {
    #[serde(borrow, default)]
    pub templates: Vec<Geometry<'a>>,
    #[serde(borrow, rename = "vertices-templates")]
    pub vertices: Option<&'a RawValue>,
}

#[derive(Deserialize)]
pub(super) struct CityObject<'a> {
    #[serde(rename = "type")]
    pub class: Option<String>,
    #[serde(borrow, default)]
    pub geometry: Option<Vec<Geometry<'a>>>,
    #[serde(default)]
    pub parents: Option<Vec<String>>,
    #[serde(default)]
    pub children: Option<Vec<String>>,
}

#[derive(Deserialize)]
pub(super) struct Geometry<'a> {
    #[serde(borrow, rename = "type")]
    pub kind: Cow<'a, str>,
    #[serde(borrow)]
    pub lod: Option<&'a RawValue>,
    #[serde(borrow)]
    pub boundaries: Option<&'a RawValue>,
    #[serde(borrow)]
    pub semantics: Option<Semantics<'a>>,
    /// Of a GeometryInstance.
    pub template: Option<u64>,
    #[serde(borrow, rename = "transformationMatrix")]
    pub matrix: Option<&'a RawValue>,
}

#[derive(Deserialize)]
pub(super) struct Semantics<'a> {
    #[serde(borrow, default)]
    pub surfaces: Vec<SemanticSurface<'a>>,
    #[serde(borrow)]
    pub values: Option<&'a RawValue>,
}

#[derive(Deserialize)]
pub(super) struct SemanticSurface<'a> {
    #[serde(borrow, default, rename = "type")]
    pub kind: Cow<'a, str>,
}

#[derive(Deserialize)]
struct Metadata {
    #[serde(rename = "referenceSystem")]
    reference_system: Option<serde_json::Value>,
    /// As versions before 1.0 had it.
    crs: Option<serde_json::Value>,
}

impl Document<'_> {
    /// The reference system as the file spells it.
    pub fn crs(&self) -> Option<String> {
        let metadata: Metadata = serde_json::from_str(self.metadata?.get()).ok()?;
        let words = metadata.reference_system.filter(|value| !value.is_null());
        match (words, metadata.crs) {
            (Some(serde_json::Value::String(text)), _) => Some(text),
            (Some(serde_json::Value::Number(code)), _) => Some(format!("EPSG:{code}")),
            (Some(other), _) => Some(other.to_string()),
            (None, Some(crs)) => Some(format!("EPSG:{}", crs.get("epsg")?)),
            (None, None) => None,
        }
        .filter(|text| !text.is_empty())
    }
}

impl Geometry<'_> {
    /// A number in 1.0, a text later, such as "2.2".
    pub fn lod(&self) -> Option<Lod> {
        let text = self.lod?.get().trim_matches('"');
        let (whole, part) = text.split_once('.').unwrap_or((text, "0"));
        Some(Lod(whole.parse().ok()?, part.parse().ok()?))
    }
}

/// A JSON object's members in their order, each a part of the text. A key may come twice.
pub(super) struct Entries<'a>(pub Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Entries<'a> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Entries<'a>, D::Error> {
        deserializer.deserialize_map(EntriesVisitor)
    }
}

struct EntriesVisitor;

impl<'de> Visitor<'de> for EntriesVisitor {
    type Value = Entries<'de>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("city objects by their ids")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries<'de>, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Entries(entries))
    }
}
