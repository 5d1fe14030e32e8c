//! The normal equations of the last estimate, and the variances and weights that make them.
//!
//! Question     given points on facets about a pose, what are the unknowns beside it, how far do they scatter, and what is left for the pose?
//! Method       building planes are eliminated first, then buildings, then what is common to all but the pose; unknowns and variances are
//!              estimated in turn (expectation and maximisation)
//! Source       docs/mathematics.md, sections 17.1 and 17.2

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::bending::Bending;
use super::elimination::{Eliminated, eliminate, inverse};
use super::observations::{KINDS, Observations};
use crate::correspondence::PoseRefiner;
use crate::geometry::{Point3, Similarity};
use crate::limits::UncertaintyLimits;
use crate::robust::{Matrix7, Motion, MotionParameters, NormalEquations, Vector7};

/// Unknowns of the pose.
pub(super) const POSE: usize = 7;
/// Index of the unknown that is common to all walls, and of that of all lids.
pub(super) const WALLS: usize = POSE;
pub(super) const LIDS: usize = POSE + 1;
/// Unknowns that are common to the pose and the whole model: seven of the pose, one of walls, one of lids.
pub(super) const COMMON: usize = POSE + 2;
/// Shift and turn of a building.
const OF_BUILDING: usize = 4;
/// Offset and tilts of a building plane.
const OF_BUILDING_PLANE: usize = 3;

/// Variances of the random effects, m^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variances {
    /// By kind.
    pub building: [f64; KINDS],
    pub building_plane: [f64; KINDS],
    pub cell: f64,
    /// Of the bending as a whole.
    pub bending: f64,
}

/// Normal equations by building and building plane, with the variances and weights that make them.
pub(super) struct System<'a> {
    pub sample: &'a Observations,
    pub limits: &'a UncertaintyLimits,
    pub radius_m: f64,
    /// One row a surface cell: unknowns common to all, distance, building, building plane.
    rows: DMatrix<f64>,
    /// How many unknowns are common to all buildings.
    pub common: usize,
    /// What is known of these beforehand; the start for the pose.
    start: DMatrix<f64>,
    pub variances: Variances,
    building_weights: Vec<f64>,
    building_plane_weights: Vec<f64>,
    cell_weights: Vec<f64>,
    pub parts: Vec<BuildingSystem>,
    /// The unknowns common to all, and their covariance.
    pub found: DVector<f64>,
    pub covariance: DMatrix<f64>,
}

/// Normal equations of one building.
pub(super) struct BuildingSystem {
    /// Of all its building planes, before the building's own unknowns are taken out: common, distance, building.
    pub whole: DMatrix<f64>,
    pub building: Eliminated,
    pub building_planes: Vec<Eliminated>,
    pub precision: f64,
}

