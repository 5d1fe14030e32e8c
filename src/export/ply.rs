//! The points of a reconstruction as a PLY cloud.

use std::io::{BufWriter, Result, Write};
use std::path::Path;

use super::ExportError;
use super::colmap::first_point_not_finite;
use super::file::write_file;
use crate::reconstruction::Reconstruction;

/// In the header, so that the file can be told from somebody else's.
pub(super) const REMARK: &str = "comment written by cityweld ";

/// Writes the points, in the frame in which they stand: binary little-endian, `double` coordinates, normals (`double`)
/// and colours (`uchar`) where there are any, and the further properties that came with them as they came.
pub fn write_ply(path: &Path, r: &Reconstruction) -> std::result::Result<(), ExportError> {
    if let Some(got) = first_point_not_finite(r) {
        let expected = "finite coordinates; the scale of the move is too large for this reconstruction";
        return Err(ExportError::Unfit { path: path.into(), expected, got });
    }
    let count = r.points.len();
    let (has_normals, has_colors) = (r.normals.len() == count, r.colors.len() == count);
    write_file(path, |out| {
        let remark = concat!(env!("CARGO_PKG_VERSION"), "\n");
        write!(out, "ply\nformat binary_little_endian 1.0\n{REMARK}{remark}element vertex {count}\n")?;
        declare(out, "double", &["x", "y", "z"])?;
        if has_normals {
            declare(out, "double", &["nx", "ny", "nz"])?;
        }
        if has_colors {
            declare(out, "uchar", &["red", "green", "blue"])?;
        }
        let fields: Vec<_> = r.fields.iter().filter(|field| field.len() == count).collect();
        fields.iter().try_for_each(|field| declare(out, field.kind.name(), &[&field.name]))?;
        out.write_all(b"end_header\n")?;
        for (i, point) in r.points.iter().enumerate() {
            point.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))?;
            if has_normals {
                r.normals[i].iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))?;
            }
            if has_colors {
                out.write_all(&r.colors[i])?;
            }
            fields.iter().try_for_each(|field| out.write_all(field.value_bytes(i)))?;
        }
        Ok(())
    })
}

fn declare(out: &mut BufWriter<std::fs::File>, kind: &str, names: &[&str]) -> Result<()> {
    names.iter().try_for_each(|name| writeln!(out, "property {kind} {name}"))
}

#[cfg(test)]
mod tests;
