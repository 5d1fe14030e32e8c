//! The normal equations of the last estimate, solved for given variances and weights.
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
use super::rows::{COMMON, LIDS, OF_BUILDING, POSE, WALLS, rows};
use crate::correspondence::PoseRefiner;
use crate::geometry::{Point3, Similarity};
use crate::limits::UncertaintyLimits;
use crate::robust::{Matrix7, MotionParameters, NormalEquations, Vector7};

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
    pub(super) rows: DMatrix<f64>,
    /// How many unknowns are common to all buildings.
    pub common: usize,
    /// What is known of these beforehand; the start for the pose.
    start: DMatrix<f64>,
    pub variances: Variances,
    pub(super) building_weights: Vec<f64>,
    pub(super) building_plane_weights: Vec<f64>,
    pub(super) cell_weights: Vec<f64>,
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

    pub(super) fn variance_of_cell(&self, cell: usize) -> f64 {
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
}

#[cfg(test)]
mod tests;
