//! The similarity that point pairs and camera poses agree on.
//!
//! Method       three pairs give a similarity in closed form (Umeyama 1991), each shared camera gives one alone; the best by
//!              consensus is refined by Gauss-Newton with Tukey's weights. Every residual is whitened by its own covariance: the
//!              pair's two triangulations, and a bend that both parts have and that no similarity takes away (its size is what
//!              makes the median residual what it should be). The bend does not average out, so pairs count at most as a
//!              fixed number of independent ones.

use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};

use super::design_effect::design_effect;
use super::evidence::{CameraPair, Evidence, Pair};
use super::plane_evidence::PlaneEvidence;
use super::plane_fit::{add_planes, information_of_tilts, without};
use super::sigma::median;
use crate::geometry::{Point3, Similarity};
use crate::robust::{
    Chart, Matrix7, NormalEquations, Problem, Random, RansacOptions, Vector7, ransac, tukey_weight, vote,
};

/// A pair further off than this many sigmas is a mismatch.
pub(super) const GATE: f64 = 4.0;
/// Median of the norm of a whitened residual with three degrees of freedom (square root of the chi-square's 2.366).
const MEDIAN_NORM: f64 = 1.538;
/// The bend is sought between these shares of the scene's radius; the search starts with the middle one.
const BEND_SHARES: [f64; 3] = [1e-7, 5e-3, 5e-2];
/// Pairs used to rank hypotheses; more say nothing new.
const SCORED_PAIRS: usize = 250;
/// As many independent pairs all pairs together count at most, since their bend is common to neighbours.
pub(super) const INDEPENDENT: f64 = 200.0;
/// One sigma of a camera's rotation between two reconstructions, radians, and its centre in units of the bend.
const ROTATION_SIGMA_RAD: f64 = 1.5e-3;
const CENTER_BENDS: f64 = 1.0;
/// A camera further from the pairs' answer than this many sigmas is left out, and that is said.
const CAMERA_GATE: f64 = 3.0;
/// Ratio of the second spread to the first below which points lie on a line: rounding.
const ON_A_LINE: f64 = 1e-9;
pub(super) const ROUNDS: usize = 25;
pub(super) const CONVERGED: f64 = 1e-10;

/// What one pair of parts gives.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub a_from_b: Similarity,
    pub chart: Chart,
    /// In the chart's unknowns, a's units.
    pub information: Matrix7,
    /// Common deformation, a's units.
    pub bend: f64,
    /// Pairs within the gate.
    pub inliers: Vec<bool>,
    /// Root mean square distance of the inliers, a's units.
    pub rms: f64,
    pub cameras_used: Vec<bool>,
}

impl Fit {
    pub fn inlier_count(&self) -> usize {
        self.inliers.iter().filter(|i| **i).count()
    }
}

/// Pairs alone first, then the cameras that agree with them.
pub(super) fn fit(evidence: &Evidence, seed: u64) -> Option<Fit> {
    let pairs = &evidence.pairs;
    let radius = evidence.radius_a;
    let start = search(pairs, &evidence.cameras, radius, seed)?;
    let mut terms = Terms::of_pairs(pairs, BEND_SHARES[1] * radius, radius);
    let mut pose = start.pose;
    for _ in 0..4 {
        pose = refine(&terms, &pose);
        terms.bend = bend_of(pairs, &pose, radius);
    }
    pose = refine(&terms, &pose);
    let cameras_used: Vec<bool> = evidence.cameras.iter().map(|c| agrees(c, &pose, terms.bend)).collect();
    terms.cameras = evidence.cameras.iter().zip(&cameras_used).filter(|(_, used)| **used).map(|(c, _)| c).collect();
    pose = refine(&terms, &pose);
    Some(finish(&terms, pose, cameras_used))
}

/// The pairs and cameras of a fit once more, and planes with them.
pub(super) fn fit_with_planes(evidence: &Evidence, fit: &Fit, planes: PlaneTerm) -> Fit {
    let mut terms = Terms::of_pairs(&evidence.pairs, fit.bend, evidence.radius_a);
    terms.cameras = evidence.cameras.iter().zip(&fit.cameras_used).filter(|(_, used)| **used).map(|(c, _)| c).collect();
    terms.planes = Some(planes);
    let pose = refine(&terms, &fit.a_from_b);
    finish(&terms, pose, fit.cameras_used.clone())
}

