//! Candidate pairs of patches and city planes, drawn so that a minimal sample agrees with the start and with itself.
//!
//! Question     which patch may lie on which plane of the city, given what the start says and the pairs already chosen?
//! Input        votes (patches in the level frame), city planes that can be seen, the start's sigmas
//! Output       minimal samples: rows for the solvers
//! Method       with known up the first pair fixes the rotation, by its two azimuths; with free up the first two pairs do, by
//!              their four normals. With the rotation known, scale and translation enter every row linearly, so what is known
//!              of them is one Gaussian: the start at first, narrowed by each pair (a Kalman update). The next patch is one on
//!              which that Gaussian says least; its planes are those that face its way and lie within three sigmas of where
//!              the Gaussian expects it. Each draw tells the chance that it took the right plane: offers have their likelihoods
//!              for weights, so an offer with the share w of all is right with chance w and taken as often: sum of w^2.
//! Assumptions  city planes bound to a box each
//! Source       sequential gating of pairs: joint compatibility (Neira and Tardos 2001); samples over patch-plane pairs and then
//!              points inside them: Ramalingam et al. (ECCV 2010), section 5
//!
//! Frames: `level` is centred on the cloud, z up, in metres of the start; the city frame is its own local one.

use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector4};

use super::votes::{LevelPatch, Votes};
use crate::geometry::{Plane, Point3, Rotation3, Start, Vector3};
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
    /// Of the outward normal above the horizon, radians.
    elevation: f64,
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
    /// The patch's normal in the level frame, on the side from which it is meant.
    pub normal: Vector3<f64>,
}

/// A minimal sample: pairs, and what completes them where they leave a direction open.
#[derive(Clone, Debug)]
pub struct Sample {
    pub pairs: Vec<Pair>,
    /// Rows for what the pairs leave open (a height that no floor fixes), drawn from what the start says of it.
    pub completion: Vec<Row>,
    /// The chance that all of it is right, as far as its patches lie on the city at all.
    pub chance: f64,
}

