//! Point clouds in PLY files: ASCII and both binary orders, float and double.
//!
//! `ply-rs-bw` reads headers and binary rows. ASCII rows are read here, as it refuses `nan` and blank lines.

use std::collections::HashSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType};

use super::file::{LARGEST_MODEL_BYTES, read_regular};
use super::ply_row::{Column, Role, Skipped, Vertex, bytes_of, color_of_one};

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

/// What a file says of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyCloud {
    pub positions: Vec<[f64; 3]>,
    /// One per point or empty.
    pub colors: Vec<[u8; 3]>,
    /// One per point or empty; of any length, as in the file.
    pub normals: Vec<[f64; 3]>,
    /// Vertices without a finite position, left out; tools write them for pixels without depth.
    pub dropped: usize,
    /// Number of the first vertex left out, from 0.
    pub first_dropped: Option<usize>,
}

/// Whether a file starts as every PLY file does.
pub fn is_ply(start: &[u8]) -> bool {
    start.starts_with(b"ply\n") || start.starts_with(b"ply\r")
}

pub fn read_ply(path: &Path) -> Result<PlyCloud, PlyError> {
    let bytes =
        read_regular(path, LARGEST_MODEL_BYTES).map_err(|source| PlyError::Unreadable { path: path.into(), source })?;
    PlyFile { path, bytes: &bytes }.read()
}

struct PlyFile<'a> {
    path: &'a Path,
    bytes: &'a [u8],
}

