//! One file, filled through a buffer.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::report::ReportError;

/// Why a result could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    #[error("cannot write {path}: {source}; choose a folder that can be written")]
    Unwritable { path: PathBuf, source: std::io::Error },
    #[error("cannot write {path}: expected {expected}, got {got}")]
    Unfit { path: PathBuf, expected: &'static str, got: String },
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error("cannot write {path} as JSON: {source}")]
    Json { path: PathBuf, source: serde_json::Error },
}

/// Bytes gathered before each write to a file.
const WRITE_BYTES: usize = 1 << 20;

/// Makes a file and has `write` fill it.
pub(super) fn write_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), ExportError> {
    let written = File::create(path).and_then(|file| {
        let mut out = BufWriter::with_capacity(WRITE_BYTES, file);
        write(&mut out)?;
        out.flush()
    });
    written.map_err(|source| ExportError::Unwritable { path: path.into(), source })
}
