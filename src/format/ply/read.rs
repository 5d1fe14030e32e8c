//! Reads a PLY file.

use std::path::{Path, PathBuf};

use super::cloud::{Collector, PlyCloud};
use super::field::ByteOrder;
use super::header::{Element, Encoding, Header, shown};
use super::rows::{BinaryRows, ascii_row};
use crate::format::file::{LARGEST_MODEL_BYTES, read_regular};

/// Why a PLY file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum PlyError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path}, header line {line}: {problem}; write the cloud again as PLY")]
    Header { path: PathBuf, line: usize, problem: String },
    #[error("{path}, line {line}: expected {expected}, got {got}; write the cloud again as PLY")]
    Row { path: PathBuf, line: usize, expected: String, got: String },
    #[error("{path}, byte {byte}, element {element}: expected {expected}, got {got}; write the cloud again as PLY")]
    Binary { path: PathBuf, byte: usize, element: String, expected: String, got: String },
}

/// Whether a file starts as every PLY file does.
pub fn is_ply(start: &[u8]) -> bool {
    start.starts_with(b"ply\n") || start.starts_with(b"ply\r")
}

pub fn read_ply(path: &Path) -> Result<PlyCloud, PlyError> {
    let bytes =
        read_regular(path, LARGEST_MODEL_BYTES).map_err(|source| PlyError::Unreadable { path: path.into(), source })?;
    parse(path, &bytes)
}

/// The cloud in a file's bytes; the path is for messages.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<PlyCloud, PlyError> {
    let header = Header::read(bytes).map_err(|fault| PlyError::Header {
        path: path.into(),
        line: fault.line,
        problem: fault.problem,
    })?;
    let file = PlyFile { path, bytes };
    match header.encoding {
        Encoding::Ascii => file.ascii(&header),
        Encoding::Binary(order) => file.binary(&header, order),
    }
}

struct PlyFile<'a> {
    path: &'a Path,
    bytes: &'a [u8],
}

impl PlyFile<'_> {
    fn binary(&self, header: &Header, order: ByteOrder) -> Result<PlyCloud, PlyError> {
        let mut rows = BinaryRows { left: &self.bytes[header.bytes..], order };
        let mut cloud = PlyCloud::default();
        let mut values = Vec::new();
        for element in &header.elements {
            let at = self.bytes.len() - rows.left.len();
            self.check_count(element, at, rows.left.len())?;
            let is_vertex = element.name == "vertex";
            let mut collector = Collector::new(element);
            for _ in 0..element.count {
                rows.next(element, &mut values).ok_or_else(|| {
                    let expected = format!("{} rows", element.count);
                    self.binary_fault(at, &element.name, expected, "the end of the file before".into())
                })?;
                if is_vertex {
                    collector.push(&values);
                }
            }
            if is_vertex {
                cloud = collector.finish();
            }
        }
        match rows.left.trim_ascii() {
            [] => Ok(cloud),
            rest => {
                let at = self.bytes.len() - rows.left.len();
                let got = format!("{} bytes more", rest.len());
                Err(self.binary_fault(at, "after the last", "the end of the file".into(), got))
            }
        }
    }

    fn binary_fault(&self, byte: usize, element: &str, expected: String, got: String) -> PlyError {
        PlyError::Binary { path: self.path.into(), byte, element: shown(element.as_bytes()), expected, got }
    }

    /// Refuses a count of rows that the file has no bytes for.
    fn check_count(&self, element: &Element, at: usize, left: usize) -> Result<(), PlyError> {
        let row_bytes: usize = element.properties.iter().map(|p| p.kind.least_bytes()).sum();
        if element.count.checked_mul(row_bytes).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        let expected = format!("{} rows of at least {row_bytes} bytes", element.count);
        Err(self.binary_fault(at, &element.name, expected, format!("{left} bytes to the end of the file")))
    }

    /// Rows of other elements are not used: faces that are not as the header says are passed over, line by line.
    fn ascii(&self, header: &Header) -> Result<PlyCloud, PlyError> {
        let mut rows = self.bytes[header.bytes..]
            .split(|b| *b == b'\n')
            .enumerate()
            .map(|(index, row)| (header.lines + 1 + index, row.trim_ascii()))
            .filter(|(_, row)| !row.is_empty());
        let mut cloud = PlyCloud::default();
        let mut odd_lines = Vec::new();
        let mut values = Vec::new();
        let mut last_line = header.lines;
        for element in &header.elements {
            let is_vertex = element.name == "vertex";
            let mut collector = Collector::new(element);
            for number in 0..element.count {
                let Some((line, row)) = rows.next() else {
                    let expected = format!("{} rows of {}", element.count, shown(element.name.as_bytes()));
                    return Err(self.row_fault(last_line, expected, format!("the end of the file after {number}")));
                };
                last_line = line;
                match ascii_row(element, row, &mut values) {
                    Ok(()) if is_vertex => collector.push(&values),
                    Ok(()) => {}
                    Err(fault) if is_vertex => return Err(self.row_fault(line, fault.expected, fault.got)),
                    Err(_) => odd_lines.push(line),
                }
            }
            if is_vertex {
                cloud = collector.finish();
            }
        }
        if let Some((line, row)) = rows.next() {
            let expected = "the end of the file after the last row that the header counts".into();
            return Err(self.row_fault(line, expected, format!("`{}`", shown(row))));
        }
        (cloud.odd_rows, cloud.first_odd_line) = (odd_lines.len(), odd_lines.first().copied());
        Ok(cloud)
    }

    fn row_fault(&self, line: usize, expected: String, got: String) -> PlyError {
        PlyError::Row { path: self.path.into(), line, expected, got }
    }
}
