//! The last estimate of a pose, with all that errs together in the model and the reconstruction as unknowns beside it.
//!
//! Unknowns     the pose (7 or 6); how far all walls stand inside the model's and how high its level tops are too high (common to all);
//!              the reconstruction's bending (26 smooth fields); for each building a shift and a turn; for each front an offset and two tilts
//! Method       least squares with a prior on every unknown but the pose. The spreads of buildings, fronts, pieces and bending are estimated
//!              together with the unknowns (expectation and maximisation, which counts what is not known of an unknown: restricted
//!              maximum likelihood), each with a prior worth a few observations. Buildings, fronts and pieces have heavy tails
//!              (Student's t): a rebuilt house, a front that is another's, a piece with a tree before it are outliers as wholes.
//!              Points are put on facets anew after each round
//! Fails when   the pose is in another basin: then it is exactly wrong

use nalgebra::{DMatrix, DVector};

use super::bending::Bending;
use super::elimination::{Eliminated, eliminate, inverse};
use super::findings::Findings;
use super::leave_out;
use super::sample::{Sample, sample};
use crate::correspondence::Refiner;
use crate::geometry::{Point3, Similarity};
use crate::limits::UncertaintyLimits;
use crate::robust::{Chart, Matrix7, Motion, NormalEquations, Vector7};

/// A pose for good.
#[derive(Clone, Debug)]
pub struct Estimate {
    pub city_from_level: Similarity,
    pub chart: Chart,
    /// What the data hold of the pose, 1 / m^2 in the chart's unknowns.
    pub information: Matrix7,
    /// The same without each of the fronts in turn.
    pub without: Vec<Matrix7>,
    pub findings: Findings,
}

/// Unknowns of the pose.
pub(super) const POSE: usize = 7;
/// ... and the two that are common to the whole model: walls, lids.
pub(super) const WALLS: usize = POSE;
pub(super) const LIDS: usize = POSE + 1;
pub(super) const COMMON: usize = POSE + 2;
/// Shift and turn of a building.
const OF_BUILDING: usize = 4;
/// Offset and tilts of a front.
const OF_FRONT: usize = 3;

/// Standard deviations, squared, m^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spreads {
    pub building: f64,
    pub front: f64,
    pub piece: f64,
    /// Of the bending as a whole.
    pub bending: f64,
}

/// The estimate near a pose.
pub fn estimate(refiner: &Refiner, pose: &Similarity) -> Estimate {
    let scene = refiner.scene;
    let limits = &scene.limits.uncertainty;
    let gate_m = limits.gate_units * scene.unit_m;
    let mut pose = *pose;
    let mut spreads = None;
    let mut round = 0;
    loop {
        let chart = refiner.assess(&[], &pose, 0.0).chart;
        let sample = sample(refiner, &pose, gate_m);
        let places: Vec<Point3<f64>> = scene.votes.probes.iter().map(|probe| pose.apply(&probe.position)).collect();
        let start = scene.prior.information(&chart);
        let mut system = System::new(&sample, &chart, &places, &start, limits, spreads);
        system.settle(limits.steps);
        let held = system.held();
        let moved = chart.moved(&pose, &chart.step(&held, scene.limits.refinement.held_m));
        round += 1;
        if round == limits.rounds || !moved.translation.iter().all(|v| v.is_finite()) {
            let left_out = leave_out::by_building(&system);
            let information = left_out.widened(&held.full());
            let without = leave_out::by_front(&system).iter().map(|m| left_out.widened(m)).collect();
            let findings = Findings::of(&system);
            return Estimate { city_from_level: pose, chart, information, without, findings };
        }
        pose = moved;
        spreads = Some(system.spreads);
    }
}

/// Normal equations by building and front, with the spreads and weights that make them.
pub(super) struct System<'a> {
    pub sample: &'a Sample,
    pub limits: &'a UncertaintyLimits,
    pub radius_m: f64,
    /// One row a piece: unknowns common to all, distance, building, front.
    rows: DMatrix<f64>,
    /// How many unknowns are common to all buildings.
    pub common: usize,
    /// What is known of these beforehand; the start for the pose.
    start: DMatrix<f64>,
    pub spreads: Spreads,
    building_weights: Vec<f64>,
    front_weights: Vec<f64>,
    piece_weights: Vec<f64>,
    pub parts: Vec<Part>,
    /// The unknowns common to all, and their covariance.
    pub found: DVector<f64>,
    pub covariance: DMatrix<f64>,
}

