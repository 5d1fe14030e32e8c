//! The equations of the last estimate: one row a surface cell, one column an unknown.
//!
//! Source       docs/mathematics.md, section 17.1

use nalgebra::DMatrix;

use super::bending::Bending;
use super::observations::Observations;
use crate::robust::{Motion, MotionParameters};

/// Unknowns of the pose.
pub(super) const POSE: usize = 7;
/// Index of the unknown that is common to all walls, and of that of all lids.
pub(super) const WALLS: usize = POSE;
pub(super) const LIDS: usize = POSE + 1;
/// Unknowns that are common to the pose and the whole model: seven of the pose, one of walls, one of lids.
pub(super) const COMMON: usize = POSE + 2;
/// Shift and turn of a building.
pub(super) const OF_BUILDING: usize = 4;
/// Offset and tilts of a building plane.
pub(super) const OF_BUILDING_PLANE: usize = 3;

/// Columns: unknowns common to all, distance, building, building plane.
pub(super) fn rows(
    sample: &Observations,
    parameters: &MotionParameters,
    bending: &Bending,
    common: usize,
) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(common + 1 + OF_BUILDING + OF_BUILDING_PLANE, sample.cells.len());
    for building in &sample.buildings {
        for building_plane in &sample.building_planes[building.building_planes.clone()] {
            for k in building_plane.cells.clone() {
                let (cell, mut row) = (&sample.cells[k], rows.column_mut(k));
                row.rows_mut(0, POSE).copy_from(&parameters.row(&cell.foot, &cell.normal));
                if parameters.motion == Motion::Rigid {
                    row[POSE - 1] = 0.0;
                }
                row[WALLS] = f64::from(u8::from(building_plane.is_wall));
                row[LIDS] = f64::from(u8::from(building_plane.is_top));
                let bends = bending.at(&cell.foot, parameters);
                bends.iter().enumerate().for_each(|(b, bend)| row[COMMON + b] = bend.dot(&cell.normal));
                row[common] = cell.across_m;
                let (n, arm) = (cell.normal, cell.foot - building.middle);
                let turn = (arm.x * n.y - arm.y * n.x) / building.lever_m;
                [n.x, n.y, n.z, turn].iter().enumerate().for_each(|(b, value)| row[common + 1 + b] = *value);
                let along = |a: usize| {
                    building_plane.axes[a].dot(&(cell.foot - building_plane.middle)) / building_plane.reach_m[a]
                };
                [1.0, along(0), along(1)]
                    .iter()
                    .enumerate()
                    .for_each(|(f, value)| row[common + 1 + OF_BUILDING + f] = *value);
            }
        }
    }
    rows
}
