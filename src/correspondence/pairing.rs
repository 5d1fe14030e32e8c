//! Candidate pairs of patches and city planes, drawn so that a minimal sample agrees with the start and with itself.
//!
//! Question     which patch may lie on which plane of the city, given what the start says and the pairs already chosen?
//! Input        votes (patches in the level frame), city planes that can be seen, the start's sigmas
//! Output       minimal samples: rows for the solvers
//! Method       the first pair fixes the heading by its two azimuths. With the heading known, scale and translation enter every
//!              row linearly, so what is known of them is one Gaussian: the start at first, narrowed by each pair (a Kalman
//!              update). The next patch is one on which that Gaussian says least; its planes are those that face its way
//!              and lie within three sigmas of where the Gaussian expects it.
//! Assumptions  up is known within some degrees; city planes bound to a box each
//! Source       sequential gating of pairs: joint compatibility (Neira and Tardos 2001); samples over patch-plane pairs and then
//!              points inside them: Ramalingam et al. (ECCV 2010), section 5
//!
//! Frames: `level` is centred on the cloud, z up, in metres of the start; the city frame is its own local one.

use nalgebra::{Matrix4, SymmetricEigen, Vector4};

use super::votes::{LevelPatch, Votes};
use crate::geometry::{Plane, Point3, Start, Vector3};
use crate::planes::{CityPlanes, PlaneId};
use crate::robust::Random;
use crate::solvers::Row;

/// A plane of the city that a patch may lie on.
#[derive(Clone, Copy, Debug)]
struct Target {
    id: PlaneId,
    plane: Plane,
    /// Azimuth of the outward normal, radians; meaningless for level planes.
    azimuth: f64,
    low: Point3<f64>,
    high: Point3<f64>,
    weight: f64,
}

/// A patch on a plane of the city.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    pub patch: u32,
    pub plane: PlaneId,
    /// The plane as the patch sees it: its normal on the patch's side.
    pub target: Plane,
}

/// A minimal sample: pairs, and what completes them where they leave a direction open.
#[derive(Clone, Debug)]
pub struct Sample {
    pub pairs: Vec<Pair>,
    /// A rough heading, by the azimuths of the first pair.
    pub heading_rad: f64,
    /// Rows for what the pairs leave open (a height that no floor fixes), drawn from what the start says of it.
    pub completion: Vec<Row>,
}

/// Draws samples.
pub struct Pairing<'a> {
    votes: &'a Votes,
    start: Start,
    /// Metres of the start per metre of the city, where it is held.
    scale: Option<f64>,
    /// Planes with an azimuth, sorted by it.
    turned_targets: Vec<Target>,
    /// Level planes.
    level_targets: Vec<Target>,
    /// Rising sums of the patches' weights: all, and those with an azimuth.
    all: Vec<f64>,
    turned: Vec<f64>,
}

/// Tilts of a patch and its plane differ by no more than this: patch normals are good to some degrees, and roofs of
/// neighbouring pitch are told apart by the score.
const SAME_TILT_RAD: f64 = 0.12;
/// ... and azimuths, once the heading is fixed by another pair of the same uncertainty.
const SAME_AZIMUTH_RAD: f64 = 0.12;
/// A normal nearer to up than this has no azimuth worth using.
const LEAST_SIN_FOR_AZIMUTH: f64 = 0.3;
/// A row's own uncertainty: error of the model and of the patch's centre, metres.
const ROW_SIGMA_M: f64 = 0.3;
/// ... and what an uncertain heading adds, per metre of distance from the middle of the cloud.
const ROW_SIGMA_PER_M: f64 = 0.015;
/// A patch whose row is known to within this says nothing new, metres.
const LEARNED_M: f64 = 1.0;
/// Patches compared when the next one is chosen.
const TENDER: usize = 6;
/// An open direction that is all scale and hardly any translation cannot be written as a plane.
const SMALLEST_ACROSS: f64 = 1e-3;
/// Planes smaller than this are not offered as pairs (they still count in every score): a patch of that size has no firm normal.
const SMALLEST_TARGET_M2: f64 = 1.0;

