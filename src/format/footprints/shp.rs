//! Polygons of a .shp file (ESRI Shapefile Technical Description, July 1998).

use super::outline::{Outline, by_winding, cleaned};
use crate::format::surface_error::{Place, SurfaceError};

const HEADER_BYTES: usize = 100;
const RECORD_HEADER_BYTES: usize = 8;

/// Type, box, numbers of parts and points.
const POLYGON_HEADER_BYTES: usize = 44;

/// What a file holds, by its number.
const KINDS: [(u32, &str); 12] = [
    (1, "points"),
    (3, "lines"),
    (8, "points"),
    (11, "points"),
    (13, "lines"),
    (18, "points"),
    (21, "points"),
    (23, "lines"),
    (28, "points"),
    (31, "multipatches (write them as CityGML, CityJSON or OBJ)"),
    (0, "nothing"),
    (2, "something unknown"),
];

/// Polygon, PolygonZ, PolygonM.
const POLYGONS: [u32; 3] = [5, 15, 25];

/// A record's polygons; several where it is of several parts.
#[derive(Debug)]
pub(super) struct Shape {
    pub outlines: Vec<Outline>,
    pub has_heights: bool,
    /// Rings with less than three corners or without an area.
    pub flat_rings: usize,
}

/// All records of the file, in order.
pub(super) fn shapes_of(bytes: &[u8]) -> Result<Vec<Shape>, SurfaceError> {
    let kind = little(bytes, 32).ok_or_else(|| cut(0))?;
    if !POLYGONS.contains(&kind) {
        let found = KINDS.iter().find(|(number, _)| *number == kind).map_or("something unknown", |(_, found)| found);
        let problem = format!("the Shapefile holds {found}, expected polygons (the footprints of buildings)");
        return Err(SurfaceError::at(Place::Byte(32), problem));
    }
    // In words of 16 bits. What stands behind it belongs to nobody; writers that fail leave it at zero.
    let length = 2 * big(bytes, 24).ok_or_else(|| cut(0))? as usize;
    let bytes = if length < HEADER_BYTES { bytes } else { bytes.get(..length).ok_or_else(|| cut(bytes.len()))? };
    let mut shapes = Vec::new();
    let mut at = HEADER_BYTES;
    while at < bytes.len() {
        let words = big(bytes, at + 4).ok_or_else(|| cut(at))?;
        let start = at + RECORD_HEADER_BYTES;
        let end = start.checked_add(2 * words as usize).filter(|&end| end <= bytes.len()).ok_or_else(|| cut(at))?;
        let record = shapes.len() as u64 + 1;
        let shape = shape_of(&bytes[start..end]).map_err(|problem| SurfaceError::at(Place::Record(record), problem))?;
        shapes.push(shape);
        at = end;
    }
    Ok(shapes)
}

fn shape_of(record: &[u8]) -> Result<Shape, String> {
    let broken = || "the record is cut off, or says more points than it has; write the Shapefile again".to_owned();
    let kind = little(record, 0).ok_or_else(broken)?;
    if kind == 0 {
        return Ok(Shape { outlines: Vec::new(), has_heights: false, flat_rings: 0 });
    }
    if !POLYGONS.contains(&kind) {
        return Err(format!("the record is of type {kind}, expected polygons (5, 15 or 25)"));
    }
    let (Some(parts), Some(points)) = (little(record, 36), little(record, 40)) else { return Err(broken()) };
    let (parts, points) = (parts as usize, points as usize);
    let points_at = POLYGON_HEADER_BYTES + parts.checked_mul(4).ok_or_else(broken)?;
    let points_end = points.checked_mul(16).and_then(|length| points_at.checked_add(length)).ok_or_else(broken)?;
    let coordinates = record.get(points_at..points_end).ok_or_else(broken)?;
    let starts = record.get(POLYGON_HEADER_BYTES..points_at).ok_or_else(broken)?;
    let starts: Vec<usize> =
        starts.chunks_exact(4).filter_map(|start| little(start, 0)).map(|start| start as usize).collect();
    let mut rings = Vec::new();
    let mut flat_rings = 0;
    for (number, &start) in starts.iter().enumerate() {
        let end = starts.get(number + 1).copied().unwrap_or(points);
        let ring = (start <= end && end <= points).then(|| &coordinates[16 * start..16 * end]).ok_or_else(broken)?;
        match cleaned(&ring.chunks_exact(16).map(position).collect::<Vec<_>>()) {
            Some(ring) => rings.push(ring),
            None => flat_rings += 1,
        }
    }
    let outlines = by_winding(rings).ok_or("the record has too many holes and corners for a footprint")?;
    Ok(Shape { outlines, has_heights: kind == 15, flat_rings })
}

fn position(bytes: &[u8]) -> [f64; 2] {
    let number =
        |at: usize| bytes.get(at..at + 8).and_then(|bytes| bytes.try_into().ok()).map_or(f64::NAN, f64::from_le_bytes);
    [number(0), number(8)]
}

fn little(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

fn big(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

fn cut(at: usize) -> SurfaceError {
    SurfaceError::at(Place::Byte(at as u64), "the Shapefile (.shp) is cut off; get it again")
}