/// Draws samples.
pub struct Pairing<'a> {
    votes: &'a Votes,
    start: Start,
    /// Metres of the start per metre of the city, where it is held.
    scale: Option<f64>,
    /// Whether the level frame's z is up; else the tilt is as free as the start says.
    up_is_known: bool,
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
/// Two patches and their two planes stand at the same angle, by as much: cosines, whose difference is at most the angles'.
const SAME_COS: f64 = 0.17;
/// Two normals nearer to parallel than this do not fix a rotation.
const LEAST_SIN_BETWEEN: f64 = 0.3;
/// How far the start is believed.
const REACH_SIGMAS: f64 = 3.0;
/// A row's own uncertainty: error of the model and of the patch's centre, metres.
const ROW_SIGMA_M: f64 = 0.3;
/// ... and what an uncertain rotation adds, per metre of distance from the middle of the cloud.
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
    /// `seen` tells whether any of a plane can be seen; `scale` is relative to the start, free where `None`; `up_is_known` where
    /// the level frame's z may be taken for up.
    pub fn new(
        votes: &'a Votes,
        planes: &CityPlanes,
        start: &Start,
        scale: Option<f64>,
        up_is_known: bool,
        seen: impl Fn(PlaneId) -> bool,
    ) -> Pairing<'a> {
        let target = |(i, p): (usize, &crate::planes::CityPlane)| {
            let id = PlaneId(i as u32);
            (p.area_m2 >= SMALLEST_TARGET_M2 && seen(id)).then(|| Target {
                id,
                plane: p.plane,
                azimuth: azimuth(&p.plane.normal),
                elevation: elevation(&p.plane.normal),
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
        Pairing { votes, start: *start, scale, up_is_known, turned_targets, level_targets, all, turned }
    }

    /// The scale relative to the start, where it is held.
    pub fn scale(&self) -> Option<f64> {
        self.scale
    }

    /// Whether the level frame's z may be taken for up.
    pub fn up_is_known(&self) -> bool {
        self.up_is_known
    }

    /// A sample on so many planes, or `None` where a drawn patch fits nothing.
    pub fn draw(&self, planes: usize, random: &mut Random) -> Option<Sample> {
        let mut draft = if self.up_is_known { self.begin_level(random)? } else { self.begin_leaning(random)? };
        // Scale and translation: with the rotation fixed, each pair settles one of them.
        let unknowns = if self.scale.is_some() { 3 } else { 4 };
        while draft.pairs.len() < unknowns {
            let Some(patch) = self.least_known(&draft.state, random) else { break };
            let pair = self.next_pair(patch, &draft.state, random)?;
            draft.take(self.votes, pair);
        }
        let (completion, chance) = draft.state.completion(unknowns.saturating_sub(draft.pairs.len()), random)?;
        // Planes beyond those hold the rotation.
        while draft.pairs.len() + completion.len() < planes {
            let patch = random.weighted(&self.all)?;
            if draft.pairs.iter().any(|pair| pair.patch as usize == patch) {
                return None;
            }
            let pair = self.next_pair(patch, &draft.state, random)?;
            draft.take(self.votes, pair);
        }
        Some(Sample { pairs: draft.pairs, completion, chance: draft.chance * chance })
    }

    /// Known up: one pair, and the heading that turns its patch into its plane.
    fn begin_level(&self, random: &mut Random) -> Option<Draft> {
        let first = random.weighted(&self.turned)?;
        let Drawn { what: (heading_rad, pair), chance } = self.turned_pair(first, random)?;
        let mut draft = Draft::new(self.state(about_up(heading_rad)));
        draft.take(self.votes, Drawn { what: pair, chance });
        Some(draft)
    }

    /// Free up: two pairs, and the rotation that lays both patches along their planes.
    fn begin_leaning(&self, random: &mut Random) -> Option<Draft> {
        let [first, second] = [random.weighted(&self.all)?, random.weighted(&self.all)?];
        let normal = |i: usize| &self.votes.patches[i].normal;
        if normal(first).cross(normal(second)).norm() < LEAST_SIN_BETWEEN {
            return None;
        }
        let pair = self.leaning_pair(first, random)?;
        let Drawn { what: (rotation, other), chance } = self.second_pair(&pair.what, second, random)?;
        let mut draft = Draft::new(self.state(rotation));
        draft.take(self.votes, pair);
        draft.take(self.votes, Drawn { what: other, chance });
        Some(draft)
    }

    fn state(&self, rotation: Matrix3<f64>) -> State {
        State::new(&self.start, self.scale, &self.votes.center_in_city, rotation, !self.up_is_known)
    }

    /// A plane for the first patch under known up, and the heading that turns the patch into it.
    fn turned_pair(&self, patch: usize, random: &mut Random) -> Option<Drawn<(f64, Pair)>> {
        let p = &self.votes.patches[patch];
        let reach = REACH_SIGMAS * self.start.heading_sigma_rad;
        let state = self.state(Matrix3::identity());
        let mut choice = Choice::default();
        for normal in sides(p) {
            let own = azimuth(&normal);
            for t in self.facing(own, reach) {
                if !same_tilt(&normal, t) {
                    continue;
                }
                let heading = wrapped(t.azimuth - own);
                let turned = State { rotation: about_up(heading), ..state };
                if let Some(likelihood) = turned.likelihood(&p.center, t) {
                    choice.offer(likelihood, (heading, t.with(patch, normal)), random);
                }
            }
        }
        choice.drawn()
    }

    /// A plane for the first patch under free up. Its normal is laid onto the plane's; what stays open is a spin about it,
    /// which moves the patch within its plane and not across.
    fn leaning_pair(&self, patch: usize, random: &mut Random) -> Option<Drawn<Pair>> {
        let p = &self.votes.patches[patch];
        let state = self.state(Matrix3::identity());
        let mut choice = Choice::default();
        for normal in sides(p) {
            let turn_onto = self.turning(&normal);
            for t in self.targets() {
                let Some(rotation) = turn_onto(t) else { continue };
                let leaning = State { rotation, spin: self.spin_sigma_about(&t.plane.normal), ..state };
                if let Some(likelihood) = leaning.likelihood(&p.center, t) {
                    choice.offer(likelihood, t.with(patch, normal), random);
                }
            }
        }
        choice.drawn()
    }

    /// A plane for the second patch under free up, and the rotation that lays both normals along their planes'.
    fn second_pair(&self, first: &Pair, patch: usize, random: &mut Random) -> Option<Drawn<(Matrix3<f64>, Pair)>> {
        let p = &self.votes.patches[patch];
        let state = self.state(Matrix3::identity());
        let first_center = &self.votes.patches[first.patch as usize].center;
        let mut choice = Choice::default();
        for normal in sides(p) {
            let cos = first.normal.dot(&normal);
            let Some(level_axes) = bisectors(&first.normal, &normal) else { continue };
            for t in self.targets() {
                if (first.target.normal.dot(&t.plane.normal) - cos).abs() > SAME_COS {
                    continue;
                }
                let Some(city_axes) = bisectors(&first.target.normal, &t.plane.normal) else { continue };
                let rotation = city_axes * level_axes.transpose();
                if !self.allows(&rotation) {
                    continue;
                }
                let mut turned = State { rotation, ..state };
                turned.learn(first_center, &first.target);
                if let Some(likelihood) = turned.likelihood(&p.center, t) {
                    choice.offer(likelihood, (rotation, t.with(patch, normal)), random);
                }
            }
        }
        choice.drawn()
    }

    fn targets(&self) -> impl Iterator<Item = &Target> {
        self.turned_targets.iter().chain(&self.level_targets)
    }

    /// The rotation that lays a normal onto a target's: a heading first, as far as both have an azimuth, then the least tilt;
    /// `None` where the start does not reach so far.
    fn turning(&self, normal: &Vector3<f64>) -> impl Fn(&Target) -> Option<Matrix3<f64>> {
        let (normal, has, own) = (*normal, has_azimuth(normal), [azimuth(normal), elevation(normal)]);
        let tilt = REACH_SIGMAS * self.start.tilt_sigma_rad;
        // A tilt turns azimuths too: by its tangent's share on slopes, to second order on walls.
        let slope = normal.z.abs() / normal.xy().norm().max(LEAST_SIN_FOR_AZIMUTH);
        let most_heading = REACH_SIGMAS * self.start.heading_sigma_rad + tilt * slope + 0.5 * tilt * tilt;
        let most_tilt = tilt + SAME_TILT_RAD;
        let least_cos = most_tilt.min(std::f64::consts::PI).cos();
        move |t| {
            let both_turned = has && has_azimuth(&t.plane.normal);
            let heading = if both_turned { wrapped(t.azimuth - own[0]) } else { 0.0 };
            if heading.abs() > most_heading || (t.elevation - own[1]).abs() > most_tilt {
                return None;
            }
            let upright = about_up(heading);
            let turned = upright * normal;
            let within = turned.dot(&t.plane.normal) >= least_cos;
            let leaning = within.then(|| Rotation3::rotation_between(&turned, &t.plane.normal))??;
            Some(leaning.into_inner() * upright)
        }
    }

    /// How far the start lets a scene spin about a direction of the city: heading about up, tilt about level axes.
    fn spin_sigma_about(&self, axis: &Vector3<f64>) -> Vector3<f64> {
        let [heading, tilt] = [self.start.heading_sigma_rad, self.start.tilt_sigma_rad];
        axis * (axis.z * heading).hypot(axis.xy().norm() * tilt)
    }

    /// Whether the start reaches a rotation, with the slack of patch normals.
    fn allows(&self, r: &Matrix3<f64>) -> bool {
        let most = |sigma: f64, slack: f64| (REACH_SIGMAS * sigma + slack).min(std::f64::consts::PI);
        let heading = || (r[(1, 0)] - r[(0, 1)]).atan2(r[(0, 0)] + r[(1, 1)]).abs();
        r[(2, 2)] >= most(self.start.tilt_sigma_rad, SAME_TILT_RAD).cos()
            && heading() <= most(self.start.heading_sigma_rad, SAME_AZIMUTH_RAD)
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

    fn next_pair(&self, patch: usize, state: &State, random: &mut Random) -> Option<Drawn<Pair>> {
        let p = &self.votes.patches[patch];
        let mut choice = Choice::default();
        for side in sides(p) {
            let normal = state.turn(&side);
            let level: &[Target] = if has_azimuth(&normal) { &[] } else { &self.level_targets };
            let turned = self.facing(azimuth(&normal), if level.is_empty() { SAME_AZIMUTH_RAD } else { 0.0 });
            for t in turned.chain(level) {
                if !same_tilt(&normal, t) {
                    continue;
                }
                if let Some(likelihood) = state.likelihood(&p.center, t) {
                    choice.offer(likelihood, t.with(patch, side), random);
                }
            }
        }
        choice.drawn()
    }
}

impl Target {
    fn with(&self, patch: usize, normal: Vector3<f64>) -> Pair {
        Pair { patch: patch as u32, plane: self.id, target: self.plane, normal }
    }
}

/// A sample on its way.
struct Draft {
    state: State,
    pairs: Vec<Pair>,
    chance: f64,
}

impl Draft {
    fn new(state: State) -> Draft {
        Draft { state, pairs: Vec::with_capacity(4), chance: 1.0 }
    }

    fn take(&mut self, votes: &Votes, drawn: Drawn<Pair>) {
        self.state.learn(&votes.patches[drawn.what.patch as usize].center, &drawn.what.target);
        self.chance *= drawn.chance;
        self.pairs.push(drawn.what);
    }
}

/// What is known of scale and translation, given the rotation.
#[derive(Clone, Copy)]
struct State {
    /// Level frame to city directions.
    rotation: Matrix3<f64>,
    /// Whether it may be off about level axes too, and not only about up.
    leans: bool,
    /// A turn that is wholly open yet: its axis, with one sigma for length, radians.
    spin: Vector3<f64>,
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
}

impl State {
    fn new(start: &Start, scale: Option<f64>, center: &Point3<f64>, rotation: Matrix3<f64>, leans: bool) -> State {
        let (p, h) = (start.position_sigma_m, start.height_sigma_m);
        let scale_sigma = if scale.is_some() { 0.0 } else { start.log_scale_sigma };
        let variances = Vector4::new(scale_sigma, p, p, h).map(|s| s * s);
        State {
            rotation,
            leans,
            spin: Vector3::zeros(),
            mean: Vector4::new(scale.unwrap_or(1.0), center.x, center.y, center.z),
            covariance: Matrix4::from_diagonal(&variances),
        }
    }

    /// Level frame to city directions.
    fn turn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * v
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
        let variance = row.dot(&(self.covariance * row)) + self.row_variance(point);
        let miss_sq = residual * residual / variance;
        if miss_sq > 9.0 {
            return None;
        }
        // The patch's centre must be able to lie within the target's box.
        let expected = self.turn(&point.coords) * self.mean[0] + self.mean.fixed_rows::<3>(1);
        let arm = self.turn(&point.coords);
        let spun = self.spin.cross(&arm);
        for k in 0..3 {
            let spread = self.covariance[(0, 0)] * arm[k] * arm[k]
                + 2.0 * self.covariance[(0, k + 1)] * arm[k]
                + self.covariance[(k + 1, k + 1)];
            let slack = 3.0 * (spread.max(0.0) + spun[k] * spun[k] + self.row_variance(point)).sqrt();
            if expected[k] < target.low[k] - slack || expected[k] > target.high[k] + slack {
                return None;
            }
        }
        Some(target.weight * (-0.5 * miss_sq).exp())
    }

    /// Rows for the `missing` least known combinations of scale and translation, each at a value drawn evenly from the three
    /// sigmas that are left of it, and the chance that this meets the truth; `None` where the scale alone is open, which no plane
    /// can fix.
    fn completion(&self, missing: usize, random: &mut Random) -> Option<(Vec<Row>, f64)> {
        let eigen = SymmetricEigen::new(self.covariance);
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let mut chance = 1.0;
        let mut row = |k: &usize| {
            let v = eigen.eigenvectors.column(*k).into_owned();
            let sigma = eigen.eigenvalues[*k].max(0.0).sqrt();
            let value = v.dot(&self.mean) + sigma * 3.0 * (2.0 * random.unit() - 1.0);
            // v . (scale, translation) = value is the row of a point p with n . R p = v[0] / |n| on the plane across n.
            let across = v.fixed_rows::<3>(1).into_owned();
            let length = across.norm();
            let normal = across.try_normalize(SMALLEST_ACROSS)?;
            chance *= (LEARNED_M / (3.0 * sigma)).min(1.0);
            Some(Row { point: self.unturn(&normal) * (v[0] / length), normal, offset: -value / length })
        };
        let rows: Option<Vec<Row>> = order[..missing.min(4)].iter().map(&mut row).collect();
        rows.map(|rows| (rows, chance))
    }

    /// City to level directions.
    fn unturn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(v)
    }

    /// What a row may be off besides scale and translation.
    fn row_variance(&self, point: &Point3<f64>) -> f64 {
        let arm_sq = if self.leans { point.coords.norm_squared() } else { point.coords.xy().norm_squared() };
        ROW_SIGMA_M * ROW_SIGMA_M + ROW_SIGMA_PER_M * ROW_SIGMA_PER_M * arm_sq
    }

    /// Kalman update with the row of a pair.
    fn learn(&mut self, point: &Point3<f64>, target: &Plane) {
        let row = self.row(point, &target.normal);
        let gain = self.covariance * row;
        let variance = row.dot(&gain) + self.row_variance(point);
        let residual = row.dot(&self.mean) + target.offset;
        self.mean -= gain * (residual / variance);
        self.covariance -= gain * gain.transpose() / variance;
    }
}