impl<'a> Pairing<'a> {
    /// `seen` tells whether any of a plane can be seen; `scale` is relative to the start, free where `None`.
    pub fn new(
        votes: &'a Votes,
        planes: &CityPlanes,
        start: &Start,
        scale: Option<f64>,
        seen: impl Fn(PlaneId) -> bool,
    ) -> Pairing<'a> {
        let target = |(i, p): (usize, &crate::planes::CityPlane)| {
            let id = PlaneId(i as u32);
            (p.area_m2 >= SMALLEST_TARGET_M2 && seen(id)).then(|| Target {
                id,
                plane: p.plane,
                azimuth: azimuth(&p.plane.normal),
                low: p.low,
                high: p.high,
                weight: p.area_m2.sqrt(),
            })
        };
        let targets = planes.planes.iter().enumerate().filter_map(target);
        let (mut turned_targets, level_targets): (Vec<Target>, Vec<Target>) =
            targets.partition(|t| has_azimuth(&t.plane.normal));
        turned_targets.sort_by(|a, b| a.azimuth.total_cmp(&b.azimuth).then(a.id.cmp(&b.id)));
        let cumulative = |take: fn(&LevelPatch) -> bool| -> Vec<f64> {
            let weight = |p: &LevelPatch| if take(p) { p.weight } else { 0.0 };
            votes
                .patches
                .iter()
                .scan(0.0, |sum, p| {
                    *sum += weight(p);
                    Some(*sum)
                })
                .collect()
        };
        let all = cumulative(|_| true);
        let turned = cumulative(|p| has_azimuth(&p.normal));
        Pairing { votes, start: *start, scale, turned_targets, level_targets, all, turned }
    }

    /// The scale relative to the start, where it is held.
    pub fn scale(&self) -> Option<f64> {
        self.scale
    }

    /// A sample, or `None` where the drawn patch fits nothing.
    pub fn draw(&self, random: &mut Random) -> Option<Sample> {
        let first = random.weighted(&self.turned)?;
        let mut state = State::new(&self.start, self.scale, &self.votes.center_in_city);
        let needed = if self.scale.is_some() { 3 } else { 4 };
        let (heading_rad, pair) = self.first_pair(first, &state, random)?;
        state.heading_rad = heading_rad;
        let mut pairs = Vec::with_capacity(needed);
        state.learn(&self.votes.patches[first].center, &pair.target);
        pairs.push(pair);
        while pairs.len() < needed {
            let Some(patch) = self.least_known(&state, random) else { break };
            let pair = self.next_pair(patch, &state, random)?;
            state.learn(&self.votes.patches[patch].center, &pair.target);
            pairs.push(pair);
        }
        let completion = state.completion(needed - pairs.len(), random)?;
        Some(Sample { pairs, heading_rad, completion })
    }

    /// A plane for the first patch, and the heading that turns the patch into it.
    fn first_pair(&self, patch: usize, state: &State, random: &mut Random) -> Option<(f64, Pair)> {
        let p = &self.votes.patches[patch];
        let reach = 3.0 * self.start.heading_sigma_rad;
        let mut choice = Choice::default();
        for flip in [1.0, -1.0].into_iter().take(if p.sided { 1 } else { 2 }) {
            let normal = p.normal * flip;
            let own = azimuth(&normal);
            for t in self.facing(own, reach) {
                if !same_tilt(&normal, t) {
                    continue;
                }
                let heading = wrapped(t.azimuth - own);
                let turned = State { heading_rad: heading, ..*state };
                if let Some(likelihood) = turned.likelihood(&p.center, t) {
                    choice.offer(
                        likelihood,
                        (heading, Pair { patch: patch as u32, plane: t.id, target: t.plane }),
                        random,
                    );
                }
            }
        }
        choice.taken
    }

    /// Of a few patches drawn by weight, the one whose place is known least; `None` when all are known well.
    fn least_known(&self, state: &State, random: &mut Random) -> Option<usize> {
        let mut best = None;
        let mut most = LEARNED_M * LEARNED_M;
        for _ in 0..TENDER {
            let i = random.weighted(&self.all)?;
            let p = &self.votes.patches[i];
            let variance = state.variance(&p.center, &(state.turn(&p.normal)));
            if variance > most {
                most = variance;
                best = Some(i);
            }
        }
        best
    }

    /// Planes whose azimuth is within `reach` of `azimuth`.
    fn facing(&self, azimuth: f64, reach: f64) -> impl Iterator<Item = &Target> {
        let targets = &self.turned_targets;
        let between = |low: f64, high: f64| {
            let first = targets.partition_point(|t| t.azimuth < low);
            &targets[first..targets.partition_point(|t| t.azimuth <= high).max(first)]
        };
        let (low, high) = (wrapped(azimuth) - reach, wrapped(azimuth) + reach);
        let turn = std::f64::consts::TAU;
        let all = reach >= std::f64::consts::PI;
        let main = if all { &targets[..] } else { between(low, high) };
        let over = if all { &[][..] } else { between(low + turn, high + turn) };
        let under = if all { &[][..] } else { between(low - turn, high - turn) };
        under.iter().chain(main).chain(over)
    }

    fn next_pair(&self, patch: usize, state: &State, random: &mut Random) -> Option<Pair> {
        let p = &self.votes.patches[patch];
        let mut choice = Choice::default();
        for flip in [1.0, -1.0].into_iter().take(if p.sided { 1 } else { 2 }) {
            let normal = state.turn(&(p.normal * flip));
            let level: &[Target] = if has_azimuth(&normal) { &[] } else { &self.level_targets };
            let turned = self.facing(azimuth(&normal), if level.is_empty() { SAME_AZIMUTH_RAD } else { 0.0 });
            for t in turned.chain(level) {
                if !same_tilt(&normal, t) {
                    continue;
                }
                if let Some(likelihood) = state.likelihood(&p.center, t) {
                    choice.offer(likelihood, Pair { patch: patch as u32, plane: t.id, target: t.plane }, random);
                }
            }
        }
        choice.taken
    }
}

/// What is known of scale and translation, given the heading.
#[derive(Clone, Copy)]
struct State {
    heading_rad: f64,
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
}

