//! Faces of a PLY file (clouds are read by `ply.rs`).

use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;

/// A header longer than this is none.
const LONGEST_HEADER_BYTES: usize = 1 << 20;

/// Corners of one face; more is a file made to take time.
const MOST_CORNERS: f64 = 1e7;

/// Whether a PLY file has faces.
pub fn is_ply_mesh(bytes: &[u8]) -> bool {
    let header = Header::of(bytes);
    header.is_ok_and(|header| header.elements.iter().any(|element| element.name == "face" && element.count > 0))
}

/// Reads the faces as one object of this name.
pub fn read_ply_mesh(bytes: &[u8], name: &str) -> Result<SurfaceFile, SurfaceError> {
    let header = Header::of(bytes)?;
    let mut builder = SurfaceBuilder::default();
    builder.file.format = "PLY mesh".to_owned();
    let object = builder.add_object(name.to_owned(), "Mesh", None);
    let mut cells = Cells { bytes, at: header.end, encoding: header.encoding };
    let mut faces = Vec::new();
    for element in &header.elements {
        for row in 0..element.count {
            read_row(element, &mut cells, &mut builder, &mut faces).map_err(|problem| {
                SurfaceError::at(Place::Byte(cells.at as u64), format!("{problem} ({} {row})", element.name))
            })?;
        }
    }
    if !bytes.get(cells.at..).unwrap_or_default().trim_ascii().is_empty() {
        let problem = "there are bytes behind the last row that the header counts; write the PLY again";
        return Err(SurfaceError::at(Place::Byte(cells.at as u64), problem));
    }
    add_faces(&faces, object, &mut builder)?;
    Ok(builder.file)
}

/// Faces may stand before their vertices: each is its number of corners, then those.
fn add_faces(faces: &[u32], object: u32, builder: &mut SurfaceBuilder) -> Result<(), SurfaceError> {
    let vertices = builder.file.positions.len();
    let (mut rest, mut number) = (faces, 0_u64);
    while let [count, tail @ ..] = rest {
        let (corners, after) = tail.split_at((*count as usize).min(tail.len()));
        number += 1;
        if let Some(corner) = corners.iter().find(|&&corner| corner as usize >= vertices) {
            let problem = format!(
                "face {number} has the corner {corner}, but there are {vertices} vertices; write the PLY again"
            );
            return Err(SurfaceError::at(Place::Record(number), problem));
        }
        if corners.len() < 3 {
            builder.skip("faces with less than three corners", 1, || format!("face {number}"));
        } else {
            builder.add_polygon(corners.iter().copied(), SurfaceTraits { object, ..SurfaceTraits::default() })?;
        }
        rest = after;
    }
    Ok(())
}

fn read_row(
    element: &Element,
    cells: &mut Cells<'_>,
    builder: &mut SurfaceBuilder,
    faces: &mut Vec<u32>,
) -> Result<(), String> {
    let mut position = [0.0; 3];
    for property in &element.properties {
        match (&property.list_of, element.name.as_str()) {
            (None, "vertex") => {
                let value = cells.take(property.scalar)?;
                if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == property.name) {
                    position[axis] = value;
                }
            }
            (None, _) => {
                cells.take(property.scalar)?;
            }
            (Some(item), name) => {
                let count = cells.take(property.scalar)?;
                if !(0.0..=MOST_CORNERS).contains(&count) {
                    return Err(format!("a list says {count} values; write the PLY again"));
                }
                let is_face = name == "face" && ["vertex_indices", "vertex_index"].contains(&property.name.as_str());
                if is_face {
                    faces.push(count as u32);
                }
                for _ in 0..count as u32 {
                    let value = cells.take(*item)?;
                    if is_face {
                        faces.push(index(value)?);
                    }
                }
            }
        }
    }
    match element.name.as_str() {
        "vertex" if !position.iter().all(|value| value.is_finite()) => {
            return Err("a position is not finite; write the PLY again without it".to_owned());
        }
        "vertex" => builder.file.positions.push(position),
        "tristrips" => builder.skip("triangle strips", 1, || "tristrips".to_owned()),
        _ => {}
    }
    Ok(())
}

fn index(value: f64) -> Result<u32, String> {
    if value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    Err(format!("`{value}` is no number of a vertex; write the PLY again"))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Property {
    name: String,
    /// Of the value, or of a list's length.
    scalar: Scalar,
    list_of: Option<Scalar>,
}

#[derive(Debug)]
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where the rows begin.
    end: usize,
}

