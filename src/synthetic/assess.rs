//! Assessments: an alignment beside the truth, in metres and in its own sigmas.
//!
//! Question     is a verdict right, and is the error within what was stated?
//! Input        an alignment, the truth (none in a foreign town), the points that are not wrong
//! Method       errors of points, root mean square over the cloud; the error of the pose about the alignment's own centre, along the
//!              principal axes of its covariance, of which as many as there are determined freedoms are *held*
//! Assumptions  of an undetermined pose only what is held is claimed: an error along the rest is no error

use nalgebra::{SMatrix, SVector};

use crate::geometry::{Point3, Rotation3, Similarity, Vector3};
use crate::verdict::{Alignment, Verdict};

type Vector7 = SVector<f64, 7>;
type Matrix7 = SMatrix<f64, 7, 7>;

/// An error is wrong beyond so much, and beyond three times what was stated; gross beyond 2 m as well.
const WRONG_M: f64 = 0.5;
const WRONG_SIGMAS: f64 = 3.0;
const GROSS_M: f64 = 2.0;

/// A given scale that is nearer than this to the true one is not wrong (natural logarithm).
const RIGHT_LOG_SCALE: f64 = 0.02;

/// Chi-square for 1 to 7 freedoms: what 2.5 % and 97.5 % of right statements stay below (any table of the distribution).
const BAND: [[f64; 2]; 7] = [
    [0.000_982, 5.024],
    [0.0506, 7.378],
    [0.216, 9.348],
    [0.484, 11.143],
    [0.831, 12.833],
    [1.237, 14.449],
    [1.690, 16.013],
];
/// Median of chi-square, by freedoms.
const MEDIAN: [f64; 7] = [0.455, 1.386, 2.366, 3.357, 4.351, 5.348, 6.346];

/// What a verdict turned out to be worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    AlignedRight,
    AlignedWrong,
    AlignedGross,
    UndeterminedRight,
    /// Wrong in what it says is held.
    UndeterminedWrong,
    /// The right pose is the best one, or among the alternatives.
    AmbiguousRight,
    AmbiguousWrong,
    /// The best candidate was right and was refused.
    FailedRight,
    FailedWrong,
}

/// An alignment beside the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    pub verdict: Verdict,
    /// Root mean square over the points; infinite without a pose or without a truth.
    pub error_m: f64,
    /// What the covariance says of the same.
    pub stated_m: f64,
    /// Both along what is held.
    pub held_error_m: f64,
    pub held_stated_m: f64,
    /// Squared error along what is held, in sigmas.
    pub chi_square: f64,
    /// How many freedoms are held.
    pub held: usize,
    /// The smallest error among the alternatives.
    pub alternative_m: f64,
    /// The verdict speaks against a scale that was given, and that scale is wrong.
    pub names_scale: bool,
}

impl Assessment {
    pub fn new(alignment: &Alignment, truth: Option<&Similarity>, points: &[Point3<f64>]) -> Assessment {
        let nothing = Assessment {
            verdict: alignment.verdict,
            error_m: f64::INFINITY,
            stated_m: 0.0,
            held_error_m: f64::INFINITY,
            held_stated_m: 0.0,
            chi_square: f64::INFINITY,
            held: 0,
            alternative_m: f64::INFINITY,
            names_scale: false,
        };
        let Some(best) = alignment.best_candidate else { return nothing };
        let places: Vec<Vector3<f64>> = points.iter().map(|x| best.apply(x) - alignment.center).collect();
        let axes = Axes::new(alignment);
        let all = |weights: &dyn Fn(usize) -> f64| rms_of(&axes.motion(weights), &places, axes.radius);
        let stated = |from: usize| {
            let of_axis = |k: usize| all(&|other| if other == k { axes.sigmas[k] } else { 0.0 }).powi(2);
            (from..axes.count).map(of_axis).sum::<f64>().sqrt()
        };
        let first_held = axes.count - axes.held;
        let stated = Assessment { stated_m: stated(0), held_stated_m: stated(first_held), held: axes.held, ..nothing };
        let Some(truth) = truth else { return stated };
        let error = error_of(&best, truth, &alignment.center, axes.radius);
        let along: Vec<f64> = (0..axes.count).map(|k| axes.unit[k].dot(&error)).collect();
        let alternatives = alignment.alternatives.iter().map(|a| rms_between(&a.city_from_sfm, truth, points));
        Assessment {
            error_m: rms_between(&best, truth, points),
            held_error_m: all(&|k| if k < first_held { 0.0 } else { along[k] }),
            chi_square: (first_held..axes.count).map(|k| (along[k] / axes.sigmas[k].max(1e-9)).powi(2)).sum(),
            alternative_m: alternatives.fold(f64::INFINITY, f64::min),
            names_scale: alignment.freedoms.iter().any(|f| f.given && !f.determined)
                && (truth.scale / best.scale).ln().abs() > RIGHT_LOG_SCALE,
            ..stated
        }
    }

