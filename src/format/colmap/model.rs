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
const NEEDED_STEMS: [&str; 3] = ["cameras", "images", POINTS];

const POINTS: &str = "points3D";

/// Why a model's file could not be read as COLMAP writes it.
#[derive(Debug, thiserror::Error)]
pub enum ColmapError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path}, {place}, {object}: expected {expected}, got {got}; {remedy}")]
    Malformed { path: PathBuf, place: Place, object: String, expected: String, got: String, remedy: Remedy },
    #[error("{path}: it is UTF-16 text, expected UTF-8; save it again as UTF-8 (editors call it an encoding)")]
    Utf16 { path: PathBuf },
}

/// What to do about a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// COLMAP wrote it.
    ExportAgain,
    /// Somebody else did, or it was edited.
    WriteAgain,
}

impl Remedy {
    /// By what COLMAP puts before the records of a text file. A binary file says nothing of who wrote it.
    fn of(text: &[u8]) -> Remedy {
        let starts =
            ["# Camera list with", "# Image list with", "# 3D point list with", "# Rig calib", "# Frame list with"];
        match starts.iter().any(|start| text.starts_with(start.as_bytes())) {
            true => Remedy::ExportAgain,
            false => Remedy::WriteAgain,
        }
    }
}

impl std::fmt::Display for Remedy {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Remedy::ExportAgain => "export the model again from COLMAP",
            Remedy::WriteAgain => {
                "write it again with the program that made it (https://colmap.github.io/format.html says how it should be)"
            }
        })
    }
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

/// Which of the files that every model has are not in `folder`, in either encoding. The points may be a [`cloud_file`].
pub fn missing_files(folder: &Path) -> Vec<&'static str> {
    let is_missing = |stem: &&str| find(folder, stem).is_none() && (*stem != POINTS || cloud_file(folder).is_none());
    NEEDED_STEMS.into_iter().filter(is_missing).collect()
}

/// The points of a model as a PLY cloud, as trainers of splats keep them beside cameras and images, where there is no other
/// file of them.
pub fn cloud_file(folder: &Path) -> Option<PathBuf> {
    let cloud = folder.join("points3D.ply");
    (is_there(&cloud) && find(folder, POINTS).is_none()).then_some(cloud)
}

/// The file of the records `stem` (cameras, images, points3D, rigs or frames), for messages.
pub fn record_file(folder: &Path, stem: &str) -> PathBuf {
    find(folder, stem).unwrap_or_else(|| folder.join(format!("{stem}.bin")))
}

/// Reads every record file of `folder`. Whether a file is binary or text is judged by its content. Without a file of points
/// there are none.
pub fn read_model(folder: &Path) -> Result<Model, ColmapError> {
    let (points, images) = rayon::join(
        || read_optional(folder, POINTS, binary::points, text::points),
        || read_file(folder, "images", binary::images, text::images),
    );
    let cameras = read_file(folder, "cameras", binary::cameras, text::cameras)?;
    let rigs = read_optional(folder, "rigs", binary::rigs, text::rigs)?;
    let frames = read_optional(folder, "frames", binary::frames, text::frames)?;
    let (images, points) = (images?, points?);
    let miscount = |stem, announced: Option<usize>, found| {
        announced.filter(|count| *count != found).map(|announced| Miscount { stem, announced, found })
    };
    let announced_points = points.as_ref().and_then(|read| read.announced);
    let points = points.map_or(PointRecords::with_capacity(0, 0), |read| read.records);
    let miscounts = [
        miscount("cameras", cameras.announced, cameras.records.len()),
        miscount("images", images.announced, images.records.len()),
        miscount(POINTS, announced_points, points.ids.len()),
    ];
    Ok(Model {
        encoding: images.encoding,
        cameras: cameras.records,
        rigs: rigs.map(|read| read.records),
        frames: frames.map(|read| read.records),
        images: images.records,
        points,
        miscounts: miscounts.into_iter().flatten().collect(),
    })
}

/// The records of one file.
struct Read<T> {
    records: T,
    encoding: Encoding,
    /// How many there should be, where text says so.
    announced: Option<usize>,
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
) -> Result<Option<Read<T>>, ColmapError> {
    if find(folder, stem).is_none() {
        return Ok(None);
    }
    read_file(folder, stem, binary, text).map(Some)
}

fn read_file<T>(
    folder: &Path,
    stem: &str,
    binary: BinaryParser<T>,
    text: TextParser<T>,
) -> Result<Read<T>, ColmapError> {
    let path = record_file(folder, stem);
    let mut bytes = Vec::new();
    parse(&path, &mut bytes, binary, text).map_err(|fault| match fault {
        Fault::Unreadable(source) => ColmapError::Unreadable { path: path.clone(), source },
        Fault::Utf16 => ColmapError::Utf16 { path: path.clone() },
        Fault::Malformed { at, object, expected, got } => {
            let place = if bytes.is_empty() { Place::Byte(at) } else { Place::Line(line_of(&bytes, at)) };
            ColmapError::Malformed { path: path.clone(), place, object, expected, got, remedy: Remedy::of(&bytes) }
        }
    })
}

/// Text is read whole, into `bytes`.
fn parse<T>(path: &Path, bytes: &mut Vec<u8>, binary: BinaryParser<T>, text: TextParser<T>) -> Result<Read<T>, Fault> {
    let file = open_regular(path).map_err(Fault::Unreadable)?;
    let length = file.metadata().map_err(Fault::Unreadable)?.len();
    let mut reader = BufReader::with_capacity(READ_BYTES, file);
    let start = reader.fill_buf().map_err(Fault::Unreadable)?;
    if UTF16_MARKS.iter().any(|mark| start.starts_with(mark)) {
        return Err(Fault::Utf16);
    }
    let by_name = if path.extension().is_some_and(|e| e == "txt") { Encoding::Text } else { Encoding::Binary };
    if encoding_of(start, by_name) == Encoding::Binary {
        let records = binary(Cursor::new(reader, length))?;
        return Ok(Read { records, encoding: Encoding::Binary, announced: None });
    }
    *bytes = read_at_most(reader, length, LARGEST_MODEL_BYTES).map_err(Fault::Unreadable)?;
    let unmarked = bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes);
    Ok(Read { records: text(unmarked)?, encoding: Encoding::Text, announced: text::announced(unmarked) })
}

/// What Windows' older editors and PowerShell put before text: a count of records would be of 64 thousand and more.
const UTF16_MARKS: [&[u8]; 2] = [b"\xFF\xFE", b"\xFE\xFF"];

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
        assert_eq!(read_file(folder.path(), "cameras", binary::cameras, text::cameras).unwrap().records.len(), 1);
        std::fs::write(&path, b"\xEF\xBB\xBF# cameras\n1 PINHOLE 640\n").unwrap();
        let error = read_file(folder.path(), "cameras", binary::cameras, text::cameras).err().unwrap();
        assert!(matches!(error, ColmapError::Malformed { place: Place::Line(2), .. }), "{error}");
    }
}