/// One building's share.
pub(super) struct Part {
    /// Of all its fronts, before the building's own unknowns are taken out: common, distance, building.
    pub whole: DMatrix<f64>,
    pub building: Eliminated,
    pub fronts: Vec<Eliminated>,
    pub precision: f64,
}

impl<'a> System<'a> {
    fn new(
        sample: &'a Sample,
        chart: &Chart,
        places: &[Point3<f64>],
        start: &Matrix7,
        limits: &'a UncertaintyLimits,
        spreads: Option<Spreads>,
    ) -> System<'a> {
        let bending = Bending::over(places, chart);
        let common = COMMON + bending.count();
        let mut known = DMatrix::zeros(common, common);
        known.view_mut((0, 0), (POSE, POSE)).copy_from(start);
        let of_spread = |sigma: f64| sigma * sigma;
        let first = Spreads {
            building: of_spread(limits.building_sigma_m),
            front: of_spread(limits.front_sigma_m),
            piece: of_spread(limits.piece_sigma_m),
            bending: of_spread(limits.bending_share * chart.radius),
        };
        System {
            sample,
            limits,
            radius_m: chart.radius,
            rows: rows(sample, chart, &bending, common),
            common,
            start: known,
            spreads: spreads.unwrap_or(first),
            building_weights: vec![1.0; sample.buildings.len()],
            front_weights: vec![1.0; sample.fronts.len()],
            piece_weights: vec![1.0; sample.pieces.len()],
            parts: Vec::new(),
            found: DVector::zeros(common),
            covariance: DMatrix::zeros(common, common),
        }
    }

    /// Estimates unknowns and spreads in turn.
    fn settle(&mut self, steps: usize) {
        for _ in 0..steps {
            self.solve();
            self.learn();
        }
        self.solve();
    }

    fn solve(&mut self) {
        self.parts = (0..self.sample.buildings.len()).map(|b| self.part(b)).collect();
        let total = self.total();
        let known = self.known() + &self.start;
        self.covariance = inverse(total.view((0, 0), (self.common, self.common)) + known);
        self.found = -(&self.covariance * total.view((0, self.common), (self.common, 1)).column(0));
    }

    fn part(&self, building: usize) -> Part {
        let keep = self.common + 1 + OF_BUILDING;
        let of_building = &self.sample.buildings[building];
        let fronts: Vec<Eliminated> = of_building
            .fronts
            .clone()
            .map(|front| {
                eliminate(&self.equations_of_front(front), keep, self.front_weights[front] / self.spreads.front)
            })
            .collect();
        let mut whole = DMatrix::zeros(keep, keep);
        fronts.iter().for_each(|front| whole += &front.rest);
        let precision = self.building_weights[building] / self.spreads.building;
        let building = eliminate(&whole, self.common + 1, precision);
        Part { whole, building, fronts, precision }
    }

    fn equations_of_front(&self, front: usize) -> DMatrix<f64> {
        let size = self.rows.nrows();
        let mut sum = DMatrix::zeros(size, size);
        for piece in self.sample.fronts[front].pieces.clone() {
            let row = self.rows.column(piece);
            sum.syger(self.piece_weights[piece] / self.variance_of_piece(piece), &row, &row, 1.0);
        }
        sum.fill_upper_triangle_with_lower_triangle();
        sum
    }

    fn variance_of_piece(&self, piece: usize) -> f64 {
        self.spreads.piece + self.sample.point_sigma_m.powi(2) / self.sample.pieces[piece].points
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
        (COMMON..self.common).for_each(|k| known[(k, k)] = fields as f64 / self.spreads.bending);
        known
    }

    /// What the data say of the pose.
    fn held(&self) -> NormalEquations {
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

    /// Spreads and weights by what the unknowns turn out to be, and by how well these are known.
    fn learn(&mut self) {
        let limits = self.limits;
        let (mut of_buildings, mut of_fronts, mut of_pieces) = (0.0, 0.0, 0.0);
        for b in 0..self.parts.len() {
            let (building, covariance, squared) = self.building_found(b);
            self.building_weights[b] = weight(squared / self.spreads.building, OF_BUILDING, limits.tails);
            of_buildings += self.building_weights[b] * squared;
            for (k, front) in self.sample.buildings[b].fronts.clone().enumerate() {
                let (offsets, squared) = self.front_found(b, k, &building, &covariance);
                self.front_weights[front] = weight(squared / self.spreads.front, OF_FRONT, limits.tails);
                of_fronts += self.front_weights[front] * squared;
                for piece in self.sample.fronts[front].pieces.clone() {
                    of_pieces += self.learn_piece(piece, &building, &offsets);
                }
            }
        }
        let fields = self.common - COMMON;
        let bends: f64 = (COMMON..self.common).map(|k| self.found[k].powi(2) + self.covariance[(k, k)]).sum();
        let mean = |squares: f64, count: usize, first_m: f64, worth: f64| {
            (worth * first_m * first_m + squares) / (worth + count as f64)
        };
        let sample = self.sample;
        self.spreads = Spreads {
            building: mean(
                of_buildings,
                OF_BUILDING * sample.buildings.len(),
                limits.building_sigma_m,
                limits.building_worth,
            ),
            front: mean(of_fronts, OF_FRONT * sample.fronts.len(), limits.front_sigma_m, limits.front_worth),
            piece: mean(of_pieces, sample.pieces.len(), limits.piece_sigma_m, limits.piece_worth),
            bending: if fields == 0 {
                self.spreads.bending
            } else {
                let first_m = limits.bending_share * self.radius_m / (fields as f64).sqrt();
                mean(bends, fields, first_m, limits.bending_worth) * fields as f64
            },
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

    /// A front's offset and tilts, and their expected square.
    fn front_found(&self, b: usize, k: usize, building: &DVector<f64>, joint: &DMatrix<f64>) -> (DVector<f64>, f64) {
        let (n, own) = (self.common, &self.parts[b].fronts[k]);
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

    /// The expected square of a piece's own error.
    fn learn_piece(&mut self, piece: usize, building: &DVector<f64>, offsets: &DVector<f64>) -> f64 {
        let row = self.rows.column(piece);
        let n = self.common;
        let off_m = row[n]
            + row.rows(0, n).dot(&self.found)
            + row.rows(n + 1, OF_BUILDING).dot(building)
            + row.rows(n + 1 + OF_BUILDING, OF_FRONT).dot(offsets);
        let variance = self.variance_of_piece(piece);
        self.piece_weights[piece] = weight(off_m * off_m / variance, 1, self.limits.tails);
        let share = self.spreads.piece / variance;
        self.piece_weights[piece] * (share * off_m).powi(2) + self.spreads.piece * (1.0 - share)
    }
}

/// Weight of an unknown of so many parts whose square is so many times its variance, by Student's t.
fn weight(squared: f64, parts: usize, tails: f64) -> f64 {
    (tails + parts as f64) / (tails + squared)
}

fn rows(sample: &Sample, chart: &Chart, bending: &Bending, common: usize) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(common + 1 + OF_BUILDING + OF_FRONT, sample.pieces.len());
    for building in &sample.buildings {
        for front in &sample.fronts[building.fronts.clone()] {
            for k in front.pieces.clone() {
                let (piece, mut row) = (&sample.pieces[k], rows.column_mut(k));
                row.rows_mut(0, POSE).copy_from(&chart.row(&piece.foot, &piece.normal));
                if chart.motion == Motion::Rigid {
                    row[POSE - 1] = 0.0;
                }
                row[WALLS] = f64::from(u8::from(front.is_wall));
                row[LIDS] = f64::from(u8::from(front.is_lid));
                let bends = bending.at(&piece.foot, chart);
                bends.iter().enumerate().for_each(|(b, bend)| row[COMMON + b] = bend.dot(&piece.normal));
                row[common] = piece.across_m;
                let (n, arm) = (piece.normal, piece.foot - building.middle);
                let turn = (arm.x * n.y - arm.y * n.x) / building.lever_m;
                [n.x, n.y, n.z, turn].iter().enumerate().for_each(|(b, value)| row[common + 1 + b] = *value);
                let along = |a: usize| front.axes[a].dot(&(piece.foot - front.middle)) / front.reach_m[a];
                [1.0, along(0), along(1)]
                    .iter()
                    .enumerate()
                    .for_each(|(f, value)| row[common + 1 + OF_BUILDING + f] = *value);
            }
        }
    }
    rows
}