/// One of a stream of offers, drawn with probability proportional to their weights.
struct Choice<T> {
    total: f64,
    total_of_squares: f64,
    taken: Option<T>,
}

/// What was drawn, and the chance that it is the right offer.
struct Drawn<T> {
    what: T,
    chance: f64,
}

impl<T> Default for Choice<T> {
    fn default() -> Self {
        Choice { total: 0.0, total_of_squares: 0.0, taken: None }
    }
}

impl<T> Choice<T> {
    fn offer(&mut self, weight: f64, what: T, random: &mut Random) {
        self.total += weight;
        self.total_of_squares += weight * weight;
        if random.unit() * self.total < weight {
            self.taken = Some(what);
        }
    }

    fn drawn(self) -> Option<Drawn<T>> {
        let chance = self.total_of_squares / (self.total * self.total);
        self.taken.map(|what| Drawn { what, chance })
    }
}

/// A patch's normal, and its opposite where no camera tells the side.
fn sides(patch: &LevelPatch) -> impl Iterator<Item = Vector3<f64>> + use<> {
    let normal = patch.normal;
    [1.0, -1.0].into_iter().take(if patch.sided { 1 } else { 2 }).map(move |side| normal * side)
}

/// The turn by a heading.
fn about_up(heading_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = heading_rad.sin_cos();
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// Sum and difference of two unit vectors, and what stands across both: axes at right angles. Laying such axes onto each other
/// lays one pair of vectors onto another and divides evenly what their angles differ.
fn bisectors(a: &Vector3<f64>, b: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let (sum, difference) = ((a + b).try_normalize(SMALLEST_ACROSS)?, (a - b).try_normalize(SMALLEST_ACROSS)?);
    Some(Matrix3::from_columns(&[sum, difference, sum.cross(&difference)]))
}

fn azimuth(normal: &Vector3<f64>) -> f64 {
    normal.y.atan2(normal.x)
}

fn elevation(normal: &Vector3<f64>) -> f64 {
    normal.z.clamp(-1.0, 1.0).asin()
}

fn has_azimuth(normal: &Vector3<f64>) -> bool {
    normal.xy().norm() > LEAST_SIN_FOR_AZIMUTH
}

fn same_tilt(normal: &Vector3<f64>, target: &Target) -> bool {
    (elevation(normal) - target.elevation).abs() < SAME_TILT_RAD
}

/// To (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisectors_lay_one_pair_of_normals_onto_another() {
        let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0).into_inner();
        let (a, b) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(0.0, 1.0, 0.0));
        let found = bisectors(&(turn * a), &(turn * b)).unwrap() * bisectors(&a, &b).unwrap().transpose();
        assert!((found - turn).norm() < 1e-12 && (found.determinant() - 1.0).abs() < 1e-12);
        assert!(bisectors(&a, &a).is_none() && bisectors(&a, &-a).is_none());
    }

    #[test]
    fn the_chance_of_a_draw_is_that_of_taking_the_right_offer() {
        let drawn = |weights: &[f64]| {
            let mut choice = Choice::default();
            let mut random = Random::stream(1, 0);
            weights.iter().for_each(|w| choice.offer(*w, *w, &mut random));
            choice.drawn().map(|drawn| drawn.chance)
        };
        assert_eq!(drawn(&[]), None);
        assert_eq!(drawn(&[0.3]), Some(1.0));
        // Two offers alike: right every other time. Three quarters and a quarter: 9/16 + 1/16.
        assert_eq!(drawn(&[2.0, 2.0]), Some(0.5));
        assert_eq!(drawn(&[3.0, 1.0]), Some(0.625));
    }

    #[test]
    fn an_open_spin_moves_a_patch_within_its_plane_and_not_across() {
        let start = Start::with_default_sigmas(crate::geometry::Similarity::identity());
        let state = State::new(&start, None, &Point3::origin(), Matrix3::identity(), true);
        let spinning = State { spin: Vector3::x() * 0.5, ..state };
        let place = Point3::new(5.0, 40.0, 0.0);
        let wall = |low: f64, offset: f64| Target {
            id: PlaneId(0),
            plane: Plane { normal: Vector3::x(), offset },
            azimuth: 0.0,
            elevation: 0.0,
            low: Point3::new(5.0, 30.0, low),
            high: Point3::new(5.0, 50.0, low + 5.0),
            weight: 1.0,
        };
        // The wall stands 45 m higher: out of reach, but for a spin of some sigmas about the wall's own normal.
        assert!(state.likelihood(&place, &wall(0.0, -5.0)).is_some());
        assert!(state.likelihood(&place, &wall(45.0, -5.0)).is_none());
        assert_eq!(spinning.likelihood(&place, &wall(45.0, -5.0)), state.likelihood(&place, &wall(0.0, -5.0)));
        assert!(spinning.likelihood(&place, &wall(45.0, -80.0)).is_none());
    }
}
