//! COLMAP models: cameras, images, points3D, and (since COLMAP 3.12) rigs and frames; binary and text.
//!
//! Records stand here as the files hold them, with the files' own ids; what they mean together is for
//! `reconstruction` to judge. <https://colmap.github.io/format.html> describes the files.

mod binary;
mod records;
mod text;
mod write;

use std::fs;
use std::path::{Path, PathBuf};

pub use records::*;
pub use write::{write_cameras, write_frames, write_images, write_points, write_rigs};

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
    Byte(usize),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// What was wrong at a byte of a file; the reader of the whole file adds its path and, for text, the line.
#[derive(Debug)]
struct Fault {
    at: usize,
    object: String,
    expected: String,
    got: String,
}

impl Fault {
    fn new(at: usize, object: impl Into<String>, expected: impl Into<String>, got: impl Into<String>) -> Fault {
        Fault { at, object: object.into(), expected: expected.into(), got: got.into() }
    }
}

/// Whether `folder` holds the three files of a model, in either encoding (not whether they can be read).
pub fn is_model_folder(folder: &Path) -> bool {
    NEEDED_STEMS.iter().all(|stem| find(folder, stem).is_some())
}

/// Reads every record file of `folder`. Whether a file is binary or text is judged by its content.
pub fn read_model(folder: &Path) -> Result<Model, ColmapError> {
    let (points, images) = rayon::join(
        || read_file(folder, "points3D", binary::points, text::points),
        || read_file(folder, "images", binary::images, text::images),
    );
    let images_are_text = find(folder, "images").is_some_and(|path| path.extension().is_some_and(|e| e == "txt"));
    Ok(Model {
        encoding: if images_are_text { Encoding::Text } else { Encoding::Binary },
        cameras: read_file(folder, "cameras", binary::cameras, text::cameras)?,
        rigs: read_optional(folder, "rigs", binary::rigs, text::rigs)?,
        frames: read_optional(folder, "frames", binary::frames, text::frames)?,
        images: images?,
        points: points?,
    })
}

/// The file of that stem; binary first where both are there, as COLMAP does.
fn find(folder: &Path, stem: &str) -> Option<PathBuf> {
    ["bin", "txt"].iter().map(|ext| folder.join(format!("{stem}.{ext}"))).find(|path| path.is_file())
}

type Parser<T> = fn(&[u8]) -> Result<T, Fault>;

fn read_optional<T>(folder: &Path, stem: &str, bin: Parser<T>, txt: Parser<T>) -> Result<Option<T>, ColmapError> {
    if find(folder, stem).is_none() {
        return Ok(None);
    }
    read_file(folder, stem, bin, txt).map(Some)
}

fn read_file<T>(folder: &Path, stem: &str, bin: Parser<T>, txt: Parser<T>) -> Result<T, ColmapError> {
    let path = find(folder, stem).unwrap_or_else(|| folder.join(format!("{stem}.bin")));
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(ColmapError::Unreadable { path, source }),
    };
    let is_text = is_text(&bytes, path.extension().is_some_and(|e| e == "txt"));
    let parsed = if is_text { txt(&bytes) } else { bin(&bytes) };
    parsed.map_err(|fault| {
        let place = if is_text { Place::Line(line_of(&bytes, fault.at)) } else { Place::Byte(fault.at) };
        ColmapError::Malformed { path, place, object: fault.object, expected: fault.expected, got: fault.got }
    })
}

/// A binary file starts with a count of 8 bytes whose high ones are zero, and text never holds a zero byte.
fn is_text(bytes: &[u8], named_as_text: bool) -> bool {
    match bytes.first_chunk::<8>() {
        Some(start) => !start.contains(&0),
        None => named_as_text,
    }
}

fn line_of(bytes: &[u8], at: usize) -> usize {
    1 + bytes[..at.min(bytes.len())].iter().filter(|b| **b == b'\n').count()
}