impl PlyFile<'_> {
    fn read(&self) -> Result<PlyCloud, PlyError> {
        let (header_text, header_lines, payload_at) = self.cleaned_header()?;
        let mut reader = Reader::new(header_text.as_bytes());
        let header = Parser::<Skipped>::new()
            .read_header(&mut reader)
            .map_err(|error| self.header_line_fault(error.line(), header_lines))?;
        let vertex = self.vertex_element(&header, header_lines)?;
        match header.encoding {
            Encoding::Ascii => self.ascii(&header, header_lines, payload_at),
            _ => self.binary(&header, vertex, payload_at),
        }
    }

    fn header_fault(&self, line: usize, problem: impl Into<String>) -> PlyError {
        PlyError::Header { path: self.path.into(), line, problem: problem.into() }
    }

    /// The parser tells the line; its own words are about its grammar.
    fn header_line_fault(&self, line: Option<usize>, header_lines: usize) -> PlyError {
        let number = line.unwrap_or(header_lines);
        let line = self.bytes.split(|b| *b == b'\n').nth(number - 1).unwrap_or_default().trim_ascii();
        let expected = "expected `format ascii|binary_little_endian|binary_big_endian 1.0`, `element NAME COUNT`, \
                        `property TYPE NAME` or `property list TYPE TYPE NAME`";
        self.header_fault(number, format!("{expected}, got `{}`", shown(line)))
    }

    /// The header with comments emptied and names made of letters and digits (cloud tools write `scalar_d_(m)`), so
    /// that the parser takes it; the number of its lines, and where the rows begin.
    fn cleaned_header(&self) -> Result<(String, usize, usize), PlyError> {
        let mut cleaned = String::new();
        let mut names: HashSet<String> = HashSet::new();
        let mut elements: HashSet<String> = HashSet::new();
        let mut at = 0;
        for (index, line) in self.bytes.split_inclusive(|b| *b == b'\n').enumerate() {
            at += line.len();
            let number = index + 1;
            let line = String::from_utf8_lossy(line.trim_ascii());
            let mut words: Vec<&str> = line.split_ascii_whitespace().collect();
            let name = match words.first().copied() {
                Some("comment" | "obj_info") | None => {
                    cleaned.push_str("comment\n");
                    continue;
                }
                Some("element") => words.get(1).copied(),
                Some("property") => words.pop(),
                _ => None,
            };
            match (words.first().copied(), name) {
                (Some("element"), Some(name)) => {
                    if !elements.insert(name.to_string()) {
                        return Err(self
                            .header_fault(number, format!("the element `{}` is there twice", shown(name.as_bytes()))));
                    }
                    names.clear();
                    let count = words.get(2).copied().unwrap_or("");
                    cleaned.push_str(&format!("element {} {count}\n", plain(name)));
                }
                (Some("property"), Some(name)) => {
                    if !names.insert(name.to_string()) {
                        return Err(self.header_fault(
                            number,
                            format!("the property `{}` is there twice", shown(name.as_bytes())),
                        ));
                    }
                    let mut name_in_header = plain(name);
                    if name_in_header != name {
                        name_in_header.push_str(&format!("_{}", names.len()));
                    }
                    cleaned.push_str(&format!("{} {name_in_header}\n", words.join(" ")));
                }
                _ => cleaned.push_str(&format!("{line}\n")),
            }
            if line == "end_header" {
                return Ok((cleaned, number, at));
            }
            if at > MAX_HEADER_BYTES {
                break;
            }
        }
        Err(self.header_fault(1, "expected a line `end_header` that ends the header, found none"))
    }

    /// The vertex element; elements that no number of bytes bounds are refused.
    fn vertex_element<'h>(&self, header: &'h Header, line: usize) -> Result<&'h ElementDef, PlyError> {
        if let Some((name, _)) = header.elements.iter().find(|(_, e)| e.properties.is_empty() && e.count > 0) {
            return Err(self.header_fault(line, format!("the element `{name}` has no properties")));
        }
        let vertex = header.elements.get("vertex");
        let vertex = vertex.ok_or_else(|| self.header_fault(line, "expected an element `vertex`, found none"))?;
        for name in ["x", "y", "z"] {
            match vertex.properties.get(name).map(|p| &p.data_type) {
                Some(PropertyType::Scalar(_)) => {}
                Some(PropertyType::List(..)) => {
                    return Err(self.header_fault(line, format!("the property `{name}` of vertex is a list")));
                }
                None => return Err(self.header_fault(line, format!("expected a property `{name}` of vertex"))),
            }
        }
        Ok(vertex)
    }

    fn binary(&self, header: &Header, vertex: &ElementDef, payload_at: usize) -> Result<PlyCloud, PlyError> {
        let mut reader = Reader::new(&self.bytes[payload_at..]);
        let mut cloud = Collector::new(vertex);
        for element in header.elements.values() {
            let left = reader.get_ref().len();
            let at = self.bytes.len() - left;
            self.check_count(element, at, left)?;
            let damaged = |error: ParseError| PlyError::Binary {
                path: self.path.into(),
                byte: at,
                element: element.name.clone(),
                expected: format!("{} rows", element.count),
                got: match error.kind() {
                    ErrorKind::UnexpectedEof => "the end of the file before".into(),
                    _ => error.to_string().replace("\n\t", ", ").replace('\n', " "),
                },
            };
            if element.name != "vertex" {
                Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, header).map_err(damaged)?;
                continue;
            }
            // In pieces, so that rows are not all held twice.
            let parser = Parser::<Vertex>::new();
            let mut piece = ElementDef { count: 0, ..element.clone() };
            let mut done = 0;
            while done < element.count {
                piece.count = (element.count - done).min(ROWS_AT_ONCE);
                for row in parser.read_payload_for_element(&mut reader, &piece, header).map_err(damaged)? {
                    cloud.push(row);
                }
                done += piece.count;
            }
        }
        match reader.get_ref().trim_ascii() {
            [] => Ok(cloud.finish()),
            rest => Err(PlyError::Binary {
                path: self.path.into(),
                byte: self.bytes.len() - reader.get_ref().len(),
                element: "after the last".into(),
                expected: "the end of the file".into(),
                got: format!("{} bytes more", rest.len()),
            }),
        }
    }

    /// Refuses a count of rows that the file has no bytes for.
    fn check_count(&self, element: &ElementDef, at: usize, left: usize) -> Result<(), PlyError> {
        let row_bytes: usize = element
            .properties
            .values()
            .map(|p| match &p.data_type {
                PropertyType::Scalar(scalar) => bytes_of(scalar),
                PropertyType::List(length, _) => bytes_of(length),
            })
            .sum();
        if element.count.checked_mul(row_bytes).is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        Err(PlyError::Binary {
            path: self.path.into(),
            byte: at,
            element: element.name.clone(),
            expected: format!("{} rows of at least {row_bytes} bytes", element.count),
            got: format!("{left} bytes to the end of the file"),
        })
    }

    fn ascii(&self, header: &Header, header_lines: usize, payload_at: usize) -> Result<PlyCloud, PlyError> {
        let mut rows = self.bytes[payload_at..]
            .split(|b| *b == b'\n')
            .enumerate()
            .map(|(index, row)| (header_lines + 1 + index, row.trim_ascii()))
            .filter(|(_, row)| !row.is_empty());
        let mut cloud = None;
        let mut last_line = header_lines;
        for element in header.elements.values() {
            let mut collector = Collector::new(element);
            let columns: Vec<Column> =
                element.properties.values().map(|p| (Role::of(&p.name), p.name.as_str(), &p.data_type)).collect();
            for number in 0..element.count {
                let Some((line, row)) = rows.next() else {
                    let expected = format!("{} rows of {}", element.count, element.name);
                    let got = format!("the end of the file after {number}");
                    return Err(PlyError::Row { path: self.path.into(), line: last_line, expected, got });
                };
                last_line = line;
                let vertex = self.ascii_row(&element.name, &columns, line, row)?;
                if element.name == "vertex" {
                    collector.push(vertex);
                }
            }
            if element.name == "vertex" {
                cloud = Some(collector.finish());
            }
        }
        match rows.next() {
            // `vertex_element` has made sure that there is one.
            None => Ok(cloud.unwrap_or_default()),
            Some((line, row)) => {
                let got = format!("`{}`", shown(row));
                let expected = "the end of the file after the last row that the header counts".into();
                Err(PlyError::Row { path: self.path.into(), line, expected, got })
            }
        }
    }

    fn ascii_row(&self, element: &str, columns: &[Column], line: usize, row: &[u8]) -> Result<Vertex, PlyError> {
        let fault = |expected: String, got: &[u8]| {
            let got = match got {
                [] => "the end of the line".to_string(),
                token => format!("`{}`", shown(token)),
            };
            PlyError::Row { path: self.path.into(), line, expected, got }
        };
        let mut vertex = Vertex::default();
        let mut rest = row;
        for (role, name, data_type) in columns {
            let mut value = || match number(&mut rest) {
                Some(value) => Ok(value),
                None => Err(fault(format!("a number for `{name}` of {element}"), rest)),
            };
            match data_type {
                PropertyType::Scalar(scalar) => vertex.set(*role, value()?, color_of_one(scalar)),
                PropertyType::List(..) => {
                    let length = value()?;
                    // A length beyond the row's end, or one that is no number, is found by the values it asks for.
                    for _ in 0..length as u64 {
                        value()?;
                    }
                }
            }
        }
        match rest.trim_ascii() {
            [] => Ok(vertex),
            rest => Err(fault(format!("{} values in a row of {element}", columns.len()), rest)),
        }
    }
}

