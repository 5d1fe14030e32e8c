//! How far buildings, building planes and surface cells scatter, and what weight each has.
//!
//! Question     given the unknowns and their covariance, which variances and weights make them most likely?
//! Method       one step of expectation and maximisation: a variance is the mean of the expected squares, those of a found value and
//!              of its own variance; a weight is that of Student's t. Each mean begins with what is known beforehand
//! Source       docs/mathematics.md, section 17.2; Laird and Ware 1982; Lange, Little and Taylor 1989

use nalgebra::{DMatrix, DVector};

use super::observations::KINDS;
use super::rows::{COMMON, OF_BUILDING, OF_BUILDING_PLANE};
use super::system::{System, Variances};

impl System<'_> {
    /// Variances and weights by what the unknowns turn out to be, and by how well these are known.
    pub(super) fn update_variances(&mut self) {
        let (limits, sample) = (self.limits, self.sample);
        let of_kind = |count: usize, first_m: f64, worth: f64| Squares {
            sum: worth * first_m * first_m,
            count: worth,
            each: count as f64,
        };
        let mut of_buildings = [of_kind(OF_BUILDING, limits.building_sigma_m, limits.building_worth); KINDS];
        let mut of_building_planes =
            [of_kind(OF_BUILDING_PLANE, limits.building_plane_sigma_m, limits.building_plane_worth); KINDS];
        let mut of_cells = of_kind(1, limits.cell_sigma_m, limits.cell_worth);
        for (b, of_building) in sample.buildings.iter().enumerate() {
            let (building, covariance, squared) = self.building_found(b);
            let kind = of_building.kind as usize;
            self.building_weights[b] = weight(squared / self.variances.building[kind], OF_BUILDING, limits.student_dof);
            of_buildings[kind].add(self.building_weights[b] * squared);
            for (k, building_plane) in of_building.building_planes.clone().enumerate() {
                let found = self.building_plane_found(b, k, &building, &covariance);
                let squared = found.squared;
                let kind = sample.building_planes[building_plane].kind as usize;
                self.building_plane_weights[building_plane] =
                    weight(squared / self.variances.building_plane[kind], OF_BUILDING_PLANE, limits.student_dof);
                of_building_planes[kind].add(self.building_plane_weights[building_plane] * squared);
                for cell in sample.building_planes[building_plane].cells.clone() {
                    let squared = self.update_cell(cell, &building, &found);
                    of_cells.add(squared);
                }
            }
        }
        let fields = self.common - COMMON;
        let mut of_bending =
            of_kind(1, limits.bending_share * self.radius_m / (fields.max(1) as f64).sqrt(), limits.bending_worth);
        (COMMON..self.common).for_each(|k| of_bending.add(self.found[k].powi(2) + self.covariance[(k, k)]));
        self.variances = Variances {
            building: of_buildings.map(|squares| squares.mean()),
            building_plane: of_building_planes.map(|squares| squares.mean()),
            cell: of_cells.mean(),
            bending: of_bending.mean() * fields.max(1) as f64,
        };
    }

    /// A building's shift and turn, the joint covariance of the common unknowns and these, and their expected square.
    pub(super) fn building_found(&self, b: usize) -> (DVector<f64>, DMatrix<f64>, f64) {
        let (n, own) = (self.common, &self.parts[b].building);
        let coupling = own.coupling.rows(0, n);
        let pull = own.coupling.row(n).transpose() + coupling.transpose() * &self.found;
        let found = -(&own.covariance * pull);
        let gain = &own.covariance * coupling.transpose();
        let cross = -(&gain * &self.covariance);
        let block = &own.covariance - &cross * gain.transpose();
        let squared = found.norm_squared() + block.trace();
        let mut joint = DMatrix::zeros(n + OF_BUILDING, n + OF_BUILDING);
        joint.view_mut((0, 0), (n, n)).copy_from(&self.covariance);
        joint.view_mut((n, 0), (OF_BUILDING, n)).copy_from(&cross);
        joint.view_mut((0, n), (n, OF_BUILDING)).copy_from(&cross.transpose());
        joint.view_mut((n, n), (OF_BUILDING, OF_BUILDING)).copy_from(&block);
        (found, joint, squared)
    }

    /// A building plane's offset and tilts, with all that they err together with.
    pub(super) fn building_plane_found(
        &self,
        b: usize,
        k: usize,
        building: &DVector<f64>,
        joint: &DMatrix<f64>,
    ) -> BuildingPlaneFound {
        let (n, own) = (self.common, &self.parts[b].building_planes[k]);
        // Common unknowns, then the building's; the distance's row stands between.
        let others: Vec<usize> = (0..n).chain(n + 1..n + 1 + OF_BUILDING).collect();
        let coupling = own.coupling.select_rows(&others);
        let values = DVector::from_iterator(others.len(), self.found.iter().chain(building.iter()).copied());
        let offsets = -(&own.covariance * (own.coupling.row(n).transpose() + coupling.transpose() * values));
        let gain = &own.covariance * coupling.transpose();
        let cross = -(&gain * joint);
        let block = &own.covariance - &cross * gain.transpose();
        let squared = offsets.norm_squared() + block.trace();
        let before = others.len();
        let mut all = DMatrix::zeros(before + OF_BUILDING_PLANE, before + OF_BUILDING_PLANE);
        all.view_mut((0, 0), (before, before)).copy_from(joint);
        all.view_mut((before, 0), (OF_BUILDING_PLANE, before)).copy_from(&cross);
        all.view_mut((0, before), (before, OF_BUILDING_PLANE)).copy_from(&cross.transpose());
        all.view_mut((before, before), (OF_BUILDING_PLANE, OF_BUILDING_PLANE)).copy_from(&block);
        BuildingPlaneFound { offsets, squared, joint: all }
    }

    /// How far a surface cell lies off its facet when all unknowns are what they turn out to be, and the variance of that.
    pub(super) fn residual(
        &self,
        cell: usize,
        building: &DVector<f64>,
        building_plane: &BuildingPlaneFound,
    ) -> (f64, f64) {
        let (n, row) = (self.common, self.rows.column(cell));
        let (common, own) = (row.rows(0, n), row.rows(n + 1, OF_BUILDING + OF_BUILDING_PLANE));
        let off_m = row[n]
            + common.dot(&self.found)
            + own.rows(0, OF_BUILDING).dot(building)
            + own.rows(OF_BUILDING, OF_BUILDING_PLANE).dot(&building_plane.offsets);
        let row = DVector::from_iterator(row.len() - 1, common.iter().chain(own.iter()).copied());
        (off_m, row.dot(&(&building_plane.joint * &row)))
    }

    /// The expected square of a surface cell's own error. Its residual was made small by unknowns that were fitted to it: what is not known of these belongs to the expectation.
    fn update_cell(&mut self, cell: usize, building: &DVector<f64>, building_plane: &BuildingPlaneFound) -> f64 {
        let (off_m, unknown) = self.residual(cell, building, building_plane);
        let squared = off_m * off_m + unknown;
        let variance = self.variance_of_cell(cell);
        self.cell_weights[cell] = weight(squared / variance, 1, self.limits.student_dof);
        let share = self.variances.cell / variance;
        self.cell_weights[cell] * share * share * squared + self.variances.cell * (1.0 - share)
    }
}

/// A building plane's offset and tilts as they turn out to be.
pub(super) struct BuildingPlaneFound {
    pub offsets: DVector<f64>,
    /// Their expected square.
    pub squared: f64,
    /// Covariance of the common unknowns, the building's and these.
    pub joint: DMatrix<f64>,
}

/// A mean of squares that begins with what is known beforehand.
#[derive(Clone, Copy)]
struct Squares {
    sum: f64,
    count: f64,
    /// How many squares are added at a time.
    each: f64,
}

impl Squares {
    fn add(&mut self, squares: f64) {
        self.sum += squares;
        self.count += self.each;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }
}

/// Weight of an unknown of so many parts whose square is so many times its variance, by Student's t.
fn weight(squared: f64, parts: usize, student_dof: f64) -> f64 {
    (student_dof + parts as f64) / (student_dof + squared)
}

#[cfg(test)]
mod tests;