impl State {
    fn new(start: &Start, scale: Option<f64>, center: &Point3<f64>) -> State {
        let (p, h) = (start.position_sigma_m, start.height_sigma_m);
        let scale_sigma = if scale.is_some() { 0.0 } else { start.log_scale_sigma };
        let variances = Vector4::new(scale_sigma, p, p, h).map(|s| s * s);
        State {
            heading_rad: 0.0,

            mean: Vector4::new(scale.unwrap_or(1.0), center.x, center.y, center.z),
            covariance: Matrix4::from_diagonal(&variances),
        }
    }

    /// Level frame to city directions.
    fn turn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = self.heading_rad.sin_cos();
        Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    }

    /// Coefficients of a row: `row . (scale, translation) + offset = 0`.
    fn row(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> Vector4<f64> {
        Vector4::new(normal.dot(&self.turn(&point.coords)), normal.x, normal.y, normal.z)
    }

    fn variance(&self, point: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let row = self.row(point, normal);
        row.dot(&(self.covariance * row))
    }

    /// How likely a patch at `point` lies on the target, times the target's weight; `None` beyond three sigmas.
    fn likelihood(&self, point: &Point3<f64>, target: &Target) -> Option<f64> {
        let row = self.row(point, &target.plane.normal);
        let residual = row.dot(&self.mean) + target.plane.offset;
        let variance = row.dot(&(self.covariance * row)) + row_variance(point);
        let miss_sq = residual * residual / variance;
        if miss_sq > 9.0 {
            return None;
        }
        // The patch's centre must be able to lie within the target's box.
        let expected = self.turn(&point.coords) * self.mean[0] + self.mean.fixed_rows::<3>(1);
        let arm = self.turn(&point.coords);
        for k in 0..3 {
            let spread = self.covariance[(0, 0)] * arm[k] * arm[k]
                + 2.0 * self.covariance[(0, k + 1)] * arm[k]
                + self.covariance[(k + 1, k + 1)];
            let slack = 3.0 * (spread.max(0.0) + row_variance(point)).sqrt();
            if expected[k] < target.low[k] - slack || expected[k] > target.high[k] + slack {
                return None;
            }
        }
        Some(target.weight * (-0.5 * miss_sq).exp())
    }

    /// Rows for the `missing` least known combinations of scale and translation, each at a value drawn evenly from the three
    /// sigmas that are left of it; `None` where the scale alone is open, which no plane can fix.
    fn completion(&self, missing: usize, random: &mut Random) -> Option<Vec<Row>> {
        let eigen = SymmetricEigen::new(self.covariance);
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let row = |k: &usize| {
            let v = eigen.eigenvectors.column(*k).into_owned();
            let sigma = eigen.eigenvalues[*k].max(0.0).sqrt();
            let value = v.dot(&self.mean) + sigma * 3.0 * (2.0 * random.unit() - 1.0);
            // v . (scale, translation) = value is the row of a point p with n . R p = v[0] / |n| on the plane across n.
            let across = v.fixed_rows::<3>(1).into_owned();
            let length = across.norm();
            let normal = across.try_normalize(SMALLEST_ACROSS)?;
            Some(Row { point: self.unturn(&normal) * (v[0] / length), normal, offset: -value / length })
        };
        order[..missing.min(4)].iter().map(row).collect()
    }

    /// City to level directions.
    fn unturn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        State { heading_rad: -self.heading_rad, ..*self }.turn(v)
    }

    /// Kalman update with the row of a pair.
    fn learn(&mut self, point: &Point3<f64>, target: &Plane) {
        let row = self.row(point, &target.normal);
        let gain = self.covariance * row;
        let variance = row.dot(&gain) + row_variance(point);
        let residual = row.dot(&self.mean) + target.offset;
        self.mean -= gain * (residual / variance);
        self.covariance -= gain * gain.transpose() / variance;
    }
}

fn row_variance(point: &Point3<f64>) -> f64 {
    ROW_SIGMA_M * ROW_SIGMA_M + ROW_SIGMA_PER_M * ROW_SIGMA_PER_M * point.coords.xy().norm_squared()
}

/// One of a stream of offers, drawn with probability proportional to their weights.
struct Choice<T> {
    total: f64,
    taken: Option<T>,
}

impl<T> Default for Choice<T> {
    fn default() -> Self {
        Choice { total: 0.0, taken: None }
    }
}

impl<T> Choice<T> {
    fn offer(&mut self, weight: f64, what: T, random: &mut Random) {
        self.total += weight;
        if random.unit() * self.total < weight {
            self.taken = Some(what);
        }
    }
}

fn azimuth(normal: &Vector3<f64>) -> f64 {
    normal.y.atan2(normal.x)
}

fn has_azimuth(normal: &Vector3<f64>) -> bool {
    normal.xy().norm() > LEAST_SIN_FOR_AZIMUTH
}

fn same_tilt(normal: &Vector3<f64>, target: &Target) -> bool {
    (normal.z.clamp(-1.0, 1.0).asin() - target.plane.normal.z.clamp(-1.0, 1.0).asin()).abs() < SAME_TILT_RAD
}

/// To (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}
