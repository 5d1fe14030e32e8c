//! STL, binary and text.

use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;

/// Remarks, then the number of triangles.
const HEADER_BYTES: usize = 84;

/// Normal, three corners, two bytes for anything.
const TRIANGLE_BYTES: usize = 50;

/// Bytes looked at for the words of the text form.
const LOOKED_AT: usize = 1 << 16;

/// Whether a file is STL: as long as its number of triangles asks for, or text with facets. Binary files may begin with `solid`, too.
pub fn is_stl(bytes: &[u8]) -> bool {
    binary(bytes).is_some() || is_text(bytes)
}

/// Reads a file; what has no name of its own is called `name`.
pub fn read_stl(bytes: &[u8], name: &str) -> Result<SurfaceFile, SurfaceError> {
    match binary(bytes) {
        Some(triangles) => read_binary(triangles, name),
        None if is_text(bytes) => read_text(bytes, name),
        None => {
            let problem = format!("{} bytes do not hold the triangles that the STL says; get it again", bytes.len());
            Err(SurfaceError::whole(problem))
        }
    }
}

/// The triangles of a binary file.
fn binary(bytes: &[u8]) -> Option<&[u8]> {
    let (header, triangles) = bytes.split_at_checked(HEADER_BYTES)?;
    let count = u32::from_le_bytes(header[HEADER_BYTES - 4..].try_into().ok()?);
    // Without triangles any 84 bytes with zeros at the end would do.
    let is_whole = count > 0 && triangles.len() as u64 == TRIANGLE_BYTES as u64 * u64::from(count);
    is_whole.then_some(triangles)
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes[..bytes.len().min(LOOKED_AT)].trim_ascii_start();
    let has = |word: &[u8]| memchr::memmem::find(start, word).is_some();
    start.starts_with(b"solid") && (has(b"facet") || has(b"endsolid"))
}

fn read_binary(triangles: &[u8], name: &str) -> Result<SurfaceFile, SurfaceError> {
    let mut builder = SurfaceBuilder::default();
    builder.file.format = "STL (binary)".to_owned();
    let object = builder.add_object(name.to_owned(), "Mesh", None);
    for (number, triangle) in triangles.chunks_exact(TRIANGLE_BYTES).enumerate() {
        let float = |at: usize| {
            let bytes = [triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]];
            f64::from(f32::from_le_bytes(bytes))
        };
        let corners = [12, 24, 36].map(|at| [float(at), float(at + 4), float(at + 8)]);
        if !corners.iter().flatten().all(|value| value.is_finite()) {
            let problem = format!("a corner of triangle {} is not finite; write the STL again", number + 1);
            let byte = HEADER_BYTES + number * TRIANGLE_BYTES;
            return Err(SurfaceError::at(Place::Byte(byte as u64), problem));
        }
        builder.add_surface([&corners[..]], SurfaceTraits { object, ..SurfaceTraits::default() })?;
    }
    Ok(builder.file)
}

/// Lines of one word and, for corners, three numbers.
fn read_text(bytes: &[u8], name: &str) -> Result<SurfaceFile, SurfaceError> {
    let mut builder = SurfaceBuilder::default();
    builder.file.format = "STL (text)".to_owned();
    let (mut solid, mut corners, mut byte) = (None, Vec::new(), 0_u64);
    for (number, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let at = Place::Line { line: number as u64 + 1, byte };
        byte += line.len() as u64;
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_whitespace();
        let wrong = |problem: &str| SurfaceError::at(at.clone(), format!("{problem}; write the STL again"));
        match (words.next().map(str::to_ascii_lowercase).as_deref(), solid) {
            (None | Some("outer" | "endloop"), _) => {}
            (Some("solid"), None) => {
                let named = words.collect::<Vec<_>>().join(" ");
                let id = if named.is_empty() { name.to_owned() } else { named };
                solid = Some(builder.add_object(id, "Mesh", None));
            }
            (Some("endsolid"), Some(_)) => solid = None,
            (Some("facet"), Some(_)) => corners.clear(),
            (Some("vertex"), Some(_)) => {
                corners.push(corner(words).ok_or_else(|| wrong("expected three finite numbers"))?)
            }
            (Some("endfacet"), Some(object)) if corners.len() == 3 => {
                builder.add_surface([&corners[..]], SurfaceTraits { object, ..SurfaceTraits::default() })?;
            }
            (Some("endfacet"), _) => return Err(wrong("a facet has three corners")),
            _ => return Err(wrong("expected solid, facet, vertex and their ends")),
        }
    }
    match solid {
        None => Ok(builder.file),
        Some(object) => {
            let problem = "the STL is cut off: no endsolid; get it again";
            Err(SurfaceError::at(Place::Byte(byte), problem).of(builder.object_id(Some(object))))
        }
    }
}

fn corner<'t>(mut words: impl Iterator<Item = &'t str>) -> Option<[f64; 3]> {
    let mut number =
        || words.next().and_then(|word| fast_float2::parse(word).ok()).filter(|value: &f64| value.is_finite());
    let corner = [number()?, number()?, number()?];
    words.next().is_none().then_some(corner)
}
