//! The similarity that superpixel planes agree on, refined from a start.
//!
//! Method       Gauss-Newton on the distances of points from planes, both ways at once, with Tukey's weights. The bend that both parts
//!              have is what makes the median whitened residual what it should be.
//! Weights      n points of one plane share the plane's error and the bend: as rows of variance v with a common variance c
//!              they weigh together as sum(1 / v) / (1 + c sum(1 / v)), which stays below 1 / c. All planes together count at
//!              most as a fixed number of independent ones, since neighbours bend alike.

use super::design_effect::design_effect;
use super::fit::{CONVERGED, Fit, GATE, INDEPENDENT, ROUNDS};
use super::plane_evidence::{Measured, PlaneEvidence, PlaneGroup, PlaneOf, PointOnPlane};
use super::sigma::median;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::robust::{Chart, Matrix7, NormalEquations, tukey_weight, vote};

/// Median of the size of a whitened residual with one degree of freedom.
const MEDIAN_SIZE: f64 = 0.6745;
/// The bend is sought between these shares of the radius.
const LEAST_BEND: f64 = 1e-7;
const MOST_BEND: f64 = 5e-2;
/// A point this near to its plane, as a share of the radius, lies on it: 0.2 % of the extent.
const ON_PLANE: f64 = 4e-3;

/// What planes say by themselves.
#[derive(Clone, Debug)]
pub(super) struct PlaneFit {
    pub fit: Fit,
    /// How much more its estimate scatters, as a variance, than its rows say.
    pub design_effect: f64,
}

/// Refines a pose on the planes alone, with the bend that its residuals show.
pub(super) fn settle(evidence: &PlaneEvidence, start: &Similarity) -> PlaneFit {
    let mut pose = *start;
    for _ in 0..4 {
        let bend = bend_of(evidence, &pose);
        pose = refine(evidence, &pose, bend);
    }
    let bend = bend_of(evidence, &pose);
    pose = refine(evidence, &pose, bend);
    finish(evidence, pose, bend)
}

/// Votes of some points of a group, divided by the root of their number: points of one superpixel say much the same.
pub(super) fn votes<'a>(
    group: &PlaneGroup,
    points: impl Iterator<Item = &'a PointOnPlane>,
    pose: &Similarity,
    bend: f64,
    radius: [f64; 2],
) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0f64);
    for point in points {
        sum += vote(whitened_sq(&group.measured(point, pose, bend, radius)), GATE);
        count += 1.0;
    }
    group.share * sum / count.max(1.0).sqrt()
}

fn whitened_sq(m: &Measured) -> f64 {
    if m.is_beside { f64::INFINITY } else { m.residual * m.residual / (m.own + m.common) }
}

/// Share of the points that lie on their planes, to `ON_PLANE`, each group counting by the root of its points.
pub(super) fn share_on_planes(evidence: &PlaneEvidence, pose: &Similarity) -> f64 {
    let (mut inside, mut all) = (0.0, 0.0);
    for group in &evidence.groups {
        let gate = match group.plane_of {
            PlaneOf::A => ON_PLANE * evidence.radius[0],
            PlaneOf::B => ON_PLANE * evidence.radius[1] * pose.scale,
        };
        let measured = group.points.iter().map(|p| group.measured(p, pose, 0.0, evidence.radius));
        let count = measured.filter(|m| !m.is_beside && m.residual.abs() < gate).count() as f64;
        let root = (group.points.len() as f64).sqrt();
        inside += group.share * count / root;
        all += group.share * root;
    }
    inside / all
}

/// Mean vote, each group counting by the root of its points: 1 where every point lies on its plane.
pub(super) fn score(evidence: &PlaneEvidence, pose: &Similarity, bend: f64) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for group in &evidence.groups {
        sum += votes(group, group.points.iter(), pose, bend, evidence.radius);
        all += group.share * (group.points.len() as f64).sqrt();
    }
    sum / all
}