/// The pairs by themselves about the place of a fit, and how much more they scatter than their rows say.
pub(super) fn fit_of_pairs(evidence: &Evidence, fit: &Fit) -> (Fit, f64) {
    let terms = Terms::of_pairs(&evidence.pairs, fit.bend, evidence.radius_a);
    let pose = refine(&terms, &fit.a_from_b);
    let mut own = finish(&terms, pose, Vec::new());
    let factor = f64::max(own.inlier_count() as f64 / INDEPENDENT, 1.0).recip();
    let sums: Vec<NormalEquations> = evidence
        .pairs
        .iter()
        .map(|pair| {
            let one = Terms::of_pairs(std::slice::from_ref(pair), fit.bend, evidence.radius_a);
            let of_pair = equations(&one, &pose, &own.chart);
            NormalEquations { information: of_pair.information * factor, gradient: of_pair.gradient * factor }
        })
        .collect();
    let places: Vec<Point3<f64>> = evidence.pairs.iter().map(|p| p.in_a).collect();
    let effect = design_effect(&places, &sums);
    own.information /= effect;
    (own, effect)
}

/// Planes as a source among others.
#[derive(Clone, Copy)]
pub(super) struct PlaneTerm<'a> {
    pub evidence: &'a PlaneEvidence,
    /// A share of the radius.
    pub bend: f64,
    /// Times the weight that their rows have by themselves.
    pub factor: f64,
}

/// What a pose is fitted to.
struct Terms<'a> {
    pairs: &'a [Pair],
    cameras: Vec<&'a CameraPair>,
    planes: Option<PlaneTerm<'a>>,
    /// Of pairs and cameras, a's units.
    bend: f64,
    radius: f64,
}

impl<'a> Terms<'a> {
    fn of_pairs(pairs: &'a [Pair], bend: f64, radius: f64) -> Terms<'a> {
        Terms { pairs, cameras: Vec::new(), planes: None, bend, radius }
    }
}

/// The best consensus of the pairs as they stand, without refinement; for comparing with a mirrored part.
pub(super) fn consensus(pairs: &[Pair], radius: f64, bend: f64, seed: u64) -> f64 {
    let Some(start) = search(pairs, &[], radius, seed) else { return 0.0 };
    let pose = refine(&Terms::of_pairs(pairs, bend, radius), &start.pose);
    pairs.iter().map(|pair| vote(whitened(pair, &pose, bend).norm_squared(), GATE)).sum()
}

struct Start {
    pose: Similarity,
    score: f64,
}

struct Search<'a> {
    pairs: &'a [Pair],
    scored: Vec<&'a Pair>,
    bend: f64,
    center_b: Point3<f64>,
    radius: f64,
}

fn search(pairs: &[Pair], cameras: &[CameraPair], radius: f64, seed: u64) -> Option<Start> {
    if pairs.len() < 3 {
        return None;
    }
    let step = pairs.len().div_ceil(SCORED_PAIRS);
    let mut center_b = Point3::origin();
    for axis in 0..3 {
        let mut values: Vec<f64> = pairs.iter().map(|p| p.in_b[axis]).collect();
        center_b[axis] = median(&mut values)?;
    }
    let search =
        Search { pairs, scored: pairs.iter().step_by(step).collect(), bend: BEND_SHARES[1] * radius, center_b, radius };
    let options =
        RansacOptions { seed, keep: 5, best_of_block: 5, fewest_samples: 2048, most_samples: 8192, enough_hits: 20 };
    let (ranked, _) = ransac(&search, &options, |_| true);
    let by_pairs = ranked.first().map(|best| Start { pose: best.pose, score: best.score });
    let by_cameras = cameras.iter().filter_map(CameraPair::a_from_b).map(|pose| {
        let refined = refine(&Terms::of_pairs(pairs, search.bend, radius), &pose);
        Start { score: search.score(&refined), pose: refined }
    });
    by_pairs.into_iter().chain(by_cameras).max_by(|a, b| a.score.total_cmp(&b.score))
}

impl Problem for Search<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        let picked = [0; 3].map(|_| random.below(self.pairs.len()));
        if picked[0] != picked[1] && picked[1] != picked[2] && picked[0] != picked[2] {
            let couples = picked.map(|i| (self.pairs[i].in_a, self.pairs[i].in_b));
            poses.extend(umeyama(&couples));
        }
    }

    fn score(&self, pose: &Similarity) -> f64 {
        self.scored.iter().map(|pair| vote(whitened(pair, pose, self.bend).norm_squared(), GATE)).sum()
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        let apart = (a.apply(&self.center_b) - b.apply(&self.center_b)).norm();
        apart < 0.05 * self.radius
            && (a.rotation.inverse() * b.rotation).angle() < 0.1
            && (a.scale / b.scale).ln().abs() < 0.1
    }
}

