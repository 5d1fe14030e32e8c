//! A similarity as the project's JSON files write it, and why a file holds none.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::escape::escaped;
use super::json_kind::JsonKind;
use super::text::{LARGEST_TEXT_BYTES, read_text};
use crate::geometry::{Matrix3, NotASimilarity, Similarity, StartError, Vector3};

/// Why a file does not say where a reconstruction stands. `what` is "start" or "alignment".
#[derive(Debug, thiserror::Error)]
pub enum PlacementError {
    #[error("cannot read the {what}: {source}: {}", path.display())]
    Io { what: &'static str, path: PathBuf, source: std::io::Error },
    /// `source` names line, column and key.
    #[error("not a valid {what}: {}; expected {expected} (NaN and infinity are no JSON): {}", escaped(&source.to_string()), path.display())]
    Json { what: &'static str, expected: &'static str, path: PathBuf, source: serde_json::Error },
    #[error(
        "the {what} is no similarity: {source}; expected x_city = scale * rotation * x_sfm + translation, \
         rotation row by row: {}",
        path.display()
    )]
    NotASimilarity { what: &'static str, path: PathBuf, source: NotASimilarity },
    /// A matrix as text.
    #[error(
        "not a valid matrix: {}; expected four rows of four numbers, s R and t in the first three, 0 0 0 1 in the last: {}",
        escaped(found),
        path.display()
    )]
    Matrix { path: PathBuf, found: String },
    #[error("not a valid start: {source}: {}", path.display())]
    Start { path: PathBuf, source: StartError },
    #[error("this is {}, expected {expected}; {remedy}: {}", kind.words(), path.display())]
    OtherKind { path: PathBuf, kind: JsonKind, expected: &'static str, remedy: &'static str },
    #[error(
        "the alignment{} has neither a transform nor a best_candidate, so it places nothing; write a transform into it, or \
         align again from a start: {}",
        in_brackets(verdict),
        path.display()
    )]
    Empty { path: PathBuf, verdict: String },
}

/// The three parts under their names, the rotation row by row.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(expecting = "an object")]
pub(super) struct SimilarityRecord {
    pub scale: f64,
    pub rotation: [[f64; 3]; 3],
    pub translation: [f64; 3],
}

impl SimilarityRecord {
    pub fn check(&self, what: &'static str, path: &Path) -> Result<Similarity, PlacementError> {
        let r = &self.rotation;
        let rotation = Matrix3::from_fn(|row, column| r[row][column]);
        Similarity::try_new(self.scale, rotation, Vector3::from(self.translation))
            .map_err(|source| PlacementError::NotASimilarity { what, path: path.into(), source })
    }
}

/// The text of a file whose faults are told as those of a `what`.
pub(super) fn read_named(path: &Path, what: &'static str) -> Result<String, PlacementError> {
    read_text(path, LARGEST_TEXT_BYTES).map_err(|source| PlacementError::Io { what, path: path.into(), source })
}

/// Takes a text as JSON of a known form.
pub(super) fn parse_json<T: serde::de::DeserializeOwned>(
    text: &str,
    path: &Path,
    what: &'static str,
    expected: &'static str,
) -> Result<T, PlacementError> {
    serde_json::from_str(text).map_err(|source| PlacementError::Json { what, expected, path: path.into(), source })
}

fn in_brackets(word: &str) -> String {
    if word.is_empty() { String::new() } else { format!(" ({word})") }
}
