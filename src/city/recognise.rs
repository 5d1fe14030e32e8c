//! Which format a file is in: by its content first, by its name second.

use std::path::Path;

use super::CityError;
use crate::format::gltf::is_glb;

pub(super) enum Format {
    Obj,
    /// One city, or a sequence of features.
    CityJson,
    /// JSON or GLB; the reader tells them apart.
    Gltf,
}

/// Bytes looked at; an OBJ file says what it is within its first lines, after whatever remarks.
const LOOKED_AT: usize = 1 << 16;

/// Words that begin the lines of an OBJ file.
const OBJ_WORDS: [&str; 13] = ["v", "vn", "vt", "vp", "f", "fo", "o", "g", "s", "l", "p", "mtllib", "usemtl"];

/// Tells the format, or what the file seems to be instead.
pub(super) fn recognise(bytes: &[u8], path: &Path) -> Result<Format, CityError> {
    let other = |found, remedy| Err(CityError::OtherFormat { path: path.to_owned(), found, remedy });
    if is_glb(bytes) {
        return Ok(Format::Gltf);
    }
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(LOOKED_AT)]);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let converts = "convert it";
    match bytes {
        [] => return other("the file is empty", "write it again"),
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => return other("this is UTF-16 text", "save it as UTF-8"),
        [b'P', b'K', 3, 4, ..] => return other("this is a ZIP archive", "unpack it"),
        [0x1F, 0x8B, ..] => return other("this is a gzip archive", "unpack it"),
        _ if text.starts_with('{') && text.contains("\"CityJSON") => return Ok(Format::CityJson),
        _ if text.starts_with('{') => return Ok(Format::Gltf),
        _ if text.starts_with("ply") => return other("this is a PLY file", converts),
        _ if text.starts_with("solid") => return other("this is an STL file", converts),
        _ if text.starts_with('<') => return other("this is XML (CityGML?)", converts),
        _ => {}
    }
    let is_obj_line = |line: &str| line.split_whitespace().next().is_some_and(|word| OBJ_WORDS.contains(&word));
    let is_named_obj = path.extension().is_some_and(|name| name.eq_ignore_ascii_case("obj"));
    if is_named_obj || text.lines().any(is_obj_line) {
        return Ok(Format::Obj);
    }
    other("the file is of an unknown format", converts)
}