impl Header {
    fn of(bytes: &[u8]) -> Result<Header, SurfaceError> {
        let mut header = Header { encoding: Encoding::Text, elements: Vec::new(), end: 0 };
        for (number, line) in
            bytes[..bytes.len().min(LONGEST_HEADER_BYTES)].split_inclusive(|&byte| byte == b'\n').enumerate()
        {
            let place = Place::Line { line: number as u64 + 1, byte: header.end as u64 };
            header.end += line.len();
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_whitespace().collect();
            if words[..] == ["end_header"] && number > 0 {
                return header.checked();
            }
            let known = if number == 0 { (words[..] == ["ply"]).then_some(()) } else { header.line(&words) };
            let shown: String = line.trim().chars().take(40).collect();
            known.ok_or_else(|| {
                SurfaceError::at(place, format!("`{shown}` is no line of a PLY header; write the PLY again"))
            })?;
        }
        Err(SurfaceError::whole("the PLY header has no end_header; get the file again"))
    }

    fn line(&mut self, words: &[&str]) -> Option<()> {
        match words {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", "ascii", _] => self.encoding = Encoding::Text,
            ["format", "binary_little_endian", _] => self.encoding = Encoding::Little,
            ["format", "binary_big_endian", _] => self.encoding = Encoding::Big,
            ["element", name, count] => {
                let (name, count) = ((*name).to_owned(), count.parse().ok()?);
                self.elements.push(Element { name, count, properties: Vec::new() });
            }
            ["property", "list", length, item, name] => {
                let (name, scalar, list_of) = ((*name).to_owned(), scalar(length)?, Some(scalar(item)?));
                self.elements.last_mut()?.properties.push(Property { name, scalar, list_of });
            }
            ["property", kind, name] => {
                let (name, scalar) = ((*name).to_owned(), scalar(kind)?);
                self.elements.last_mut()?.properties.push(Property { name, scalar, list_of: None });
            }
            _ => return None,
        }
        Some(())
    }

    fn checked(self) -> Result<Header, SurfaceError> {
        let is_given = |axis: &&str| {
            let mut vertices = self.elements.iter().filter(|element| element.name == "vertex");
            vertices.any(|vertex| {
                vertex.properties.iter().any(|property| property.name == **axis && property.list_of.is_none())
            })
        };
        if !["x", "y", "z"].iter().all(is_given) {
            return Err(SurfaceError::whole("the PLY has no vertices with x, y and z; write it again"));
        }
        // No number of bytes would bound them.
        if let Some(element) = self.elements.iter().find(|element| element.properties.is_empty() && element.count > 0) {
            return Err(SurfaceError::whole(format!(
                "the element `{}` has no properties; write the PLY again",
                element.name
            )));
        }
        Ok(self)
    }
}

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}

/// Values one after the other, in text or in bytes.
struct Cells<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl Cells<'_> {
    fn take(&mut self, scalar: Scalar) -> Result<f64, String> {
        match self.encoding {
            Encoding::Text => self.take_word(),
            _ => self.take_bytes(scalar),
        }
    }

    fn take_word(&mut self) -> Result<f64, String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let word = rest[start..].split(u8::is_ascii_whitespace).next().unwrap_or_default();
        self.at += start + word.len();
        if word.is_empty() {
            return Err("the PLY is cut off: the header says more rows; get it again".to_owned());
        }
        let shown = || word[..word.len().min(40)].escape_ascii().to_string();
        fast_float2::parse(word).map_err(|_| format!("`{}` is no number; write the PLY again", shown()))
    }

    fn take_bytes(&mut self, scalar: Scalar) -> Result<f64, String> {
        let value = match scalar {
            Scalar::I8 => self.array::<1>().map(|bytes| f64::from(i8::from_le_bytes(bytes))),
            Scalar::U8 => self.array::<1>().map(|[byte]| f64::from(byte)),
            Scalar::I16 => self.array().map(|bytes| f64::from(i16::from_le_bytes(bytes))),
            Scalar::U16 => self.array().map(|bytes| f64::from(u16::from_le_bytes(bytes))),
            Scalar::I32 => self.array().map(|bytes| f64::from(i32::from_le_bytes(bytes))),
            Scalar::U32 => self.array().map(|bytes| f64::from(u32::from_le_bytes(bytes))),
            Scalar::F32 => self.array().map(|bytes| f64::from(f32::from_le_bytes(bytes))),
            Scalar::F64 => self.array().map(f64::from_le_bytes),
        };
        value.ok_or_else(|| "the PLY is cut off: the header says more rows; get it again".to_owned())
    }

    /// The next bytes in little-endian order.
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut taken: [u8; N] = self.bytes.get(self.at..)?.first_chunk().copied()?;
        if self.encoding == Encoding::Big {
            taken.reverse();
        }
        self.at += N;
        Some(taken)
    }
}
