//! The GLB container: a header, a chunk of JSON, a chunk of bytes.

use super::{GltfError, GltfProblem};

const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// Whether these bytes begin like a GLB file.
pub fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(b"glTF")
}

/// The JSON, and the bytes if there are any. No length is believed before it is compared with what is there.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), GltfError> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(truncated(0, "the header", HEADER_BYTES as u64, bytes.len() as u64));
    };
    if version != 2 {
        return Err(GltfError::at("byte 4", GltfProblem::Version { found: version.to_string() }));
    }
    // What stands behind the claimed length belongs to nobody.
    let Some(bytes) = bytes.get(..length as usize) else {
        return Err(truncated(8, "the header", u64::from(length), bytes.len() as u64));
    };
    let (json, json_end) = chunk(bytes, HEADER_BYTES, "JSON")?;
    if json_end >= bytes.len() {
        return Ok((json, None));
    }
    let (binary, _) = chunk(bytes, json_end, "BIN\0")?;
    Ok((json, Some(binary)))
}

fn chunk<'a>(bytes: &'a [u8], at: usize, expected: &'static str) -> Result<(&'a [u8], usize), GltfError> {
    let start = at + CHUNK_HEADER_BYTES;
    let (Some(length), Some(kind)) = (word(bytes, at), bytes.get(at + 4..start)) else {
        let left = bytes.len().saturating_sub(at);
        return Err(truncated(at, "a chunk's header", CHUNK_HEADER_BYTES as u64, left as u64));
    };
    if kind != expected.as_bytes() {
        let found = kind.escape_ascii().to_string();
        return Err(GltfError::at(format!("byte {}", at + 4), GltfProblem::Chunk { expected, found }));
    }
    let end = start as u64 + u64::from(length);
    match usize::try_from(end).ok().and_then(|end| Some((bytes.get(start..end)?, end))) {
        Some((data, end)) => Ok((data, end)),
        None => Err(truncated(at, "a chunk", u64::from(length), (bytes.len() - start) as u64)),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

fn truncated(byte: usize, what: &'static str, claimed: u64, found: u64) -> GltfError {
    GltfError::at(format!("byte {byte}"), GltfProblem::Truncated { what, claimed, found })
}
