//! FlatCityBuf (.fcb): features of CityJSON as FlatBuffers, brought to the text of a CityJSON sequence by the `fcb_core` crate.
//!
//! The crate's own reader is passed by: it verifies the header and goes on whatever comes of it, without checks from there on, and it counts
//! shells and rings of damaged files up to four billion of nothing. Here every table is verified before it is looked into, and every count is held
//! against what it counts. The crate panics on attributes that are no such; that is caught.

use std::panic::{AssertUnwindSafe, catch_unwind};

use fcb_core::deserializer::{to_cj_feature, to_cj_metadata};
use fcb_core::{
    CityFeature, Geometry, Header, PackedRTree, check_magic_bytes, size_prefixed_root_as_city_feature,
    size_prefixed_root_as_header,
};

use super::cityjson::read_cityjson;
use super::surface_error::{Place, SurfaceError};
use super::surfaces::SurfaceFile;

/// The mark with the version, and the length before every table.
const MARK_BYTES: usize = 8;
const LENGTH_BYTES: usize = 4;

/// Entries of an index have 40 bytes: a box and an offset.
const INDEX_ENTRY_BYTES: u64 = 40;

pub fn is_flatcitybuf(bytes: &[u8]) -> bool {
    bytes.get(..MARK_BYTES).is_some_and(check_magic_bytes)
}

pub fn read_flatcitybuf(bytes: &[u8]) -> Result<SurfaceFile, SurfaceError> {
    let damaged = || SurfaceError::whole("FlatCityBuf with values that are none; write it again");
    let text = catch_unwind(AssertUnwindSafe(|| sequence(bytes))).unwrap_or_else(|_| Err(damaged()))?;
    let file = read_cityjson(&text);
    let file = file.map_err(|error| SurfaceError::whole(format!("FlatCityBuf, brought to CityJSON: {error}")))?;
    Ok(SurfaceFile { format: format!("FlatCityBuf ({})", file.format), ..file })
}

/// The same city as a CityJSON sequence: the header's line, then a line for each feature.
fn sequence(bytes: &[u8]) -> Result<Vec<u8>, SurfaceError> {
    let (table, mut at) = table_at(bytes, MARK_BYTES)?;
    let header = size_prefixed_root_as_header(&table).map_err(|error| broken(MARK_BYTES, &error))?;
    for geometry in header.templates().iter().flatten() {
        check_counts(&geometry).map_err(|problem| SurfaceError::at(Place::Byte(MARK_BYTES as u64), problem))?;
    }
    let metadata = to_cj_metadata(&header).map_err(|error| broken(MARK_BYTES, &error))?;
    let mut text = line(&metadata, MARK_BYTES)?;
    at = features_at(&header, at, bytes.len())?;
    let count = header.features_count();
    let mut read = 0;
    // A count of 0 is that of a writer that did not know it.
    while if count > 0 { read < count } else { at < bytes.len() } {
        let (table, next) = table_at(bytes, at)?;
        let feature = size_prefixed_root_as_city_feature(&table).map_err(|error| broken(at, &error))?;
        check_feature(&feature).map_err(|problem| SurfaceError::at(Place::Byte(at as u64), problem))?;
        let feature = to_cj_feature(feature, header.columns(), header.semantic_columns());
        text.extend(line(&feature.map_err(|error| broken(at, &error))?, at)?);
        (at, read) = (next, read + 1);
    }
    Ok(text)
}

/// The table that begins with its length there, and where the next one does. A copy: tables are looked at where memory is aligned.
fn table_at(bytes: &[u8], at: usize) -> Result<(Vec<u8>, usize), SurfaceError> {
    let cut = || SurfaceError::at(Place::Byte(at as u64), "FlatCityBuf is cut off here; get the whole file");
    let length = bytes.get(at..at + LENGTH_BYTES).and_then(|length| length.first_chunk()).ok_or_else(cut)?;
    let end = (at + LENGTH_BYTES).checked_add(u32::from_le_bytes(*length) as usize).ok_or_else(cut)?;
    Ok((bytes.get(at..end).ok_or_else(cut)?.to_vec(), end))
}

/// Behind the header and the indexes.
fn features_at(header: &Header<'_>, at: usize, length: usize) -> Result<usize, SurfaceError> {
    let beyond =
        || SurfaceError::whole("FlatCityBuf says more features than the file has bytes for; get the whole file");
    let (count, node_size) = (header.features_count(), header.index_node_size());
    let tree = match (count, node_size) {
        (0, _) | (_, 0) => 0,
        _ if count > length as u64 / INDEX_ENTRY_BYTES => return Err(beyond()),
        (_, 1) => return Err(SurfaceError::whole("FlatCityBuf with an index of one entry a node; write it again")),
        _ => PackedRTree::index_size(count as usize, node_size) as u64,
    };
    let attributes = header
        .attribute_index()
        .map_or(0, |indexes| indexes.iter().map(|index| u64::from(index.length())).fold(0, u64::saturating_add));
    let features_at = (at as u64).saturating_add(tree).saturating_add(attributes);
    usize::try_from(features_at).ok().filter(|at| *at <= length).ok_or_else(beyond)
}

fn check_feature(feature: &CityFeature<'_>) -> Result<(), String> {
    for object in feature.objects().iter().flatten() {
        for geometry in object.geometry().iter().flatten() {
            check_counts(&geometry).map_err(|problem| format!("object {}: {problem}", object.id()))?;
        }
    }
    Ok(())
}

/// Each level counts what the next one lists: solids shells, shells surfaces, surfaces rings, rings corners. Materials and textures count alike.
fn check_counts(geometry: &Geometry<'_>) -> Result<(), String> {
    macro_rules! levels {
        ($from:expr, $($level:ident),+) => {
            check_levels(&[$($from.$level().map_or(Vec::new(), |counts| counts.iter().collect())),+])
        };
    }
    levels!(geometry, solids, shells, surfaces, strings, boundaries)?;
    for material in geometry.material().iter().flatten() {
        levels!(material, solids, shells, vertices)?;
    }
    for texture in geometry.texture().iter().flatten() {
        levels!(texture, solids, shells, surfaces, strings, vertices)?;
    }
    Ok(())
}

fn check_levels(levels: &[Vec<u32>]) -> Result<(), String> {
    for pair in levels.windows(2) {
        let said: u64 = pair[0].iter().map(|count| u64::from(*count)).sum();
        if said > pair[1].len() as u64 {
            return Err(format!(
                "its boundaries count {said} parts, of which {} are there; write it again",
                pair[1].len()
            ));
        }
    }
    Ok(())
}

/// One line of JSON, its members in the order of their names whatever order they were gathered in.
fn line(value: &impl serde::Serialize, at: usize) -> Result<Vec<u8>, SurfaceError> {
    let mut value = serde_json::to_value(value).map_err(|error| broken(at, &error))?;
    // A crate below `fcb_core` makes serde_json keep the order of insertion, which here is that of a hash map.
    value.sort_all_objects();
    Ok(format!("{value}\n").into_bytes())
}

fn broken(at: usize, error: &dyn std::fmt::Display) -> SurfaceError {
    // The verifier tells its way through the table on further lines.
    let told = error.to_string();
    let problem = format!("FlatCityBuf is damaged ({}); write it again", told.lines().next().unwrap_or_default());
    SurfaceError::at(Place::Byte(at as u64), problem)
}