impl<'a> System<'a> {
    fn new(
        sample: &'a Observations,
        parameters: &MotionParameters,
        places: &[Point3<f64>],
        start: &Matrix7,
        limits: &'a UncertaintyLimits,
    ) -> System<'a> {
        let bending = Bending::over(places, parameters);
        let common = COMMON + bending.count();
        let mut known = DMatrix::zeros(common, common);
        known.view_mut((0, 0), (POSE, POSE)).copy_from(start);
        let of_spread = |sigma: f64| sigma * sigma;
        let first = Variances {
            building: [of_spread(limits.building_sigma_m); KINDS],
            building_plane: [of_spread(limits.building_plane_sigma_m); KINDS],
            cell: of_spread(limits.cell_sigma_m),
            bending: of_spread(limits.bending_share * parameters.radius),
        };
        System {
            sample,
            limits,
            radius_m: parameters.radius,
            rows: rows(sample, parameters, &bending, common),
            common,
            start: known,
            variances: first,
            building_weights: vec![1.0; sample.buildings.len()],
            building_plane_weights: vec![1.0; sample.building_planes.len()],
            cell_weights: vec![1.0; sample.cells.len()],
            parts: Vec::new(),
            found: DVector::zeros(common),
            covariance: DMatrix::zeros(common, common),
        }
    }

    /// With unknowns and variances estimated in turn.
    pub fn converged(
        refiner: &PoseRefiner<'a>,
        pose: &Similarity,
        parameters: &MotionParameters,
        sample: &'a Observations,
    ) -> System<'a> {
        let scene = refiner.scene;
        let places: Vec<Point3<f64>> =
            scene.level_cloud.sample_points.iter().map(|sample_point| pose.apply(&sample_point.position)).collect();
        let mut system =
            System::new(sample, parameters, &places, &scene.prior.information(parameters), &scene.limits.uncertainty);
        for _ in 0..system.limits.steps {
            system.solve();
            system.update_variances();
        }
        system.solve();
        system
    }

    /// Multiplies variances by nu / (nu - 2), the variance of Student's t with nu degrees of freedom.
    pub fn widen_to_t_variance(&mut self) {
        let student_dof = self.limits.student_dof;
        let times = student_dof / (student_dof - 2.0);
        let Variances { building, building_plane, cell, bending } = self.variances;
        let wider = |spread: f64| spread * times;
        self.variances = Variances {
            building: building.map(wider),
            building_plane: building_plane.map(wider),
            cell: wider(cell),
            bending,
        };
        self.solve();
    }

    fn solve(&mut self) {
        self.parts = (0..self.sample.buildings.len()).into_par_iter().map(|b| self.part(b)).collect();
        let total = self.total();
        let known = self.known() + &self.start;
        self.covariance = inverse(total.view((0, 0), (self.common, self.common)) + known);
        self.found = -(&self.covariance * total.view((0, self.common), (self.common, 1)).column(0));
    }

    fn part(&self, building: usize) -> BuildingSystem {
        let keep = self.common + 1 + OF_BUILDING;
        let of_building = &self.sample.buildings[building];
        let building_planes: Vec<Eliminated> = of_building
            .building_planes
            .clone()
            .map(|building_plane| {
                let precision = self.building_plane_weights[building_plane]
                    / self.variances.building_plane[self.sample.building_planes[building_plane].kind as usize];
                eliminate(&self.equations_of_building_plane(building_plane), keep, precision)
            })
            .collect();
        let mut whole = DMatrix::zeros(keep, keep);
        building_planes.iter().for_each(|building_plane| whole += &building_plane.rest);
        let precision = self.building_weights[building] / self.variances.building[of_building.kind as usize];
        let building = eliminate(&whole, self.common + 1, precision);
        BuildingSystem { whole, building, building_planes, precision }
    }

    fn equations_of_building_plane(&self, building_plane: usize) -> DMatrix<f64> {
        let size = self.rows.nrows();
        let mut sum = DMatrix::zeros(size, size);
        for cell in self.sample.building_planes[building_plane].cells.clone() {
            let row = self.rows.column(cell);
            sum.syger(self.cell_weights[cell] / self.variance_of_cell(cell), &row, &row, 1.0);
        }
        sum.fill_upper_triangle_with_lower_triangle();
        sum
    }

    fn variance_of_cell(&self, cell: usize) -> f64 {
        self.variances.cell + self.sample.point_sigma_m.powi(2) / self.sample.cells[cell].points
    }

    /// All buildings together: common unknowns, distance.
    pub fn total(&self) -> DMatrix<f64> {
        let mut total = DMatrix::zeros(self.common + 1, self.common + 1);
        self.parts.iter().for_each(|part| total += &part.building.rest);
        total
    }

    /// What is known beforehand of walls, lids and bending, without the start.
    pub fn known(&self) -> DMatrix<f64> {
        let mut known = DMatrix::zeros(self.common, self.common);
        known[(WALLS, WALLS)] = self.limits.walls_sigma_m.powi(-2);
        let lids_sigma_m = if self.sample.has_lids_only { self.limits.lids_sigma_m } else { self.limits.roofs_sigma_m };
        known[(LIDS, LIDS)] = lids_sigma_m.powi(-2);
        let fields = self.common - COMMON;
        (COMMON..self.common).for_each(|k| known[(k, k)] = fields as f64 / self.variances.bending);
        known
    }

    /// What the data say of the pose.
    pub fn held(&self) -> NormalEquations {
        let total = self.total();
        let (information, gradient) = self.of_pose(&total);
        NormalEquations { information, gradient }
    }

    /// Information and gradient of the pose in equations of all common unknowns.
    pub fn of_pose(&self, total: &DMatrix<f64>) -> (Matrix7, Vector7) {
        let known = self.known();
        // The distance's column goes along with the pose's.
        let order: Vec<usize> = (0..POSE).chain([self.common]).chain(POSE..self.common).collect();
        let of = |i: usize, j: usize| if i < self.common && j < self.common { known[(i, j)] } else { 0.0 };
        let sorted =
            DMatrix::from_fn(order.len(), order.len(), |i, j| total[(order[i], order[j])] + of(order[i], order[j]));
        let rest = eliminate(&sorted, POSE + 1, 0.0).rest;
        (rest.fixed_view::<POSE, POSE>(0, 0).into_owned(), rest.fixed_view::<POSE, 1>(0, POSE).into_owned())
    }

    /// Variances and weights by what the unknowns turn out to be, and by how well these are known.
    fn update_variances(&mut self) {
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
                let (offsets, squared) = self.building_plane_found(b, k, &building, &covariance);
                let kind = sample.building_planes[building_plane].kind as usize;
                self.building_plane_weights[building_plane] =
                    weight(squared / self.variances.building_plane[kind], OF_BUILDING_PLANE, limits.student_dof);
                of_building_planes[kind].add(self.building_plane_weights[building_plane] * squared);
                for cell in sample.building_planes[building_plane].cells.clone() {
                    let squared = self.update_cell(cell, &building, &offsets);
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
    fn building_found(&self, b: usize) -> (DVector<f64>, DMatrix<f64>, f64) {
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

    /// A building plane's offset and tilts, and their expected square.
    fn building_plane_found(
        &self,
        b: usize,
        k: usize,
        building: &DVector<f64>,
        joint: &DMatrix<f64>,
    ) -> (DVector<f64>, f64) {
        let (n, own) = (self.common, &self.parts[b].building_planes[k]);
        // Common unknowns, then the building's; the distance's row stands between.
        let others: Vec<usize> = (0..n).chain(n + 1..n + 1 + OF_BUILDING).collect();
        let coupling = own.coupling.select_rows(&others);
        let values = DVector::from_iterator(others.len(), self.found.iter().chain(building.iter()).copied());
        let found = -(&own.covariance * (own.coupling.row(n).transpose() + coupling.transpose() * values));
        let gain = &own.covariance * coupling.transpose();
        let covariance = &own.covariance + &gain * joint * gain.transpose();
        let squared = found.norm_squared() + covariance.trace();
        (found, squared)
    }

    /// The expected square of a surface cell's own error.
    fn update_cell(&mut self, cell: usize, building: &DVector<f64>, offsets: &DVector<f64>) -> f64 {
        let row = self.rows.column(cell);
        let n = self.common;
        let off_m = row[n]
            + row.rows(0, n).dot(&self.found)
            + row.rows(n + 1, OF_BUILDING).dot(building)
            + row.rows(n + 1 + OF_BUILDING, OF_BUILDING_PLANE).dot(offsets);
        let variance = self.variance_of_cell(cell);
        self.cell_weights[cell] = weight(off_m * off_m / variance, 1, self.limits.student_dof);
        let share = self.variances.cell / variance;
        self.cell_weights[cell] * (share * off_m).powi(2) + self.variances.cell * (1.0 - share)
    }
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

fn rows(sample: &Observations, parameters: &MotionParameters, bending: &Bending, common: usize) -> DMatrix<f64> {
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

#[cfg(test)]
mod tests;
