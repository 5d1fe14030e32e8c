//! GeoPackage: layers of an SQLite database.

use std::path::Path;

use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, OpenFlags};

use super::fields::FootprintFields;
use super::prism::{Footprint, Prisms};
use super::wkb::polygons_of;
use crate::format::file::open_regular;
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;

/// What the file is, in [`SurfaceFile::format`].
pub(super) const FORMAT: &str = "GeoPackage";

/// The longest value that is read, bytes. Chosen: an outline of a million corners.
const LONGEST_VALUE_BYTES: i32 = 64 << 20;

/// Whether a file begins like a GeoPackage: an SQLite database that says so (at byte 68), or, before version 1.2, an application
/// number of its own.
pub fn is_geopackage(start: &[u8]) -> bool {
    let application = start.get(68..72).unwrap_or_default();
    start.starts_with(b"SQLite format 3\0") && [&b"GPKG"[..], b"GP10", b"GP11"].contains(&application)
}

/// Reads all layers of polygons that have the field of heights.
pub fn read_geopackage(path: &Path, fields: &FootprintFields) -> Result<SurfaceFile, SurfaceError> {
    let whole = |error: std::io::Error| SurfaceError::whole(format!("cannot read the GeoPackage: {error}"));
    let length = open_regular(path).and_then(|file| file.metadata()).map_err(whole)?.len();
    refuse_pending(path)?;
    let database = open(path).map_err(broken)?;
    let layers = layers(&database).map_err(broken)?;
    if layers.is_empty() {
        return Err(SurfaceError::whole("the GeoPackage has no layer of features; expected footprints as polygons"));
    }
    let mut rows_left = length;
    let mut prisms = Prisms::default();
    let mut numeric = Vec::new();
    let mut crs: Option<Option<String>> = None;
    for layer in &layers {
        let columns = numeric_columns(&database, layer).map_err(broken)?;
        if layers.len() > 1 && fields.among(&columns).is_err() {
            prisms.builder.skip("layers without the field of heights", 1, || layer.table.clone());
            numeric.extend(columns);
            continue;
        }
        let system = reference_system(&database, layer).map_err(broken)?;
        if *crs.get_or_insert_with(|| system.clone()) != system {
            prisms.builder.skip("layers in another reference system than the first", 1, || layer.table.clone());
            continue;
        }
        read_layer(&database, layer, &query(layer, &columns, fields)?, &mut rows_left, &mut prisms)?;
    }
    let Some(crs) = crs else {
        // None has it: all their fields are listed.
        return fields.among(&numeric).and(Err(SurfaceError::whole("the fields of heights stand in different layers")));
    };
    let mut file = prisms.builder.file;
    file.format = FORMAT.to_owned();
    file.crs = crs;
    Ok(file)
}

/// What a program wrote and did not finish stands in a file beside, and would be missed.
fn refuse_pending(path: &Path) -> Result<(), SurfaceError> {
    for ending in ["-wal", "-journal"] {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        if std::fs::metadata(&name).is_ok_and(|found| found.len() > 0) {
            let problem = format!(
                "the GeoPackage is open elsewhere or was not closed ({ending} beside it); close it there first"
            );
            return Err(SurfaceError::whole(problem));
        }
    }
    Ok(())
}

/// Read-only, and as a file that nobody changes: no lock, no file beside.
fn open(path: &Path) -> rusqlite::Result<Connection> {
    let mut uri = "file:".to_owned();
    for byte in std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).as_os_str().as_encoded_bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' | b'0'..=b'9' | b'A'..=b'Z' | b'a'..=b'z' => uri.push(char::from(*byte)),
            other => uri.push_str(&format!("%{other:02X}")),
        }
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(uri + "?immutable=1", flags)?;
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, LONGEST_VALUE_BYTES)?;
    // A schema may hold expressions; and pages whose cells lie are found early.
    database.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;")?;
    Ok(database)
}

struct Layer {
    table: String,
    geometry: String,
    srs: i64,
}

/// Tables of features. Views are left out: they may compute without end.
fn layers(database: &Connection) -> rusqlite::Result<Vec<Layer>> {
    let mut statement = database.prepare(
        "SELECT g.table_name, g.column_name, g.srs_id FROM gpkg_geometry_columns g JOIN sqlite_master m \
         ON m.name = g.table_name AND m.type = 'table' AND m.sql NOT LIKE 'CREATE VIRTUAL%' ORDER BY g.table_name",
    )?;
    let layers =
        statement.query_map([], |row| Ok(Layer { table: row.get(0)?, geometry: row.get(1)?, srs: row.get(2)? }))?;
    layers.collect()
}