/// Characters of a file that a message repeats at most.
const SHOWN_BYTES: usize = 40;

fn shown(text: &[u8]) -> String {
    String::from_utf8_lossy(&text[..text.len().min(SHOWN_BYTES)]).escape_debug().to_string()
}

/// A header longer than this is none; it keeps a large file of another kind from being searched to its end.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// Binary rows that the parser reads at once.
const ROWS_AT_ONCE: usize = 1 << 16;

/// A name as the parser takes it.
fn plain(name: &str) -> String {
    let letters = name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' });
    let plain: String = letters.collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') { plain } else { format!("_{plain}") }
}

/// Takes the next number off `rest`.
fn number(rest: &mut &[u8]) -> Option<f64> {
    let text = rest.trim_ascii_start();
    *rest = text;
    let (value, length) = fast_float2::parse_partial::<f64, _>(text).ok()?;
    if text.get(length).is_some_and(|b| !b.is_ascii_whitespace()) {
        return None;
    }
    *rest = &text[length..];
    Some(value)
}

/// Gathers vertices with what their element declares.
struct Collector {
    cloud: PlyCloud,
    has_colors: bool,
    has_normals: bool,
    seen: usize,
}

impl Collector {
    fn new(vertex: &ElementDef) -> Collector {
        let has = |role: Role| {
            let is_scalar = |t: &PropertyType| matches!(t, PropertyType::Scalar(_));
            vertex.properties.values().any(|p| Role::of(&p.name) == role && is_scalar(&p.data_type))
        };
        Collector {
            cloud: PlyCloud::default(),
            has_colors: (0..3).all(|i| has(Role::Color(i))),
            has_normals: (0..3).all(|i| has(Role::Normal(i))),
            seen: 0,
        }
    }

    fn push(&mut self, vertex: Vertex) {
        self.seen += 1;
        if !vertex.position.iter().all(|v| v.is_finite()) {
            self.cloud.dropped += 1;
            self.cloud.first_dropped.get_or_insert(self.seen - 1);
            return;
        }
        self.cloud.positions.push(vertex.position);
        if self.has_colors {
            self.cloud.colors.push(vertex.color);
        }
        if self.has_normals {
            self.cloud.normals.push(vertex.normal);
        }
    }

    fn finish(self) -> PlyCloud {
        self.cloud
    }
}
