//! `database.db` of COLMAP: positions and gravity of photographs (pose priors).
//!
//! COLMAP 4: `pose_priors(pose_prior_id, corr_data_id, corr_sensor_id, corr_sensor_type, position, position_covariance, gravity,
//! coordinate_system)`, where `corr_data_id` is the image for a camera; before: `pose_priors(image_id, position, coordinate_system,
//! position_covariance)`. Blobs hold little-endian f64. Coordinate systems: -1 unknown, 0 WGS 84 (latitude, longitude, altitude), 1 Cartesian.
//! Gravity points down in the camera's frame. (colmap/colmap, src/colmap/scene/database_sqlite.cc and geometry/pose_prior.h, 4.1.)

use std::collections::BTreeSet;
use std::path::Path;

use rusqlite::{Connection, OpenFlags, Row};

use super::error::PositionsError;
use super::frame::{Frame, GEOGRAPHIC};
use super::record::{PositionsFile, StoredPosition, look_like_degrees, sigma};
use crate::format::file::open_regular;

const EXPECTED: &str = "database.db of COLMAP with pose priors (its feature_extractor takes them from EXIF)";

/// As every SQLite database begins (its file format, section 1.3).
pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";

/// COLMAP's numbers for coordinate systems.
const WGS84: i64 = 0;
const CARTESIAN: i64 = 1;

pub(super) fn read(path: &Path) -> Result<PositionsFile, PositionsError> {
    // SQLite opens whatever it is given; this refuses pipes and devices.
    open_regular(path).map_err(|source| PositionsError::Io { what: "database", path: path.into(), source })?;
    let fault = |source| PositionsError::Database { path: path.into(), source };
    let rows = priors(&open(path).map_err(fault)?).map_err(fault)?;
    let content = |found: &str| PositionsError::Content { path: path.into(), found: found.into(), expected: EXPECTED };
    sorted_out(rows.ok_or_else(|| content("it has no table pose_priors"))?)
        .ok_or_else(|| content("its pose priors hold neither a position nor gravity"))
}

/// Read-only, and without the files that SQLite keeps beside a database in use, unless one is there.
fn open(path: &Path) -> rusqlite::Result<Connection> {
    let mut log = path.as_os_str().to_owned();
    log.push("-wal");
    let in_use = std::fs::metadata(&log).is_ok_and(|found| found.len() > 0);
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    if in_use {
        return Connection::open_with_flags(path, flags);
    }
    // URI file names (sqlite.org/uri.html): what would mean something in one is written as %XX.
    let text = path.to_string_lossy();
    let escaped: String =
        text.chars().map(|c| if "%?#".contains(c) { format!("%{:02X}", c as u32) } else { c.to_string() }).collect();
    let prefix = if path.is_absolute() { "file://" } else { "file:" };
    Connection::open_with_flags(format!("{prefix}{escaped}?immutable=1"), flags | OpenFlags::SQLITE_OPEN_URI)
}

/// A prior as the database has it.
struct Prior {
    position: StoredPosition,
    coordinates: i64,
}

/// `None` where there is no such table. A view is none: it may compute without end.
fn priors(database: &Connection) -> rusqlite::Result<Option<Vec<Prior>>> {
    let columns = columns(database, "pose_priors")?;
    if columns.is_empty() || !columns.contains("position") {
        return Ok(None);
    }
    let or_null = |name: &'static str| if columns.contains(name) { format!("p.{name}") } else { "NULL".to_owned() };
    let image = if columns.contains("corr_data_id") { "p.corr_data_id" } else { "p.image_id" };
    let cameras_alone = if columns.contains("corr_sensor_type") { "WHERE p.corr_sensor_type = 0" } else { "" };
    let query = format!(
        "SELECT i.name, p.position, {}, {}, {} FROM pose_priors p JOIN images i ON i.image_id = {image} {cameras_alone} ORDER BY i.name",
        or_null("position_covariance"),
        or_null("gravity"),
        or_null("coordinate_system"),
    );
    let mut statement = database.prepare(&query)?;
    let rows = statement.query_map([], prior)?;
    rows.collect::<rusqlite::Result<Vec<_>>>().map(Some)
}