/// Least-squares similarity of point couples (Umeyama 1991); `None` where they do not fix it.
pub(super) fn umeyama(couples: &[(Point3<f64>, Point3<f64>)]) -> Option<Similarity> {
    let count = couples.len() as f64;
    let mean_a = couples.iter().map(|(a, _)| a.coords).sum::<Vector3<f64>>() / count;
    let mean_b = couples.iter().map(|(_, b)| b.coords).sum::<Vector3<f64>>() / count;
    let mut cross = Matrix3::zeros();
    let mut spread = 0.0;
    for (a, b) in couples {
        cross += (a.coords - mean_a) * (b.coords - mean_b).transpose();
        spread += (b.coords - mean_b).norm_squared();
    }
    let svd = cross.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| svd.singular_values[j].total_cmp(&svd.singular_values[i]));
    // Two spread directions are needed; the third follows.
    let [largest, second] = [svd.singular_values[order[0]], svd.singular_values[order[1]]];
    if largest <= 0.0 || second <= ON_A_LINE * largest || spread <= 0.0 {
        return None;
    }
    let mut sign = Vector3::repeat(1.0);
    sign[order[2]] = (u.determinant() * v_t.determinant()).signum();
    let rotation = Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&sign) * v_t);
    let scale = svd.singular_values.dot(&sign) / spread;
    (scale > 0.0 && scale.is_finite())
        .then(|| Similarity::about(&Point3::from(mean_b), &Point3::from(mean_a), scale, rotation))
}

/// Lower Cholesky factor of a residual's information, transposed: rows whiten.
fn whitening(pair: &Pair, a_from_b: &Similarity, bend: f64) -> SMatrix<f64, 3, 3> {
    let turn = a_from_b.rotation.matrix() * a_from_b.scale;
    let covariance =
        pair.covariance_a + turn * pair.covariance_b * turn.transpose() + Matrix3::identity() * (bend * bend);
    let information = covariance.try_inverse().unwrap_or_else(|| Matrix3::identity() / (bend * bend));
    information.cholesky().map_or_else(|| Matrix3::identity() / bend, |c| c.l().transpose())
}

pub(super) fn whitened(pair: &Pair, a_from_b: &Similarity, bend: f64) -> Vector3<f64> {
    whitening(pair, a_from_b, bend) * (a_from_b.apply(&pair.in_b) - pair.in_a)
}

