//! Which form positions have, by content.

use std::io::Read;
use std::path::Path;

use super::error::PositionsError;
use super::record::PositionsFile;
use super::{database, exif, lines, opensfm, table};
use crate::format::file::open_regular;
use crate::format::text::{LARGEST_TEXT_BYTES, read_text};

const EXPECTED: &str = "positions: a folder of photographs with EXIF GPS, database.db of COLMAP, reconstruction.json of OpenSfM, geo.txt of \
                        ODM, a table with a header, or lines of name, X, Y, Z";

/// Reads where photographs were taken, from whatever holds it.
pub fn read_positions(path: &Path) -> Result<PositionsFile, PositionsError> {
    let io = |source| PositionsError::Io { what: "positions", path: path.into(), source };
    if path.is_dir() {
        return exif::read(path);
    }
    let mut start = Vec::new();
    open_regular(path).and_then(|file| file.take(16).read_to_end(&mut start)).map_err(io)?;
    if start.starts_with(database::MAGIC) {
        return database::read(path);
    }
    parse_text(&read_text(path, LARGEST_TEXT_BYTES).map_err(io)?, path)
}

pub(super) fn parse_text(text: &str, path: &Path) -> Result<PositionsFile, PositionsError> {
    let content = |found: &str| PositionsError::Content { path: path.into(), found: found.into(), expected: EXPECTED };
    let file = match text.trim_start().chars().next() {
        None => return Err(content("the file is empty")),
        Some('[') => opensfm::parse(text, path)?,
        Some('{' | '<') => return Err(content("this is another kind of file")),
        Some(_) => match table::header_of(text) {
            Some(header) => table::parse(text, &header, path)?,
            None => lines::parse(text, path)?,
        },
    };
    if file.positions.is_empty() { Err(content("it holds no position")) } else { Ok(file) }
}
