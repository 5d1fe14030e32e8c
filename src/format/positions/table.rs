//! Tables with a header: what Metashape and RealityScan (RealityCapture) export, and what a spreadsheet makes of it.
//!
//! Metashape writes `#CoordinateSystem: ...` and the header behind `#`; RealityScan `#name,x,y,alt`. Commas, semicolons or tabs separate.

use std::path::Path;

use super::columns::Columns;
use super::error::PositionsError;
use super::frame::{Frame, GEOGRAPHIC, epsg_in};
use super::lines::finite;
use super::record::{PositionsFile, StoredPosition, look_like_degrees, sigma};

const EXPECTED: &str = "as many columns as the header has, with numbers for coordinates";

/// Lines before the header: remarks.
const MOST_REMARKS: usize = 50;

/// A header, where it stands, and what separates.
pub(super) struct Header {
    /// Index of the line.
    line: usize,
    separator: char,
    columns: Columns,
}

/// The header among the first lines; `None` where the text is no such table.
pub(super) fn header_of(text: &str) -> Option<Header> {
    for (line, text) in text.lines().enumerate().take(MOST_REMARKS) {
        for separator in [',', ';', '\t'] {
            if let Some(columns) = Columns::of(&cells(text, separator)) {
                return Some(Header { line, separator, columns });
            }
        }
    }
    None
}

/// Reads the rows below the header.
pub(super) fn parse(text: &str, header: &Header, path: &Path) -> Result<PositionsFile, PositionsError> {
    let columns = &header.columns;
    let mut positions = Vec::new();
    let mut disabled = 0;
    for (index, row) in text.lines().enumerate().skip(header.line + 1) {
        if row.trim().is_empty() || row.trim_start().starts_with('#') {
            continue;
        }
        let fault = |found| PositionsError::Line { path: path.into(), line: index + 1, found, expected: EXPECTED };
        let cells = cells(row, header.separator);
        if columns.enabled.and_then(|k| cells.get(k)).is_some_and(|cell| ["0", "false"].contains(&cell.as_str())) {
            disabled += 1;
            continue;
        }
        positions.extend(position(&cells, header).map_err(fault)?);
    }
    let warnings = if disabled > 0 {
        vec![format!("{disabled} positions are not enabled in their table, left out")]
    } else {
        vec![]
    };
    let named = text.lines().take(header.line + 1).find_map(epsg_in).map(Frame::Epsg);
    let guessed = if columns.are_degrees || look_like_degrees(&positions) { GEOGRAPHIC } else { Frame::OfTheCity };
    Ok(PositionsFile { format: "table with a header", frame: named.unwrap_or(guessed), positions, warnings })
}

/// `None` for a photograph whose coordinates are left blank.
fn position(cells: &[String], header: &Header) -> Result<Option<StoredPosition>, String> {
    let columns = &header.columns;
    let cell = |k: usize| cells.get(k).map(|cell| as_number(cell, header.separator)).filter(|cell| !cell.is_empty());
    let number = |k: usize| cell(k).map(|cell| finite(&cell)).transpose();
    let name = cells.get(columns.name).filter(|name| !name.is_empty()).ok_or("a row without a name")?;
    if cells.len() <= columns.east.max(columns.north) {
        return Err(format!("{} columns", cells.len()));
    }
    let [Some(east), Some(north)] = [number(columns.east)?, number(columns.north)?] else { return Ok(None) };
    let height_m = columns.height.map(number).transpose()?.flatten();
    let spread = |k: Option<usize>| sigma(k.and_then(cell).and_then(|cell| cell.parse().ok()));
    Ok(Some(StoredPosition {
        sigma_m: spread(columns.sigma),
        height_sigma_m: spread(columns.height_sigma),
        ..StoredPosition::at(name, [east, north], height_m)
    }))
}

/// Where semicolons or tabs separate, a comma may stand for the decimal point.
fn as_number(cell: &str, separator: char) -> String {
    if separator == ',' { cell.to_owned() } else { cell.replace(',', ".") }
}

/// Cells of a row, trimmed; a separator within quotes does not separate.
fn cells(row: &str, separator: char) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in row.trim().trim_start_matches('#').chars() {
        match c {
            '"' => quoted = !quoted,
            c if c == separator && !quoted => cells.push(String::new()),
            c => cells.last_mut().into_iter().for_each(|cell| cell.push(c)),
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}
