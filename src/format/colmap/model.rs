//! A COLMAP model's files, text or binary, as records.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::binary::{self, Cursor};
use super::fault::Fault;
use super::records::*;
use super::text;
use crate::format::file::{LARGEST_MODEL_BYTES, is_there, open_regular, read_at_most};

/// Files that every model has; `rigs` and `frames` come with newer releases only.
const NEEDED_STEMS: [&str; 3] = ["cameras", "images", "points3D"];

/// Why a model's file could not be read as COLMAP writes it.
#[derive(Debug, thiserror::Error)]
pub enum ColmapError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path}, {place}, {object}: expected {expected}, got {got}; export the model again from COLMAP")]
    Malformed { path: PathBuf, place: Place, object: String, expected: String, got: String },
}

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// From 1.
    Line(usize),
    /// From 0.
    Byte(u64),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Which of the files that every model has are not in `folder`, in either encoding.
pub fn missing_files(folder: &Path) -> Vec<&'static str> {
    NEEDED_STEMS.into_iter().filter(|stem| find(folder, stem).is_none()).collect()
}

/// The file of the records `stem` (cameras, images, points3D, rigs or frames), for messages.
pub fn record_file(folder: &Path, stem: &str) -> PathBuf {
    find(folder, stem).unwrap_or_else(|| folder.join(format!("{stem}.bin")))
}

/// Reads every record file of `folder`. Whether a file is binary or text is judged by its content.
pub fn read_model(folder: &Path) -> Result<Model, ColmapError> {
    let (points, images) = rayon::join(
        || read_file(folder, "points3D", binary::points, text::points),
        || read_file(folder, "images", binary::images, text::images),
    );
    let (cameras, _) = read_file(folder, "cameras", binary::cameras, text::cameras)?;
    let rigs = read_optional(folder, "rigs", binary::rigs, text::rigs)?;
    let frames = read_optional(folder, "frames", binary::frames, text::frames)?;
    let ((images, encoding), (points, _)) = (images?, points?);
    Ok(Model { encoding, cameras, rigs, frames, images, points })
}

/// The file of that stem. Where a folder holds a whole model in one encoding, only that counts, binary before text, as
/// for COLMAP.
fn find(folder: &Path, stem: &str) -> Option<PathBuf> {
    let file = |stem: &str, extension: &str| folder.join(format!("{stem}.{extension}"));
    let is_whole = |extension: &&str| NEEDED_STEMS.iter().all(|stem| is_there(&file(stem, extension)));
    let extensions = match ["bin", "txt"].into_iter().find(is_whole) {
        Some(whole) => vec![whole],
        None => vec!["bin", "txt"],
    };
    extensions.into_iter().map(|extension| file(stem, extension)).find(|path| is_there(path))
}

type BinaryParser<T> = fn(Cursor<BufReader<File>>) -> Result<T, Fault>;
type TextParser<T> = fn(&[u8]) -> Result<T, Fault>;

/// Bytes fetched from a binary file at once.
const READ_BYTES: usize = 1 << 18;

fn read_optional<T>(
    folder: &Path,
    stem: &str,
    binary: BinaryParser<T>,
    text: TextParser<T>,
) -> Result<Option<T>, ColmapError> {
    if find(folder, stem).is_none() {
        return Ok(None);
    }
    read_file(folder, stem, binary, text).map(|(records, _)| Some(records))
}

fn read_file<T>(
    folder: &Path,
    stem: &str,
    binary: BinaryParser<T>,
    text: TextParser<T>,
) -> Result<(T, Encoding), ColmapError> {
    let path = record_file(folder, stem);
    let mut bytes = Vec::new();
    parse(&path, &mut bytes, binary, text).map_err(|fault| match fault {
        Fault::Unreadable(source) => ColmapError::Unreadable { path: path.clone(), source },
        Fault::Malformed { at, object, expected, got } => {
            let place = if bytes.is_empty() { Place::Byte(at) } else { Place::Line(line_of(&bytes, at)) };
            ColmapError::Malformed { path: path.clone(), place, object, expected, got }
        }
    })
}

/// Text is read whole, into `bytes`.
fn parse<T>(
    path: &Path,
    bytes: &mut Vec<u8>,
    binary: BinaryParser<T>,
    text: TextParser<T>,
) -> Result<(T, Encoding), Fault> {
    let file = open_regular(path).map_err(Fault::Unreadable)?;
    let length = file.metadata().map_err(Fault::Unreadable)?.len();
    let mut reader = BufReader::with_capacity(READ_BYTES, file);
    let start = reader.fill_buf().map_err(Fault::Unreadable)?;
    let by_name = if path.extension().is_some_and(|e| e == "txt") { Encoding::Text } else { Encoding::Binary };
    if encoding_of(start, by_name) == Encoding::Binary {
        return Ok((binary(Cursor::new(reader, length))?, Encoding::Binary));
    }
    *bytes = read_at_most(reader, length, LARGEST_MODEL_BYTES).map_err(Fault::Unreadable)?;
    Ok((text(bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes))?, Encoding::Text))
}

/// What some editors put before text.
const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";

/// A binary file starts with a count of 8 bytes, which are not all letters, digits and blanks (the high ones are zero). What is shorter is
/// what its name says.
fn encoding_of(start: &[u8], by_name: Encoding) -> Encoding {
    match start.strip_prefix(UTF8_MARK).unwrap_or(start).first_chunk::<8>() {
        Some(start) if start.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace()) => Encoding::Text,
        Some(_) => Encoding::Binary,
        None => by_name,
    }
}

fn line_of(bytes: &[u8], at: u64) -> usize {
    1 + bytes.iter().zip(0..at).filter(|(byte, _)| **byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary_and_text_are_told_apart_by_their_first_bytes() {
        let [text, binary] = [Encoding::Text, Encoding::Binary];
        for start in [&b"# Camera list"[..], b"1 PINHOLE 640", b"\xEF\xBB\xBF# Camera list"] {
            assert_eq!(encoding_of(start, binary), text);
        }
        for start in [&[1, 0, 0, 0, 0, 0, 0, 0, 5][..], &[0xFF; 16]] {
            assert_eq!(encoding_of(start, text), binary);
        }
        assert!(encoding_of(b"", text) == text && encoding_of(b"", binary) == binary);
    }

    #[test]
    fn text_with_a_mark_before_it_is_read_and_its_lines_are_counted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cameras.txt");
        std::fs::write(&path, b"\xEF\xBB\xBF# cameras\n1 PINHOLE 640 480 1 1 1 1\n").unwrap();
        assert_eq!(read_file(folder.path(), "cameras", binary::cameras, text::cameras).unwrap().0.len(), 1);
        std::fs::write(&path, b"\xEF\xBB\xBF# cameras\n1 PINHOLE 640\n").unwrap();
        let error = read_file(folder.path(), "cameras", binary::cameras, text::cameras).unwrap_err();
        assert!(matches!(error, ColmapError::Malformed { place: Place::Line(2), .. }), "{error}");
    }
}