fn numeric_columns(database: &Connection, layer: &Layer) -> rusqlite::Result<Vec<String>> {
    let mut statement = database.prepare(&format!("PRAGMA table_info({})", quoted(&layer.table)))?;
    let columns = statement.query_map([], |row| Ok((row.get::<_, String>(1)?, row.get::<_, String>(2)?)))?;
    let is_numeric = |declared: &str| {
        let declared = declared.to_uppercase();
        ["INT", "REAL", "DOUBLE", "FLOAT", "NUMERIC", "DECIMAL"].iter().any(|name| declared.contains(name))
    };
    columns
        .filter(|column| column.as_ref().map_or(true, |(_, declared)| is_numeric(declared)))
        .map(|column| Ok(column?.0))
        .collect()
}

/// `EPSG:3006`, or the definition where no authority is named; nothing for -1 and 0, which are undefined.
fn reference_system(database: &Connection, layer: &Layer) -> rusqlite::Result<Option<String>> {
    if layer.srs <= 0 {
        return Ok(None);
    }
    let mut statement = database.prepare(
        "SELECT organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?1",
    )?;
    let mut rows = statement.query([layer.srs])?;
    let Some(row) = rows.next()? else { return Ok(None) };
    let (organization, code, definition): (String, i64, String) = (row.get(0)?, row.get(1)?, row.get(2)?);
    let is_named = !organization.is_empty() && !organization.eq_ignore_ascii_case("none");
    Ok(Some(if is_named { format!("{}:{code}", organization.to_uppercase()) } else { definition }))
}

/// Number, geometry, height and base of each row.
fn query(layer: &Layer, numeric: &[String], fields: &FootprintFields) -> Result<String, SurfaceError> {
    let columns = fields.among(numeric)?;
    let base = columns.base.map_or("0.0".to_owned(), |base| quoted(&numeric[base]));
    let (geometry, height) = (quoted(&layer.geometry), quoted(&numeric[columns.height]));
    Ok(format!("SELECT rowid, {geometry}, {height}, {base} FROM {}", quoted(&layer.table)))
}

/// A row takes more than a byte: where there are more than the file has, its pages lead in a circle.
fn read_layer(
    database: &Connection,
    layer: &Layer,
    query: &str,
    rows_left: &mut u64,
    prisms: &mut Prisms,
) -> Result<(), SurfaceError> {
    let mut statement = database.prepare(query).map_err(broken)?;
    let mut rows = statement.query([]).map_err(broken)?;
    while let Some(row) = rows.next().map_err(broken)? {
        *rows_left = rows_left
            .checked_sub(1)
            .ok_or_else(|| SurfaceError::whole("the GeoPackage has more rows than bytes; get it again"))?;
        let record: i64 = row.get(0).map_err(broken)?;
        let id = format!("{} {record}", layer.table);
        let place = Place::Record(record.unsigned_abs());
        let polygons = match row.get_ref(1).map_err(broken)? {
            ValueRef::Blob(blob) => {
                polygons_of(blob).map_err(|problem| SurfaceError::at(place, problem).of(Some(id.clone())))?
            }
            _ => Default::default(),
        };
        prisms.builder.skip("heights of footprints' corners", usize::from(polygons.has_heights), || id.clone());
        prisms.builder.skip("rings without an area", polygons.flat_rings, || id.clone());
        prisms.builder.skip("points, lines, and surfaces bounded by curves", polygons.others, || id.clone());
        prisms.add(Footprint {
            id,
            record: record.unsigned_abs(),
            outlines: polygons.outlines,
            height: number(row.get_ref(2).map_err(broken)?),
            base: number(row.get_ref(3).map_err(broken)?),
        })?;
    }
    Ok(())
}

fn number(value: ValueRef<'_>) -> Option<f64> {
    match value {
        ValueRef::Integer(value) => Some(value as f64),
        ValueRef::Real(value) => Some(value),
        ValueRef::Text(text) => fast_float2::parse(text.trim_ascii()).ok(),
        ValueRef::Null | ValueRef::Blob(_) => None,
    }
}

/// A name in a statement, whatever is in it.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\"").replace('\0', ""))
}

fn broken(error: rusqlite::Error) -> SurfaceError {
    SurfaceError::whole(format!("the GeoPackage cannot be read: {error}; get it again, or write it again with ogr2ogr"))
}
