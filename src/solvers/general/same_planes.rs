//! Which rows share a plane.
//!
//! Planes that agree to within rounding lie in one cell of a fine grid over (normal, offset), or in two beside each other, so
//! that each row is compared with few others.

use std::collections::HashMap;

use crate::geometry::Vector3;

/// Sine below which two normals have the same direction, and relative difference below which their offsets agree.
pub const SAME_PLANE: f64 = 1e-12;

/// How far apart the coordinates of one plane can be: its normals by the sine; the logarithms of its offsets by twice the relative
/// difference, and by their rounding.
const REACH: f64 = 4.0 * SAME_PLANE;

/// Side of a cell: with 16 reaches one coordinate in eight is near to a border and is looked for on both sides.
const CELL: f64 = 16.0 * REACH;

/// Normal and logarithm of the offset in cells; the offset's sign.
type Cell = ([i64; 4], i8);

/// No plane, or none further.
const NONE: u32 = u32::MAX;

/// The planes of rows with unit normals.
pub struct SamePlanes {
    /// Index of the plane of each row.
    pub plane_of: Vec<usize>,
    pub planes: usize,
}

pub fn parallel(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    a.cross(b).norm() < SAME_PLANE
}

impl SamePlanes {
    /// A row belongs to the first plane whose first row has the same plane.
    pub fn of(normals: &[Vector3<f64>], offsets: &[f64]) -> SamePlanes {
        let same = |a: usize, b: usize| {
            let sense = if normals[a].dot(&normals[b]) > 0.0 { 1.0 } else { -1.0 };
            let size = offsets[a].abs() + offsets[b].abs();
            parallel(&normals[a], &normals[b]) && (offsets[a] - sense * offsets[b]).abs() <= SAME_PLANE * size
        };
        // Of every cell the plane that came last; of every plane its first row, and the plane before it in its cell.
        let mut last_in: HashMap<Cell, u32> = HashMap::new();
        let mut planes: Vec<(usize, u32)> = Vec::new();
        let mut plane_of = Vec::with_capacity(normals.len());
        for row in 0..normals.len() {
            let mut found: Option<u32> = None;
            for sense in [1.0, -1.0] {
                for cell in cells_near(&(normals[row] * sense), offsets[row] * sense) {
                    let mut plane = last_in.get(&cell).copied().unwrap_or(NONE);
                    while plane != NONE {
                        let (first, before) = planes[plane as usize];
                        if found.is_none_or(|found| plane < found) && same(row, first) {
                            found = Some(plane);
                        }
                        plane = before;
                    }
                }
            }
            let plane = found.unwrap_or_else(|| {
                let plane = planes.len() as u32;
                let before = last_in.insert(cell_of(&normals[row], offsets[row]), plane);
                planes.push((row, before.unwrap_or(NONE)));
                plane
            });
            plane_of.push(plane as usize);
        }
        SamePlanes { plane_of, planes: planes.len() }
    }
}

fn coordinates(normal: &Vector3<f64>, offset: f64) -> ([f64; 4], i8) {
    // Planes through the origin agree with no others.
    let sign = if offset == 0.0 { 0 } else { offset.signum() as i8 };
    let size = if sign == 0 { 0.0 } else { offset.abs().ln() };
    ([normal.x, normal.y, normal.z, size], sign)
}

/// Numbers that are common in normals, such as 0 and 1, lie in the middle of their cells.
fn cell(coordinate: f64) -> i64 {
    (coordinate / CELL).round() as i64
}

fn cell_of(normal: &Vector3<f64>, offset: f64) -> Cell {
    let (at, sign) = coordinates(normal, offset);
    (at.map(cell), sign)
}

/// Every cell that comes within reach.
fn cells_near(normal: &Vector3<f64>, offset: f64) -> impl Iterator<Item = Cell> {
    let (at, sign) = coordinates(normal, offset);
    let (low, high) = (at.map(|v| cell(v - REACH)), at.map(|v| cell(v + REACH)));
    let corners =
        (0..16_usize).map(move |bits| std::array::from_fn(|k| if bits >> k & 1 == 0 { low[k] } else { high[k] }));
    let is_first = move |bits: &usize| (0..4).all(|k| bits >> k & 1 == 0 || low[k] != high[k]);
    (0..16_usize).zip(corners).filter(move |(bits, _)| is_first(bits)).map(move |(_, corner)| (corner, sign))
}

#[cfg(test)]
mod tests;
