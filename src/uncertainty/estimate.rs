//! The last estimate of a pose, with all that errs together in the model and the reconstruction as unknowns beside it.
//!
//! Unknowns     the pose (7 or 6); how far all walls stand inside the model's and how high its level tops are too high (common to all);
//!              the reconstruction's bending (26 smooth fields); for each building a shift and a turn; for each front an offset and two tilts
//! Method       least squares with a prior on every unknown but the pose. The spreads of buildings, fronts, pieces and bending are estimated
//!              together with the unknowns (expectation and maximisation, which counts what is not known of an unknown: restricted
//!              maximum likelihood), each with a prior worth a few observations. Buildings, fronts and pieces have heavy tails (Student's t)
//!              (Student's t): a rebuilt house, a front that is another's, a piece with a tree before it are outliers as wholes.
//!              Points are put on facets anew after each round
//! Fails when   the pose is in another basin: then it is exactly wrong

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::bending::Bending;
use super::elimination::{Eliminated, eliminate, inverse};
use super::findings::SystematicErrors;
use super::leave_out;
use super::observations::{KINDS, Observations, sample};
use crate::correspondence::PoseRefiner;
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
    pub findings: SystematicErrors,
}

/// Unknowns of the pose.
pub(super) const POSE: usize = 7;
/// Unknowns that are common to the pose and the whole model: seven of the pose, one of walls, one of lids.
pub(super) const WALLS: usize = POSE;
pub(super) const LIDS: usize = POSE + 1;
pub(super) const COMMON: usize = POSE + 2;
/// Shift and turn of a building.
const OF_BUILDING: usize = 4;
/// Offset and tilts of a front.
const OF_FRONT: usize = 3;

/// Standard deviations, squared, m^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variances {
    /// By kind.
    pub building: [f64; KINDS],
    pub front: [f64; KINDS],
    pub piece: f64,
    /// Of the bending as a whole.
    pub bending: f64,
}

/// The estimate near a pose.
pub fn estimate(refiner: &PoseRefiner, pose: &Similarity) -> Estimate {
    let scene = refiner.scene;
    let limits = &scene.limits.uncertainty;
    let mut pose = *pose;
    for _ in 0..limits.rounds {
        let chart = refiner.assess(&[], &pose, 0.0).chart;
        let sample = sample(refiner, &pose, limits.gate_units * scene.gate_unit_m);
        let system = System::settled(refiner, &pose, &chart, &sample);
        let moved = chart.moved(&pose, &chart.step(&system.held(), scene.limits.refinement.most_sigma_m));
        if !moved.translation.iter().all(|v| v.is_finite()) || !scene.prior.reaches(&moved) {
            break;
        }
        pose = moved;
    }
    let chart = refiner.assess(&[], &pose, 0.0).chart;
    let sample = sample(refiner, &pose, limits.gate_units * scene.gate_unit_m);
    let mut system = System::settled(refiner, &pose, &chart, &sample);
    system.take_tails_in();
    let left_out = leave_out::by_building(&system);
    Estimate {
        city_from_level: pose,
        chart,
        information: left_out.widened(&system.held().full()),
        without: leave_out::by_front(&system).iter().map(|m| left_out.widened(m)).collect(),
        findings: SystematicErrors::of(&system),
    }
}

/// Normal equations by building and front, with the spreads and weights that make them.
pub(super) struct System<'a> {
    pub sample: &'a Observations,
    pub limits: &'a UncertaintyLimits,
    pub radius_m: f64,
    /// One row a piece: unknowns common to all, distance, building, front.
    rows: DMatrix<f64>,
    /// How many unknowns are common to all buildings.
    pub common: usize,
    /// What is known of these beforehand; the start for the pose.
    start: DMatrix<f64>,
    pub spreads: Variances,
    building_weights: Vec<f64>,
    front_weights: Vec<f64>,
    piece_weights: Vec<f64>,
    pub parts: Vec<BuildingSystem>,
    /// The unknowns common to all, and their covariance.
    pub found: DVector<f64>,
    pub covariance: DMatrix<f64>,
}

/// One building's share.
pub(super) struct BuildingSystem {
    /// Of all its fronts, before the building's own unknowns are taken out: common, distance, building.
    pub whole: DMatrix<f64>,
    pub building: Eliminated,
    pub fronts: Vec<Eliminated>,
    pub precision: f64,
}

