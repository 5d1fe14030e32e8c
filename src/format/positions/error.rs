//! Why positions cannot be read.

use std::path::PathBuf;

use crate::format::escaped;

/// Why a file, folder or database has no positions to give.
#[derive(Debug, thiserror::Error)]
pub enum PositionsError {
    #[error("cannot read the {what}: {source}: {}", path.display())]
    Io { what: &'static str, path: PathBuf, source: std::io::Error },
    #[error("line {line}: {}; expected {expected}: {}", escaped(found), path.display())]
    Line { path: PathBuf, line: usize, found: String, expected: &'static str },
    #[error("{}; expected {expected}: {}", escaped(found), path.display())]
    Content { path: PathBuf, found: String, expected: &'static str },
    #[error("the database cannot be read: {}; expected database.db of COLMAP: {}", escaped(&source.to_string()), path.display())]
    Database { path: PathBuf, source: rusqlite::Error },
    #[error("not a valid OpenSfM reconstruction: {}: {}", escaped(&source.to_string()), path.display())]
    Json { path: PathBuf, source: serde_json::Error },
}