/// The bend, a share of the radius, that makes the median whitened residual what it is by theory.
fn bend_of(evidence: &PlaneEvidence, pose: &Similarity) -> f64 {
    let (mut low, mut high) = (LEAST_BEND, MOST_BEND);
    for _ in 0..25 {
        let middle = (low * high).sqrt();
        let mut sizes: Vec<f64> = Vec::with_capacity(evidence.correspondences());
        for group in &evidence.groups {
            let measured = group.points.iter().map(|p| group.measured(p, pose, middle, evidence.radius));
            sizes.extend(measured.map(|m| whitened_sq(&m).sqrt()));
        }
        if median(&mut sizes).is_some_and(|m| m > MEDIAN_SIZE) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// What one group says at a pose.
struct GroupSums {
    rows: NormalEquations,
    /// Information that comes from the noise of the plane's normal alone: rows of a normal n + sum t_k a_k, with t_k the tilts towards
    /// the plane's axes a_k of variance `sigma^2 / (n s_k^2)`, say on average so much more than rows of the true normal.
    tilts: NormalEquations,
}

fn sums_of_groups(evidence: &PlaneEvidence, pose: &Similarity, bend: f64, chart: &Chart) -> Vec<GroupSums> {
    let mut independent = 0.0;
    let mut of_groups: Vec<GroupSums> = Vec::with_capacity(evidence.groups.len());
    for group in &evidence.groups {
        let (mut rows, mut tilts) = (NormalEquations::default(), NormalEquations::default());
        let (mut weights, mut common, mut count) = (0.0, 0.0, 0.0);
        let axes = group.axes_in_a(pose);
        let tilt_variances = group.tilt_variances();
        for point in &group.points {
            let m = group.measured(point, pose, bend, evidence.radius);
            let robust = tukey_weight(whitened_sq(&m), GATE);
            let weight = robust / m.own;
            rows.add(&chart.row(&m.at, &m.normal), m.residual, weight);
            for (axis, variance) in axes.iter().zip(tilt_variances) {
                tilts.add(&chart.row(&m.at, axis), 0.0, weight * variance);
            }
            weights += weight;
            common += robust * m.common;
            count += robust;
        }
        let shared = if count > 0.0 { weights * common / count } else { 0.0 };
        let factor = group.share / (1.0 + shared);
        of_groups.push(GroupSums { rows: scaled(&rows, factor), tilts: scaled(&tilts, factor) });
        independent += group.share * shared / (1.0 + shared);
    }
    let factor = (INDEPENDENT / f64::max(independent, 1.0)).min(1.0);
    of_groups.iter().map(|s| GroupSums { rows: scaled(&s.rows, factor), tilts: scaled(&s.tilts, factor) }).collect()
}

fn scaled(sums: &NormalEquations, factor: f64) -> NormalEquations {
    NormalEquations { information: sums.information * factor, gradient: sums.gradient * factor }
}

/// Adds what the planes say at a pose.
pub(super) fn add_planes(
    evidence: &PlaneEvidence,
    pose: &Similarity,
    bend: f64,
    chart: &Chart,
    factor: f64,
    sums: &mut NormalEquations,
) {
    sums_of_groups(evidence, pose, bend, chart).iter().for_each(|of_group| sums.merge(&of_group.rows, factor));
}

/// The part of that information which is only noise of the planes' normals.
pub(super) fn information_of_tilts(evidence: &PlaneEvidence, pose: &Similarity, bend: f64, chart: &Chart) -> Matrix7 {
    full_tilts(&sums_of_groups(evidence, pose, bend, chart))
}

fn full_tilts(of_groups: &[GroupSums]) -> Matrix7 {
    let mut sums = NormalEquations::default();
    of_groups.iter().for_each(|of_group| sums.merge(&of_group.tilts, 1.0));
    sums.full()
}

/// Information less what is noise; nothing where less than nothing is left. Many nearly parallel planes would otherwise seem to hold
/// what they leave free.
pub(super) fn without(information: &Matrix7, noise: &Matrix7) -> Matrix7 {
    let eigen = (information - noise).symmetric_eigen();
    let kept = Matrix7::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0)));
    let rest = eigen.eigenvectors * kept * eigen.eigenvectors.transpose();
    (rest + rest.transpose()) * 0.5
}

/// Centre of the points as they lie in a.
pub(super) fn chart_of(evidence: &PlaneEvidence, pose: &Similarity) -> Chart {
    let (mut sum, mut count) = (Vector3::zeros(), 0.0f64);
    for group in &evidence.groups {
        for point in &group.points {
            sum += match group.plane_of {
                PlaneOf::A => pose.apply(&point.at).coords,
                PlaneOf::B => point.at.coords,
            };
            count += 1.0;
        }
    }
    Chart::of_similarity(Point3::from(sum / count.max(1.0)), evidence.radius[0])
}

pub(super) fn refine(evidence: &PlaneEvidence, start: &Similarity, bend: f64) -> Similarity {
    let mut pose = *start;
    for _ in 0..ROUNDS {
        let chart = chart_of(evidence, &pose);
        let mut sums = NormalEquations::default();
        add_planes(evidence, &pose, bend, &chart, 1.0, &mut sums);
        let step = chart.step(&sums, chart.radius);
        pose = chart.moved(&pose, &step);
        if step.norm() < CONVERGED * chart.radius {
            break;
        }
    }
    pose
}

/// Where a group lies in a.
fn place(group: &PlaneGroup, pose: &Similarity) -> Point3<f64> {
    match group.plane_of {
        PlaneOf::A => group.plane.center,
        PlaneOf::B => pose.apply(&group.plane.center),
    }
}

fn finish(evidence: &PlaneEvidence, pose: Similarity, bend: f64) -> PlaneFit {
    let chart = chart_of(evidence, &pose);
    let of_groups = sums_of_groups(evidence, &pose, bend, &chart);
    let mut sums = NormalEquations::default();
    of_groups.iter().for_each(|of_group| sums.merge(&of_group.rows, 1.0));
    let (mut inliers, mut squares) = (Vec::new(), 0.0);
    for group in &evidence.groups {
        for point in &group.points {
            let m = group.measured(point, &pose, bend, evidence.radius);
            let is_inside = whitened_sq(&m) < GATE * GATE;
            inliers.push(is_inside);
            squares += if is_inside { m.residual * m.residual } else { 0.0 };
        }
    }
    let count = inliers.iter().filter(|i| **i).count();
    let places: Vec<Point3<f64>> = evidence.groups.iter().map(|g| place(g, &pose)).collect();
    let design_effect = design_effect(&places, &of_groups.iter().map(|s| s.rows).collect::<Vec<_>>());
    PlaneFit {
        design_effect,
        fit: Fit {
            a_from_b: pose,
            chart,
            information: without(&sums.full(), &full_tilts(&of_groups)) / design_effect,
            bend: bend * evidence.radius[0],
            inliers,
            rms: (squares / count.max(1) as f64).sqrt(),
            cameras_used: Vec::new(),
        },
    }
}
