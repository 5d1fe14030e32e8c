//! The header of a PLY file: its elements and their properties, by the names that the file gives them.
//!
//! Cloud tools write names like `scalar_d_(m)` and comments in any encoding; both are taken as they are.

use super::field::{ByteOrder, FieldKind};

/// Characters of a file that a message repeats at most.
const SHOWN_BYTES: usize = 40;

/// A header longer than this is none; it keeps a large file of another kind from being searched to its end.
const MAX_HEADER_BYTES: usize = 1 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::format) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

#[derive(Debug)]
pub(in crate::format) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Lines up to the end of the header.
    pub lines: usize,
    /// Bytes up to the end of the header.
    pub bytes: usize,
}

#[derive(Debug)]
pub(in crate::format) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

#[derive(Debug)]
pub(in crate::format) struct Property {
    pub name: String,
    pub kind: PropertyKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::format) enum PropertyKind {
    Scalar(FieldKind),
    /// Type of the count, type of the values.
    List(FieldKind, FieldKind),
}

/// What is wrong in a header, and in which line (from 1).
#[derive(Debug)]
pub(in crate::format) struct HeaderFault {
    pub line: usize,
    pub problem: String,
}

pub(super) fn shown(text: &[u8]) -> String {
    String::from_utf8_lossy(&text[..text.len().min(SHOWN_BYTES)]).escape_debug().to_string()
}

impl Header {
    pub fn read(bytes: &[u8]) -> Result<Header, HeaderFault> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut at = 0;
        for (line, raw) in (1..).zip(bytes.split_inclusive(|b| *b == b'\n')) {
            at += raw.len();
            let text = String::from_utf8_lossy(raw.trim_ascii());
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            match words.as_slice() {
                [] | ["comment" | "obj_info", ..] => {}
                ["ply"] if line == 1 => {}
                ["end_header"] => {
                    let encoding = encoding.ok_or_else(|| fault(line, "expected a line `format` before the end"))?;
                    return check(Header { encoding, elements, lines: line, bytes: at });
                }
                ["format", name, "1.0"] => encoding = Some(named_encoding(name).ok_or_else(|| odd_line(line, raw))?),
                ["element", name, count] => {
                    if elements.iter().any(|e| e.name == *name) {
                        return Err(fault(line, format!("the element `{}` is there twice", shown(name.as_bytes()))));
                    }
                    let count = count.parse().map_err(|_| odd_line(line, raw))?;
                    elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
                }
                ["property", rest @ ..] => {
                    let element = elements.last_mut().ok_or_else(|| odd_line(line, raw))?;
                    let property = property(rest).ok_or_else(|| odd_line(line, raw))?;
                    if element.properties.iter().any(|p| p.name == property.name) {
                        let name = shown(property.name.as_bytes());
                        return Err(fault(line, format!("the property `{name}` is there twice")));
                    }
                    element.properties.push(property);
                }
                _ => return Err(odd_line(line, raw)),
            }
            if at > MAX_HEADER_BYTES {
                break;
            }
        }
        Err(fault(1, "expected a line `end_header` that ends the header, found none"))
    }
}

impl PropertyKind {
    /// Bytes that a value takes at least.
    pub fn least_bytes(self) -> usize {
        match self {
            PropertyKind::Scalar(kind) | PropertyKind::List(kind, _) => kind.size(),
        }
    }
}

fn fault(line: usize, problem: impl Into<String>) -> HeaderFault {
    HeaderFault { line, problem: problem.into() }
}

fn odd_line(line: usize, raw: &[u8]) -> HeaderFault {
    let expected = "expected `format ascii|binary_little_endian|binary_big_endian 1.0`, `element NAME COUNT`, \
                    `property TYPE NAME` or `property list TYPE TYPE NAME`";
    fault(line, format!("{expected}, got `{}`", shown(raw.trim_ascii())))
}

fn named_encoding(name: &str) -> Option<Encoding> {
    match name {
        "ascii" => Some(Encoding::Ascii),
        "binary_little_endian" => Some(Encoding::Binary(ByteOrder::Little)),
        "binary_big_endian" => Some(Encoding::Binary(ByteOrder::Big)),
        _ => None,
    }
}

fn property(words: &[&str]) -> Option<Property> {
    let (kind, name) = match words {
        ["list", length, kind, name] => (PropertyKind::List(FieldKind::named(length)?, FieldKind::named(kind)?), name),
        [kind, name] => (PropertyKind::Scalar(FieldKind::named(kind)?), name),
        _ => return None,
    };
    Some(Property { name: name.to_string(), kind })
}

/// Elements that no number of bytes bounds are refused, and vertices without a place.
fn check(header: Header) -> Result<Header, HeaderFault> {
    if let Some(element) = header.elements.iter().find(|e| e.properties.is_empty() && e.count > 0) {
        let name = shown(element.name.as_bytes());
        return Err(fault(header.lines, format!("the element `{name}` has no properties")));
    }
    let vertex = header.elements.iter().find(|e| e.name == "vertex");
    let vertex = vertex.ok_or_else(|| fault(header.lines, "expected an element `vertex`, found none"))?;
    for name in ["x", "y", "z"] {
        match vertex.properties.iter().find(|p| p.name == name).map(|p| p.kind) {
            Some(PropertyKind::Scalar(_)) => {}
            Some(PropertyKind::List(..)) => {
                return Err(fault(header.lines, format!("the property `{name}` of vertex is a list")));
            }
            None => return Err(fault(header.lines, format!("expected a property `{name}` of vertex"))),
        }
    }
    Ok(header)
}