/// The bend that makes the median whitened residual what it is by theory.
fn bend_of(pairs: &[Pair], pose: &Similarity, radius: f64) -> f64 {
    let (mut low, mut high) = (BEND_SHARES[0] * radius, BEND_SHARES[2] * radius);
    for _ in 0..25 {
        let middle = (low * high).sqrt();
        let mut norms: Vec<f64> = pairs.iter().map(|p| whitened(p, pose, middle).norm()).collect();
        if median(&mut norms).is_some_and(|m| m > MEDIAN_NORM) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Sigma of a camera's centre: a bend all round, and along its view what the focal lengths leave open.
fn center_whitening(camera: &CameraPair, bend: f64) -> Matrix3<f64> {
    let across = CENTER_BENDS * bend.max(1e-4 * camera.depth_a) + ROTATION_SIGMA_RAD * camera.depth_a;
    let along = across + camera.focal_doubt * camera.depth_a;
    let axis = camera.axis_a;
    let projector = axis * axis.transpose();
    (Matrix3::identity() - projector) / across + projector / along
}

fn rotation_sigma(camera: &CameraPair) -> f64 {
    ROTATION_SIGMA_RAD + 0.05 * camera.focal_doubt
}

fn camera_residuals(camera: &CameraPair, pose: &Similarity, bend: f64) -> (Vector3<f64>, Vector3<f64>) {
    let center = center_whitening(camera, bend) * (pose.apply(&camera.center_b) - camera.center_a);
    let turn = (pose.rotation * camera.a_from_b_rotation.inverse()).scaled_axis() / rotation_sigma(camera);
    (center, turn)
}

fn agrees(camera: &CameraPair, pose: &Similarity, bend: f64) -> bool {
    let (center, turn) = camera_residuals(camera, pose, bend);
    center.norm() < CAMERA_GATE * MEDIAN_NORM && turn.norm() < CAMERA_GATE * MEDIAN_NORM
}

fn chart_of(pairs: &[Pair], pose: &Similarity, radius: f64) -> Chart {
    let sum = pairs.iter().map(|p| pose.apply(&p.in_b).coords).sum::<Vector3<f64>>();
    Chart::of_similarity(Point3::from(sum / pairs.len().max(1) as f64), radius)
}

fn equations(terms: &Terms, pose: &Similarity, chart: &Chart) -> NormalEquations {
    let bend = terms.bend;
    let mut of_pairs = NormalEquations::default();
    let mut weights = 0.0;
    for pair in terms.pairs {
        let x = pose.apply(&pair.in_b);
        let whitening = whitening(pair, pose, bend);
        let residual = whitening * (x - pair.in_a);
        let weight = tukey_weight(residual.norm_squared(), GATE);
        weights += weight;
        for k in 0..3 {
            of_pairs.add(&chart.row(&x, &whitening.row(k).transpose()), residual[k], weight);
        }
    }
    let mut sums = NormalEquations::default();
    sums.merge(&of_pairs, (INDEPENDENT / f64::max(weights, 1.0)).min(1.0));
    for camera in &terms.cameras {
        let x = pose.apply(&camera.center_b);
        let whitening = center_whitening(camera, bend);
        let (center, turn) = camera_residuals(camera, pose, bend);
        for k in 0..3 {
            sums.add(&chart.row(&x, &whitening.row(k).transpose()), center[k], 1.0);
            let mut row = Vector7::zeros();
            row[k] = 1.0 / (chart.radius * rotation_sigma(camera));
            sums.add(&row, turn[k], 1.0);
        }
    }
    if let Some(planes) = &terms.planes {
        add_planes(planes.evidence, pose, planes.bend, chart, planes.factor, &mut sums);
    }
    sums
}

fn refine(terms: &Terms, start: &Similarity) -> Similarity {
    let mut pose = *start;
    for _ in 0..ROUNDS {
        let chart = chart_of(terms.pairs, &pose, terms.radius);
        let step = chart.step(&equations(terms, &pose, &chart), terms.radius);
        pose = chart.moved(&pose, &step);
        if step.norm() < CONVERGED * terms.radius {
            break;
        }
    }
    pose
}

fn finish(terms: &Terms, pose: Similarity, cameras_used: Vec<bool>) -> Fit {
    let (pairs, bend) = (terms.pairs, terms.bend);
    let chart = chart_of(pairs, &pose, terms.radius);
    let mut information = equations(terms, &pose, &chart).full();
    if let Some(planes) = &terms.planes {
        let tilts = information_of_tilts(planes.evidence, &pose, planes.bend, &chart);
        information = without(&information, &(tilts * planes.factor));
    }
    let inliers: Vec<bool> = pairs.iter().map(|p| whitened(p, &pose, bend).norm() < GATE).collect();
    let squares: Vec<f64> = pairs
        .iter()
        .zip(&inliers)
        .filter(|(_, inside)| **inside)
        .map(|(p, _)| (pose.apply(&p.in_b) - p.in_a).norm_squared())
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
    Fit { a_from_b: pose, chart, information, bend, inliers, rms, cameras_used }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> Similarity {
        Similarity {
            scale: 1.7,
            rotation: Rotation3::from_euler_angles(0.4, 2.0, -1.0),
            translation: Vector3::new(3.0, -8.0, 1.0),
        }
    }

    fn pair(k: usize) -> Pair {
        let t = k as f64;
        let in_b = Point3::new((t * 0.7).sin() * 4.0, (t * 1.3).cos() * 3.0, (t * 0.31).sin() * 2.0);
        let covariance = Matrix3::identity() * 1e-6;
        Pair { in_a: truth().apply(&in_b), in_b, covariance_a: covariance, covariance_b: covariance }
    }

    #[test]
    fn three_couples_fix_a_similarity() {
        let couples = [0, 3, 7].map(|k| (pair(k).in_a, pair(k).in_b));
        let found = umeyama(&couples).unwrap();
        assert!((found.scale - 1.7).abs() < 1e-12 && (found.translation - truth().translation).norm() < 1e-11);
        assert!(umeyama(&[couples[0], couples[0], couples[1]]).is_none());
    }

    #[test]
    fn finds_the_similarity_among_as_many_wrong_pairs() {
        let mut pairs: Vec<Pair> = (0..60).map(pair).collect();
        for k in 0..60 {
            let wrong = pair(k * 7 + 100).in_a;
            pairs.push(Pair { in_a: wrong, ..pair(k + 200) });
        }
        let evidence = Evidence {
            photos: Vec::new(),
            pairs,
            cameras: Vec::new(),
            chance: 0.0,
            fewer_keypoints: 120,
            radius_a: 8.0,
            own_error: [0.0; 2],
        };
        let fit = fit(&evidence, 1).unwrap();
        let p = Point3::new(1.0, 2.0, 3.0);
        assert!((fit.a_from_b.apply(&p) - truth().apply(&p)).norm() < 0.02, "{fit:?}");
    }
}
