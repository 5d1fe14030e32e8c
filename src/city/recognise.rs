//! Which format a file is in: by its content first, by its name second.

use std::io::Read;
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::CityError;
use super::foreign::foreign_format;
use crate::format::city_index::is_city_index;
use crate::format::file::open_regular;
use crate::format::footprints::{is_geopackage, is_shapefile};
use crate::format::gltf::is_glb;
use crate::format::meshes::{is_ply_mesh, is_stl};
use crate::format::tileset::is_tile;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Obj,
    /// One city, or a sequence of features.
    CityJson,
    /// JSON or GLB; the reader tells them apart.
    Gltf,
    /// The root of a tree of tiles.
    Tileset,
    /// One tile of 3D Tiles by itself.
    Tile,
    Shapefile,
    GeoPackage,
    #[cfg(feature = "flatcitybuf")]
    FlatCityBuf,
    Stl,
    PlyMesh,
}

/// Whether bytes are of a format.
type Recogniser = fn(&[u8]) -> bool;

/// Bytes looked at; an OBJ file says what it is within its first lines, after whatever remarks.
const LOOKED_AT: usize = 1 << 16;

/// Words that begin the lines of an OBJ file.
const OBJ_WORDS: [&str; 13] = ["v", "vn", "vt", "vp", "f", "fo", "o", "g", "s", "l", "p", "mtllib", "usemtl"];

/// Whether the file is an index of a city, by its first bytes.
pub fn is_index_at(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = open_regular(path).and_then(|file| file.take(MAGIC_BYTES).read_to_end(&mut start));
    read.is_ok() && is_city_index(&start)
}

/// Bytes that tell an index.
const MAGIC_BYTES: u64 = 8;

/// Tells the format, or what the file seems to be instead.
pub(super) fn recognise(bytes: &[u8], path: &Path) -> Result<Format, CityError> {
    let other = |(found, remedy)| Err(CityError::OtherFormat { path: path.to_owned(), found, remedy });
    if bytes.is_empty() {
        return other(("the file is empty", "write it again"));
    }
    if is_city_index(bytes) {
        return other(("this is an index of a whole city", "give it alone, as CITY"));
    }
    let by_mark: &[(Recogniser, Format)] = &[
        (is_glb, Format::Gltf),
        (is_tile, Format::Tile),
        (is_shapefile, Format::Shapefile),
        (is_geopackage, Format::GeoPackage),
        #[cfg(feature = "flatcitybuf")]
        (crate::format::flatcitybuf::is_flatcitybuf, Format::FlatCityBuf),
        (is_stl, Format::Stl),
        (is_ply_mesh, Format::PlyMesh),
    ];
    if let Some((_, format)) = by_mark.iter().find(|(is, _)| is(bytes)) {
        return Ok(*format);
    }
    if let Some(foreign) = foreign_format(bytes) {
        return other(foreign);
    }
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(LOOKED_AT)]);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let converts = "convert it";
    match text {
        _ if text.starts_with('{') => return json_format(bytes, text, path).or_else(other),
        _ if text.starts_with('[') => return other(("this JSON is no city model", converts)),
        _ if text.starts_with("ply") => {
            return other(("this is a PLY cloud without faces", "a cloud goes in the place of the reconstruction"));
        }
        _ if text.starts_with('<') => return other(xml_format(text)),
        _ => {}
    }
    let is_obj_line = |line: &str| line.split_whitespace().next().is_some_and(|word| OBJ_WORDS.contains(&word));
    let is_named_obj = path.extension().is_some_and(|name| name.eq_ignore_ascii_case("obj"));
    if is_named_obj || text.lines().any(is_obj_line) {
        return Ok(Format::Obj);
    }
    Err(CityError::UnknownFormat { path: path.to_owned() })
}

/// The keys of a JSON object that tell what it is; their order in the file means nothing.
#[derive(Deserialize)]
struct Keys {
    #[serde(rename = "type")]
    kind: Option<serde_json::Value>,
    asset: Option<IgnoredAny>,
    #[serde(rename = "CityObjects")]
    city_objects: Option<IgnoredAny>,
    #[serde(rename = "geometricError")]
    geometric_error: Option<IgnoredAny>,
}

/// `beginning`: what was looked at. The whole is walked only where that does not say it.
fn json_format(bytes: &[u8], beginning: &str, path: &Path) -> Result<Format, (&'static str, &'static str)> {
    if beginning.contains("\"CityJSON\"") || beginning.contains("\"CityJSONFeature\"") {
        return Ok(Format::CityJson);
    }
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let is_named_gltf = path.extension().is_some_and(|name| name.eq_ignore_ascii_case("gltf"));
    let Some(Ok(keys)) = serde_json::Deserializer::from_slice(bytes).into_iter::<Keys>().next() else {
        // Their readers say where a text is broken.
        return match beginning.contains("\"CityObjects\"") {
            true => Ok(Format::CityJson),
            false if is_named_gltf || beginning.contains("\"asset\"") => Ok(Format::Gltf),
            false => Err(("this JSON is broken", "write it again")),
        };
    };
    match keys.kind.as_ref().and_then(serde_json::Value::as_str) {
        Some("FeatureCollection" | "Feature" | "Polygon" | "MultiPolygon" | "GeometryCollection") => {
            return Err(("this is GeoJSON, which has outlines and no walls", "give the model itself"));
        }
        Some("Topology") => return Err(("this is TopoJSON, which has outlines and no walls", "give the model itself")),
        Some("CityJSON" | "CityJSONFeature") => return Ok(Format::CityJson),
        _ => {}
    }
    match keys {
        Keys { city_objects: Some(_), .. } => Ok(Format::CityJson),
        Keys { geometric_error: Some(_), .. } => Ok(Format::Tileset),
        Keys { asset: Some(_), .. } => Ok(Format::Gltf),
        _ if is_named_gltf => Ok(Format::Gltf),
        _ => Err(("this JSON is no city model", "give the city model first")),
    }
}

fn xml_format(text: &str) -> (&'static str, &'static str) {
    const KINDS: [(&str, &str, &str); 6] = [
        ("<COLLADA", "this is a COLLADA file", "convert it to OBJ or glTF (assimp export IN.dae OUT.glb)"),
        ("<kml", "this is a KML file", "get the city as CityJSON or CityGML"),
        ("<svg", "this is an SVG drawing", "give the city model itself"),
        ("<!DOCTYPE html", "this is a web page", "download the file itself"),
        ("CityModel", "this is a CityModel outside the namespaces of CityGML 1 to 3", "write it again as CityGML 2"),
        ("<html", "this is a web page", "download the file itself"),
    ];
    let known = KINDS.into_iter().find(|kind| text.contains(kind.0)).map(|kind| (kind.1, kind.2));
    known.unwrap_or(("this is XML of an unknown kind", "convert it"))
}