/// Names of a table's columns; none where it is no plain table.
fn columns(database: &Connection, table: &str) -> rusqlite::Result<BTreeSet<String>> {
    let plain = "SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name IN ('pose_priors', 'images') \
                 AND sql NOT LIKE 'CREATE VIRTUAL%'";
    if database.query_row(plain, [], |row| row.get::<_, i64>(0))? < 2 {
        return Ok(BTreeSet::new());
    }
    let mut statement = database.prepare("SELECT name FROM pragma_table_info(?1)")?;
    let names = statement.query_map([table], |row| row.get::<_, String>(0))?;
    names.collect()
}

fn prior(row: &Row) -> rusqlite::Result<Prior> {
    let blob = |k: usize| row.get::<_, Option<Vec<u8>>>(k);
    let place = numbers::<3>(blob(1)?);
    let covariance = numbers::<9>(blob(2)?);
    let variance = |k: usize| sigma(covariance.map(|c| c[4 * k].sqrt()));
    let coordinates = row.get::<_, Option<i64>>(4)?.unwrap_or(-1);
    let position = StoredPosition {
        name: row.get::<_, String>(0)?.replace('\\', "/"),
        east_north: place.map(|[x, y, _]| if coordinates == WGS84 { [y, x] } else { [x, y] }),
        height_m: place.map(|[_, _, z]| z),
        sigma_m: variance(0).zip(variance(1)).map(|(x, y)| x.max(y)),
        height_sigma_m: variance(2),
        gravity_in_cam: numbers::<3>(blob(3)?).filter(|g| g.iter().any(|v| *v != 0.0)),
    };
    Ok(Prior { position, coordinates })
}

/// The f64 of a blob; `None` where it has another length, or one of them is none.
fn numbers<const N: usize>(blob: Option<Vec<u8>>) -> Option<[f64; N]> {
    let blob = blob.filter(|blob| blob.len() == 8 * N)?;
    let mut numbers = [0.0; N];
    for (number, bytes) in numbers.iter_mut().zip(blob.chunks_exact(8)) {
        *number = f64::from_le_bytes(bytes.try_into().ok()?);
    }
    numbers.iter().all(|v| v.is_finite()).then_some(numbers)
}

/// Priors of one coordinate system: that of most positions. Gravity is taken from all.
fn sorted_out(mut priors: Vec<Prior>) -> Option<PositionsFile> {
    let count =
        |system: i64| priors.iter().filter(|p| p.coordinates == system && p.position.east_north.is_some()).count();
    let system =
        [WGS84, CARTESIAN, -1].into_iter().max_by_key(|system| (count(*system), *system == WGS84)).unwrap_or(-1);
    let mut others = 0;
    for prior in priors.iter_mut().filter(|p| p.coordinates != system && p.position.east_north.is_some()) {
        (prior.position.east_north, prior.position.height_m) = (None, None);
        others += 1;
    }
    let mut positions: Vec<StoredPosition> = priors.into_iter().map(|p| p.position).collect();
    positions.retain(|p| p.east_north.is_some() || p.gravity_in_cam.is_some());
    let unnamed_degrees = system != WGS84 && look_like_degrees(&positions);
    if unnamed_degrees {
        // Written without saying so, in the order of EXIF: latitude first.
        positions.iter_mut().filter_map(|p| p.east_north.as_mut()).for_each(|place| place.reverse());
    }
    let frame = if system == WGS84 || unnamed_degrees { GEOGRAPHIC } else { Frame::OfTheCity };
    let warnings = if others > 0 {
        vec![format!("{others} positions of the database are in another coordinate system, left out")]
    } else {
        vec![]
    };
    (!positions.is_empty()).then_some(PositionsFile { format: "COLMAP database", frame, positions, warnings })
}