impl<'a> System<'a> {
    fn new(
        sample: &'a Observations,
        chart: &Chart,
        places: &[Point3<f64>],
        start: &Matrix7,
        limits: &'a UncertaintyLimits,
    ) -> System<'a> {
        let bending = Bending::over(places, chart);
        let common = COMMON + bending.count();
        let mut known = DMatrix::zeros(common, common);
        known.view_mut((0, 0), (POSE, POSE)).copy_from(start);
        let of_spread = |sigma: f64| sigma * sigma;
        let first = Variances {
            building: [of_spread(limits.building_sigma_m); KINDS],
            front: [of_spread(limits.front_sigma_m); KINDS],
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
            spreads: first,
            building_weights: vec![1.0; sample.buildings.len()],
            front_weights: vec![1.0; sample.fronts.len()],
            piece_weights: vec![1.0; sample.pieces.len()],
            parts: Vec::new(),
            found: DVector::zeros(common),
            covariance: DMatrix::zeros(common, common),
        }
    }

    /// With unknowns and spreads estimated in turn.
    fn settled(refiner: &PoseRefiner<'a>, pose: &Similarity, chart: &Chart, sample: &'a Observations) -> System<'a> {
        let scene = refiner.scene;
        let places: Vec<Point3<f64>> =
            scene.level_cloud.sample_points.iter().map(|sample_point| pose.apply(&sample_point.position)).collect();
        let mut system =
            System::new(sample, chart, &places, &scene.prior.information(chart), &scene.limits.uncertainty);
        for _ in 0..system.limits.steps {
            system.solve();
            system.learn();
        }
        system.solve();
        system
    }

    /// Takes for a spread what Student's t scatters by, its tails included: more than its core by nu / (nu - 2).
    fn take_tails_in(&mut self) {
        let student_dof = self.limits.student_dof;
        let times = student_dof / (student_dof - 2.0);
        let Variances { building, front, piece, bending } = self.spreads;
        let wider = |spread: f64| spread * times;
        self.spreads =
            Variances { building: building.map(wider), front: front.map(wider), piece: wider(piece), bending };
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
        let fronts: Vec<Eliminated> = of_building
            .fronts
            .clone()
            .map(|front| {
                let precision = self.front_weights[front] / self.spreads.front[self.sample.fronts[front].kind as usize];
                eliminate(&self.equations_of_front(front), keep, precision)
            })
            .collect();
        let mut whole = DMatrix::zeros(keep, keep);
        fronts.iter().for_each(|front| whole += &front.rest);
        let precision = self.building_weights[building] / self.spreads.building[of_building.kind as usize];
        let building = eliminate(&whole, self.common + 1, precision);
        BuildingSystem { whole, building, fronts, precision }
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

    /// Variances and weights by what the unknowns turn out to be, and by how well these are known.
    fn learn(&mut self) {
        let (limits, sample) = (self.limits, self.sample);
        let of_kind = |count: usize, first_m: f64, worth: f64| Squares {
            sum: worth * first_m * first_m,
            count: worth,
            each: count as f64,
        };
        let mut of_buildings = [of_kind(OF_BUILDING, limits.building_sigma_m, limits.building_worth); KINDS];
        let mut of_fronts = [of_kind(OF_FRONT, limits.front_sigma_m, limits.front_worth); KINDS];
        let mut of_pieces = of_kind(1, limits.piece_sigma_m, limits.piece_worth);
        for (b, of_building) in sample.buildings.iter().enumerate() {
            let (building, covariance, squared) = self.building_found(b);
            let kind = of_building.kind as usize;
            self.building_weights[b] = weight(squared / self.spreads.building[kind], OF_BUILDING, limits.student_dof);
            of_buildings[kind].add(self.building_weights[b] * squared);
            for (k, front) in of_building.fronts.clone().enumerate() {
                let (offsets, squared) = self.front_found(b, k, &building, &covariance);
                let kind = sample.fronts[front].kind as usize;
                self.front_weights[front] = weight(squared / self.spreads.front[kind], OF_FRONT, limits.student_dof);
                of_fronts[kind].add(self.front_weights[front] * squared);
                for piece in sample.fronts[front].pieces.clone() {
                    let squared = self.learn_piece(piece, &building, &offsets);
                    of_pieces.add(squared);
                }
            }
        }
        let fields = self.common - COMMON;
        let mut of_bending =
            of_kind(1, limits.bending_share * self.radius_m / (fields.max(1) as f64).sqrt(), limits.bending_worth);
        (COMMON..self.common).for_each(|k| of_bending.add(self.found[k].powi(2) + self.covariance[(k, k)]));
        self.spreads = Variances {
            building: of_buildings.map(|squares| squares.mean()),
            front: of_fronts.map(|squares| squares.mean()),
            piece: of_pieces.mean(),
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
        self.piece_weights[piece] = weight(off_m * off_m / variance, 1, self.limits.student_dof);
        let share = self.spreads.piece / variance;
        self.piece_weights[piece] * (share * off_m).powi(2) + self.spreads.piece * (1.0 - share)
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

fn rows(sample: &Observations, chart: &Chart, bending: &Bending, common: usize) -> DMatrix<f64> {
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
                row[LIDS] = f64::from(u8::from(front.is_top));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::Scene;
    use crate::correspondence::test_scene::Made;
    use crate::geometry::Vector3;
    use crate::synthetic::{Block, CloudOptions, House, Offset, Survey};

    fn seen() -> CloudOptions {
        CloudOptions { points_per_roof: 100, outlier_share: 0.0, seed: 5, ..CloudOptions::default() }
    }

    fn town() -> Block {
        Block::town(2, 2, 3).with_ground(true)
    }

    fn found(made: &Made) -> (Estimate, Scene<'_>) {
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let estimate = estimate(&PoseRefiner::new(&scene), &made.truth(&scene));
        (estimate, scene)
    }

    /// One sigma of the whole pose, metres.
    fn sigma_m(estimate: &Estimate) -> f64 {
        estimate.information.try_inverse().unwrap().trace().sqrt()
    }

    /// The city has its houses changed, the survey saw them as they were.
    fn with_other_model(block: &Block, change: impl Fn(usize, &mut House)) -> Made {
        let survey = block.cloud(&seen());
        let mut known = block.clone();
        known.houses.iter_mut().enumerate().for_each(|(k, house)| change(k, house));
        Made::new(known, survey)
    }

    fn shifted(house: &mut House, by: [f64; 3]) {
        *house = house.clone().at(by);
    }

    #[test]
    fn an_exact_model_gives_a_pose_to_centimetres_and_says_so() {
        let made = Made::cloud(town(), &seen());
        let (estimate, scene) = found(&made);
        let error = made.error(&scene, &estimate.city_from_level);
        assert!(error.level_m < 0.02 && error.up_m < 0.02, "{error:?}");
        assert!(sigma_m(&estimate) < 0.15, "{}", sigma_m(&estimate));
        assert!(estimate.findings.buildings_m < 0.06, "{:?}", estimate.findings);
        assert!(estimate.findings.worth_telling(&made.limits.uncertainty).is_empty(), "{:?}", estimate.findings);
    }

    #[test]
    fn the_unit_of_the_reconstruction_changes_nothing() {
        let made = Made::cloud(town(), &seen());
        let mut survey = town().cloud(&seen());
        survey.sfm.points.iter_mut().for_each(|p| p.coords *= 7.0);
        survey.city_from_sfm.scale /= 7.0;
        let other = Made::new(town(), survey);
        let (one, two) = (sigma_m(&found(&made).0), sigma_m(&found(&other).0));
        assert!((one / two - 1.0).abs() < 1e-3, "{one} {two}");
    }

    #[test]
    fn a_house_that_stands_elsewhere_moves_the_pose_by_less_than_its_share() {
        let block = town();
        let made = with_other_model(&block, |k, house| {
            if k == 1 {
                shifted(house, [0.3, 0.3, 0.0]);
            }
        });
        let (estimate, scene) = found(&made);
        let level_m = made.error(&scene, &estimate.city_from_level).level_m;
        let share_m = 0.3 * 2f64.sqrt() / block.houses.len() as f64;
        assert!(level_m < share_m, "{level_m} {share_m}");
    }

    #[test]
    fn houses_that_stand_off_each_on_its_own_widen_the_sigmas_and_are_found() {
        let block = town();
        let exact = found(&with_other_model(&block, |_, _| ())).0;
        let made = with_other_model(&block, |k, house| shifted(house, off(k)));
        let (estimate, _) = found(&made);
        assert!(sigma_m(&estimate) > 1.3 * sigma_m(&exact), "{} {}", sigma_m(&estimate), sigma_m(&exact));
        assert!(estimate.findings.buildings_m > 0.07, "{:?}", estimate.findings);
    }

    #[test]
    fn walls_under_eaves_are_told_and_do_not_pull_the_scale() {
        let block = town();
        let made = with_other_model(&block, |_, house| {
            let corners = || house.faces.iter().flat_map(|face| &face.corners);
            let middle = corners().map(|c| c.coords).sum::<Vector3<f64>>() / corners().count() as f64;
            // A house is grown about its middle in plan: by some 0.3 m a wall.
            let reach = corners().map(|c| (c.coords - middle).xy().norm()).sum::<f64>() / corners().count() as f64;
            for corner in house.faces.iter_mut().flat_map(|face| &mut face.corners) {
                let arm = (corner.coords - middle).xy();
                corner.x += arm.x / reach * 0.4;
                corner.y += arm.y / reach * 0.4;
            }
        });
        let (estimate, scene) = found(&made);
        let found_m = estimate.findings.walls_inset_m;
        assert!((0.2..0.4).contains(&found_m), "{:?}", estimate.findings);
        let told = estimate.findings.worth_telling(&made.limits.uncertainty);
        assert!(told.iter().any(|text| text.contains("inside the model's")), "{told:?}");
        let scale_error = estimate.city_from_level.scale / made.truth(&scene).scale - 1.0;
        assert!(scale_error.abs() < 2e-3, "{scale_error}");
    }

    /// Where a model's houses stand off, each on its own.
    fn off(k: usize) -> [f64; 3] {
        let of = |k: usize| [0.2, -0.2, 0.1, -0.1][k % 4] * if k % 8 < 4 { 1.0 } else { -1.0 };
        [of(k), of(k / 2 + 1), 0.0]
    }

    #[test]
    fn half_of_the_points_give_nearly_the_same_sigmas_and_points_given_twice_the_same() {
        let sigma_of = |change: &dyn Fn(&mut Survey)| {
            let mut survey = town().cloud(&seen());
            change(&mut survey);
            let mut known = town();
            known.houses.iter_mut().enumerate().for_each(|(k, house)| shifted(house, off(k)));
            sigma_m(&found(&Made::new(known, survey)).0)
        };
        let whole = sigma_of(&|_| ());
        let half = sigma_of(&|survey| {
            let every_other = |count: usize| (0..count).map(|k| k % 2 == 0).collect::<Vec<_>>().into_iter();
            let mut keep = every_other(survey.sfm.points.len());
            survey.sfm.points.retain(|_| keep.next() == Some(true));
            let mut keep = every_other(survey.sfm.normals.len());
            survey.sfm.normals.retain(|_| keep.next() == Some(true));
            let mut keep = every_other(survey.face_of_point.len());
            survey.face_of_point.retain(|_| keep.next() == Some(true));
        });
        assert!((half / whole - 1.0).abs() < 0.25, "{half} {whole}");
        let twice = sigma_of(&|survey| {
            survey.sfm.points.extend_from_within(..);
            survey.sfm.normals.extend_from_within(..);
            survey.face_of_point.extend_from_within(..);
        });
        assert!((twice / whole - 1.0).abs() < 0.02, "{twice} {whole}");
    }

    #[test]
    fn a_given_scale_is_kept_to_the_bit_and_nothing_is_said_to_hold_it() {
        let made = Made::cloud(town(), &seen());
        let scene = made.scene(&Offset::default(), Motion::Rigid);
        let estimate = estimate(&PoseRefiner::new(&scene), &scene.prior.expected());
        assert_eq!(estimate.city_from_level.scale.to_bits(), 1f64.to_bits());
        assert!(estimate.information.column(6).norm() < 1e-6, "{}", estimate.information);
    }

    #[test]
    fn the_information_is_that_of_least_squares_with_the_dense_covariance() {
        let made = Made::four_houses();
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let (refiner, pose) = (PoseRefiner::new(&scene), made.truth(&scene));
        let chart = refiner.assess(&[], &pose, 0.0).chart;
        let sample = sample(&refiner, &pose, scene.gate_unit_m);
        let system = System::settled(&refiner, &pose, &chart, &sample);
        let (n, count) = (system.common, sample.pieces.len());
        let mut covariance = DMatrix::zeros(count, count);
        let known = system.known();
        let mut share = |pieces: &std::ops::Range<usize>, column: usize, variance: f64| {
            for i in pieces.clone() {
                for j in pieces.clone() {
                    covariance[(i, j)] += system.rows[(column, i)] * system.rows[(column, j)] * variance;
                }
            }
        };
        (POSE..n).for_each(|k| share(&(0..count), k, 1.0 / known[(k, k)]));
        for (b, building) in sample.buildings.iter().enumerate() {
            let fronts = &sample.fronts[building.fronts.clone()];
            let pieces = fronts[0].pieces.start..fronts[fronts.len() - 1].pieces.end;
            let variance = system.spreads.building[building.kind as usize] / system.building_weights[b];
            (0..OF_BUILDING).for_each(|k| share(&pieces, n + 1 + k, variance));
            for f in building.fronts.clone() {
                let front = &sample.fronts[f];
                let variance = system.spreads.front[front.kind as usize] / system.front_weights[f];
                (0..OF_FRONT).for_each(|k| share(&front.pieces, n + 1 + OF_BUILDING + k, variance));
            }
        }
        for i in 0..count {
            covariance[(i, i)] += system.variance_of_piece(i) / system.piece_weights[i];
        }
        let pose_rows = system.rows.rows(0, POSE).transpose();
        let expected = pose_rows.transpose() * inverse(covariance) * &pose_rows;
        let found = system.held().full();
        assert!((found - &expected).norm() < 1e-6 * expected.norm(), "{found} {expected}");
    }
}
