//! tileset.json.

use nalgebra::Matrix4;
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::format::surface_error::{Place, SurfaceError};
use crate::format::uri::shortened;

/// Bytes looked at to know a tileset.
const LOOKED_AT: usize = 1 << 16;

/// Extensions that a tileset may need and that are read, or say nothing of surfaces.
const READ: [&str; 5] = [
    "3DTILES_content_gltf",
    "3DTILES_multiple_contents",
    "3DTILES_metadata",
    "3DTILES_bounding_volume_S2",
    "3DTILES_batch_table_hierarchy",
];

/// Whether a file begins like a tileset: JSON that tells errors in metres.
pub fn is_tileset(start: &[u8]) -> bool {
    let start = &start[..start.len().min(LOOKED_AT)];
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start).trim_ascii_start();
    text.starts_with(b"{") && memchr::memmem::find(text, b"\"geometricError\"").is_some()
}

/// A tree of tiles and how to take it.
#[derive(Debug)]
pub(super) struct Tileset {
    pub version: String,
    pub up: UpAxis,
    pub root: Tile,
}

/// The axis of glTF content that points up; y, but for files before 3D Tiles 1.0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum UpAxis {
    X,
    #[default]
    Y,
    Z,
}

/// Whether children stand beside their parent's content or in its place.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
pub(super) enum Refine {
    #[serde(rename = "ADD", alias = "add", alias = "Add")]
    Add,
    #[serde(rename = "REPLACE", alias = "replace", alias = "Replace")]
    Replace,
}

/// A tile with content or children.
#[derive(Debug, Default)]
pub(super) struct Tile {
    /// To the parent's frame.
    pub transform: Option<Matrix4<f64>>,
    pub refine: Option<Refine>,
    /// URIs.
    pub contents: Vec<String>,
    pub children: Vec<Slot>,
    pub is_implicit: bool,
}

/// A tile, or nothing where it shows nothing: `{}` takes three bytes of the file, and eight here.
#[derive(Debug, Deserialize)]
#[serde(from = "Written")]
pub(super) struct Slot(pub Option<Box<Tile>>);

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Written {
    transform: Option<Box<[f64; 16]>>,
    refine: Option<Refine>,
    content: Option<Content>,
    #[serde(default)]
    contents: Vec<Content>,
    #[serde(default)]
    children: Vec<Slot>,
    implicit_tiling: Option<IgnoredAny>,
    extensions: Option<Extensions>,
}

#[derive(Deserialize)]
struct Content {
    #[serde(alias = "url")]
    uri: Option<String>,
}

#[derive(Deserialize)]
struct Extensions {
    #[serde(rename = "3DTILES_implicit_tiling")]
    implicit: Option<IgnoredAny>,
    #[serde(rename = "3DTILES_multiple_contents")]
    multiple: Option<Multiple>,
}

#[derive(Deserialize)]
struct Multiple {
    #[serde(alias = "content", default)]
    contents: Vec<Content>,
}

impl From<Written> for Slot {
    fn from(written: Written) -> Slot {
        let Written { transform, refine, content, contents, children, implicit_tiling, extensions } = written;
        let (implicit, multiple) = extensions.map_or((None, None), |found| (found.implicit, found.multiple));
        let further = multiple.into_iter().flat_map(|multiple| multiple.contents);
        let contents: Vec<String> =
            content.into_iter().chain(contents).chain(further).filter_map(|content| content.uri).collect();
        let is_implicit = implicit_tiling.is_some() || implicit.is_some();
        if contents.is_empty() && !is_implicit && children.iter().all(|Slot(child)| child.is_none()) {
            return Slot(None);
        }
        let transform = transform.map(|columns| Matrix4::from_column_slice(&columns[..]));
        Slot(Some(Box::new(Tile { transform, refine, contents, children, is_implicit })))
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    asset: Asset,
    root: Slot,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Asset {
    version: String,
    gltf_up_axis: Option<String>,
}

impl Tileset {
    pub fn parse(json: &[u8]) -> Result<Tileset, SurfaceError> {
        let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
        let document: Document = serde_json::from_slice(json).map_err(|error| {
            let place = Place::Part(format!("JSON line {} column {}", error.line(), error.column()));
            SurfaceError::at(place, format!("this is no tileset: {error}; expected asset, root and its children"))
        })?;
        let Document { asset, root: Slot(root), extensions_required } = document;
        if !asset.version.starts_with("1.") && !asset.version.starts_with("0.") {
            let found = shortened(&asset.version);
            let problem = format!("3D Tiles version {found}, expected 1.0 or 1.1; convert the tileset");
            return Err(SurfaceError::at(Place::Part("asset.version".to_owned()), problem));
        }
        if let Some(name) = extensions_required.iter().find(|name| !READ.contains(&name.as_str())) {
            let problem =
                format!("the tileset needs the extension {}, which is not read; write it without", shortened(name));
            return Err(SurfaceError::at(Place::Part("extensionsRequired".to_owned()), problem));
        }
        let up = match asset.gltf_up_axis.as_deref() {
            Some("X" | "x") => UpAxis::X,
            Some("Z" | "z") => UpAxis::Z,
            _ => UpAxis::Y,
        };
        Ok(Tileset { version: asset.version, up, root: root.map_or_else(Tile::default, |root| *root) })
    }
}

impl Tile {
    /// Whether it or one below it has content.
    pub fn has_content(&self) -> bool {
        !self.contents.is_empty()
            || self.is_implicit
            || self.children.iter().flat_map(|Slot(child)| child).any(|child| child.has_content())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(root: &str) -> Tileset {
        Tileset::parse(format!(r#"{{"asset": {{"version": "1.0", "gltfUpAxis": "Z"}}, "root": {root}}}"#).as_bytes())
            .unwrap()
    }

    #[test]
    fn tiles_that_show_nothing_take_eight_bytes() {
        assert_eq!(size_of::<Slot>(), 8);
        let tileset = parse(r#"{"children": [{}, {"children": [{}, {"content": {}}]}, {"content": {"url": "a"}}]}"#);
        let is_kept: Vec<bool> = tileset.root.children.iter().map(|Slot(child)| child.is_some()).collect();
        assert_eq!(is_kept, [false, false, true]);
        assert!(tileset.root.has_content());
        assert_eq!(tileset.up, UpAxis::Z);
    }

    #[test]
    fn an_empty_tileset_has_no_content() {
        let tileset = parse(r#"{"boundingVolume": {"box": []}, "geometricError": 1, "viewerRequestVolume": {}}"#);
        assert!(!tileset.root.has_content());
        assert_eq!((tileset.version.as_str(), tileset.root.refine), ("1.0", None));
    }

    #[test]
    fn refinement_is_one_of_two_words() {
        assert_eq!(parse(r#"{"refine": "add", "content": {"uri": "a"}}"#).root.refine, Some(Refine::Add));
        let odd = br#"{"asset": {"version": "1.0"}, "root": {"refine": "MERGE"}}"#;
        assert!(Tileset::parse(odd).unwrap_err().to_string().contains("MERGE"));
    }
}
