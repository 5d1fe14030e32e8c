//! Faces of a PLY file (`ply/` reads clouds, and the header of both).

use crate::format::ply::{ByteOrder, Element, Encoding, FieldKind, Header, PropertyKind};
use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;

/// Corners of one face; more is a file made to take time.
const MOST_CORNERS: f64 = 1e7;

const CUT_OFF: &str = "the PLY is cut off: the header says more rows; get it again";

/// Whether a PLY file has faces.
pub fn is_ply_mesh(bytes: &[u8]) -> bool {
    // Any other text would be taken for a header, as far as its first line goes: all of a JSON file.
    if !bytes.trim_ascii_start().starts_with(b"ply") {
        return false;
    }
    let header = Header::read(bytes);
    header.is_ok_and(|header| header.elements.iter().any(|element| element.name == "face" && element.count > 0))
}

/// Reads the faces as one object of this name.
pub fn read_ply_mesh(bytes: &[u8], name: &str) -> Result<SurfaceFile, SurfaceError> {
    let header = header_of(bytes)?;
    let mut builder = SurfaceBuilder::default();
    builder.file.format = "PLY mesh".to_owned();
    let object = builder.add_object(name.to_owned(), "Mesh", None);
    let mut cells = Cells { bytes, at: header.bytes, encoding: header.encoding };
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
        match (property.kind, element.name.as_str()) {
            (PropertyKind::Scalar(kind), "vertex") => {
                let value = cells.take(kind)?;
                if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == property.name) {
                    position[axis] = value;
                }
            }
            (PropertyKind::Scalar(kind), _) => {
                cells.take(kind)?;
            }
            (PropertyKind::List(length, item), name) => {
                let count = cells.take(length)?;
                if !(0.0..=MOST_CORNERS).contains(&count) {
                    return Err(format!("a list says {count} values; write the PLY again"));
                }
                let is_face = name == "face" && ["vertex_indices", "vertex_index"].contains(&property.name.as_str());
                if is_face {
                    faces.push(count as u32);
                }
                for _ in 0..count as u32 {
                    let value = cells.take(item)?;
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

fn header_of(bytes: &[u8]) -> Result<Header, SurfaceError> {
    Header::read(bytes).map_err(|fault| {
        let start = bytes.split_inclusive(|byte| *byte == b'\n').take(fault.line - 1).map(<[u8]>::len).sum::<usize>();
        let place = Place::Line { line: fault.line as u64, byte: start as u64 };
        SurfaceError::at(place, format!("{}; write the PLY again", fault.problem))
    })
}

/// Values one after the other, in text or in bytes.
struct Cells<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl Cells<'_> {
    fn take(&mut self, kind: FieldKind) -> Result<f64, String> {
        match self.encoding {
            Encoding::Ascii => self.take_word(),
            Encoding::Binary(order) => self.take_bytes(kind, order),
        }
    }

    fn take_word(&mut self) -> Result<f64, String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let word = rest[start..].split(u8::is_ascii_whitespace).next().unwrap_or_default();
        self.at += start + word.len();
        if word.is_empty() {
            return Err(CUT_OFF.to_owned());
        }
        let shown = || word[..word.len().min(40)].escape_ascii().to_string();
        fast_float2::parse(word).map_err(|_| format!("`{}` is no number; write the PLY again", shown()))
    }

    fn take_bytes(&mut self, kind: FieldKind, order: ByteOrder) -> Result<f64, String> {
        let value = self.bytes.get(self.at..).and_then(|rest| kind.read(rest, order));
        self.at += kind.size();
        value.ok_or_else(|| CUT_OFF.to_owned())
    }
}
