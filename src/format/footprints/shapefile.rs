//! A Shapefile with its table and its reference system.

use std::path::{Path, PathBuf};

use super::dbf::Table;
use super::fields::FootprintFields;
use super::prism::{Footprint, Prisms};
use super::shp::shapes_of;
use crate::format::file::{LARGEST_MODEL_BYTES, read_regular};
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;

/// What the file is, in [`SurfaceFile::format`].
pub(super) const FORMAT: &str = "Shapefile";

/// The longest .prj that is read, bytes; they have some five hundred.
const LARGEST_PRJ_BYTES: u64 = 1 << 16;

/// Whether a file begins like a .shp: number 9994 the one way round, version 1000 the other.
pub fn is_shapefile(start: &[u8]) -> bool {
    start.starts_with(&9994_u32.to_be_bytes()) && start.get(28..32) == Some(&1000_u32.to_le_bytes()[..])
}

/// Reads a .shp with the .dbf, and the .prj if there is one, that stand beside it under the same name.
pub fn read_shapefile(path: &Path, fields: &FootprintFields) -> Result<SurfaceFile, SurfaceError> {
    let read = |path: &Path, what: &str| {
        read_regular(path, LARGEST_MODEL_BYTES)
            .map_err(|error| SurfaceError::whole(format!("cannot read {what}: {error}")).in_file(path))
    };
    let bytes = read(path, "the Shapefile")?;
    let table_path = beside(path, "dbf");
    let table_bytes = read(&table_path, "the table with the heights, which stands beside a Shapefile")?;
    let table = Table::of(&table_bytes).map_err(|error| error.in_file(&table_path))?;
    let columns = fields.among(&table.numeric()).map_err(|error| error.in_file(&table_path))?;
    let shapes = shapes_of(&bytes)?;
    if shapes.len() != table.count() {
        let problem =
            format!("{} shapes, but {} rows in the table (.dbf); get both again", shapes.len(), table.count());
        return Err(SurfaceError::at(Place::Whole, problem));
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut prisms = Prisms::default();
    for (record, shape) in shapes.into_iter().enumerate() {
        let id = format!("{name} {}", record + 1);
        if table.is_deleted(record) {
            prisms.builder.skip("deleted rows", 1, || id);
            continue;
        }
        prisms.builder.skip("heights of footprints' corners", usize::from(shape.has_heights), || id.clone());
        prisms.builder.skip("rings without an area", shape.flat_rings, || id.clone());
        prisms.add(Footprint {
            id,
            record: record as u64 + 1,
            outlines: shape.outlines,
            height: table.number(record, columns.height),
            base: columns.base.map_or(Some(0.0), |base| table.number(record, base)),
        })?;
    }
    let mut file = prisms.builder.file;
    file.format = FORMAT.to_owned();
    file.crs = reference_system(path)?;
    Ok(file)
}

fn reference_system(path: &Path) -> Result<Option<String>, SurfaceError> {
    let path = beside(path, "prj");
    if !path.exists() {
        return Ok(None);
    }
    let bytes = read_regular(&path, LARGEST_PRJ_BYTES)
        .map_err(|error| SurfaceError::whole(format!("cannot read the reference system: {error}")).in_file(&path))?;
    let text = String::from_utf8_lossy(&bytes).trim_start_matches('\u{feff}').trim().to_owned();
    Ok((!text.is_empty()).then_some(text))
}

/// The file of the same name with another ending, in small letters or capitals.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let small = path.with_extension(ending);
    let capital = path.with_extension(ending.to_uppercase());
    if !small.exists() && capital.exists() { capital } else { small }
}