    pub fn outcome(&self) -> Outcome {
        let most = WRONG_M.max(WRONG_SIGMAS * self.stated_m);
        let is_right = self.held_error_m <= WRONG_M.max(WRONG_SIGMAS * self.held_stated_m);
        match self.verdict {
            Verdict::Aligned if self.error_m <= most => Outcome::AlignedRight,
            Verdict::Aligned if self.error_m <= most.max(GROSS_M) => Outcome::AlignedWrong,
            Verdict::Aligned => Outcome::AlignedGross,
            // A pose that is held to a wrong scale is off with it; the verdict says why.
            Verdict::Undetermined if is_right || self.names_scale => Outcome::UndeterminedRight,
            Verdict::Undetermined => Outcome::UndeterminedWrong,
            Verdict::Ambiguous if is_right || self.alternative_m <= WRONG_M => Outcome::AmbiguousRight,
            Verdict::Ambiguous => Outcome::AmbiguousWrong,
            Verdict::Failed if is_right => Outcome::FailedRight,
            Verdict::Failed => Outcome::FailedWrong,
        }
    }

    /// Whether the error tells something of the sigmas: the place is right, something is held, and the pose is not refused.
    pub fn tells_sigmas(&self) -> bool {
        matches!(self.verdict, Verdict::Aligned | Verdict::Undetermined) && self.held > 0 && self.held_error_m < GROSS_M
    }

    /// Below, within or above the band in which 95 % of right statements lie.
    pub fn band(&self) -> std::cmp::Ordering {
        let [low, high] = BAND[self.held.clamp(1, 7) - 1];
        match self.chi_square {
            x if x < low => std::cmp::Ordering::Less,
            x if x > high => std::cmp::Ordering::Greater,
            _ => std::cmp::Ordering::Equal,
        }
    }

    /// Chi-square over its median: the square of what the sigmas lack, in the median of many.
    pub fn normalised(&self) -> f64 {
        self.chi_square / MEDIAN[self.held.clamp(1, 7) - 1]
    }
}

/// The principal axes of a covariance, all unknowns as lengths at the radius; loosest first.
struct Axes {
    unit: Vec<Vector7>,
    sigmas: Vec<f64>,
    /// How many there are (six where the scale is given), and how many of them are held: the last ones.
    count: usize,
    held: usize,
    radius: f64,
}

impl Axes {
    fn new(alignment: &Alignment) -> Axes {
        let radius = alignment.radius.max(f64::MIN_POSITIVE);
        let lengths = [radius, radius, radius, 1.0, 1.0, 1.0, radius];
        let covariance = Matrix7::from_fn(|i, j| alignment.covariance[i][j] * lengths[i] * lengths[j]);
        let eigen = covariance.symmetric_eigen();
        let mut order: Vec<usize> = (0..7).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let is_given = alignment.freedoms.iter().any(|freedom| freedom.given);
        let count = if is_given { 6 } else { 7 };
        let determined = alignment.freedoms.iter().filter(|f| f.determined && !f.given).count();
        Axes {
            unit: order.iter().map(|k| eigen.eigenvectors.column(*k).into_owned()).collect(),
            sigmas: order.iter().map(|k| eigen.eigenvalues[*k].max(0.0).sqrt()).collect(),
            count,
            held: determined.min(count),
            radius,
        }
    }

    /// A motion by so much along each axis.
    fn motion(&self, along: &dyn Fn(usize) -> f64) -> Vector7 {
        (0..self.count).map(|k| along(k) * self.unit[k]).sum()
    }
}

/// Root mean square of what a small motion does to places about its centre.
fn rms_of(motion: &Vector7, places: &[Vector3<f64>], radius: f64) -> f64 {
    let turn = Vector3::new(motion[0], motion[1], motion[2]) / radius;
    let shift = Vector3::new(motion[3], motion[4], motion[5]);
    let of_place = |d: &Vector3<f64>| (turn.cross(d) + shift + motion[6] / radius * d).norm_squared();
    (places.iter().map(of_place).sum::<f64>() / places.len().max(1) as f64).sqrt()
}

/// The truth relative to what was found: rotation vector about the centre, shift of it, logarithm of the scale, as lengths.
fn error_of(found: &Similarity, truth: &Similarity, center: &Point3<f64>, radius: f64) -> Vector7 {
    let turn = radius * rotation_vector(&(truth.rotation * found.rotation.inverse()));
    let shift = truth.apply(&found.inverse().apply(center)) - center;
    let scale = radius * (truth.scale / found.scale).ln();
    Vector7::from_column_slice(&[turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, scale])
}

/// Axis times angle, exact near zero, where an arc cosine has no digits left.
fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let r = rotation.matrix();
    let axis = 0.5 * Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (sin, cos) = (axis.norm(), 0.5 * (r.trace() - 1.0));
    if sin > 1e-12 {
        return axis * (sin.atan2(cos) / sin);
    }
    // Half a turn has no skew part; about which axis does not matter to its size.
    if cos > 0.0 { axis } else { std::f64::consts::PI * Vector3::z() }
}

fn rms_between(a: &Similarity, b: &Similarity, points: &[Point3<f64>]) -> f64 {
    let sum: f64 = points.iter().map(|x| (a.apply(x) - b.apply(x)).norm_squared()).sum();
    (sum / points.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests;
