//! Points on planes as rows, both ways at once.
//!
//! Residual     n . x - d for a point x of one part under the pose and the plane (n, d) of the other; its variance is the
//!              point's own, across
//!              the plane, and that of the plane's place there, with the squared bend
//! Weights      Tukey's (Beaton and Tukey 1974). n points of one plane share the plane's error and the bend: as rows of variance v with a
//!              common variance c they weigh together as sum(1 / v) / (1 + c sum(1 / v)), which stays below 1 / c. All planes together
//!              count at most as a fixed number of independent ones, since neighbours bend alike
//! Noise        rows of a normal n + sum t_k a_k, with t_k the tilts towards the plane's axes a_k of variance `sigma^2 / (n s_k^2)`, say on
//!              average so much more than rows of the true normal

use super::fit::{OwnFit, settle_near};
use super::planes::{Measured, PlaneGroup, PlaneOf, SharedPlanes};
use super::rows::{Miss, PlacedEquations, Rows, Source};
use crate::geometry::{Point3, Similarity, Vector3};
use crate::merging::pair_limits::FitLimits;
use crate::merging::point_covariance::KnownPoint;
use crate::robust::{Matrix7, MotionParameters, NormalEquations, truncated_quadratic, tukey_weight};

/// Median of the size of a whitened residual with one degree of freedom.
const MEDIAN_SIZE: f64 = 0.6745;

#[derive(Clone, Copy)]
pub(super) struct PlaneRows<'a> {
    pub planes: &'a SharedPlanes,
    /// A share of the radius of the part that has a plane.
    pub bend: f64,
    pub limits: &'a FitLimits,
}

/// A group at a pose: its points with their weights, and what the whole group counts.
struct Weighed<'a> {
    group: &'a PlaneGroup,
    rows: Vec<(Measured, f64)>,
    factor: f64,
}

impl<'a> PlaneRows<'a> {
    fn measured(&self, group: &PlaneGroup, point: &KnownPoint, a_from_b: &Similarity) -> Measured {
        group.measured(point, a_from_b, self.bend, self.planes.radius)
    }

    /// Votes of some points of a group, divided by the root of their number: points of one plane say much the same.
    pub fn votes_of<'p>(
        &self,
        group: &PlaneGroup,
        points: impl Iterator<Item = &'p KnownPoint>,
        a_from_b: &Similarity,
    ) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0f64);
        for point in points {
            sum += truncated_quadratic(whitened_sq(&self.measured(group, point, a_from_b)), self.limits.gate_sigmas);
            count += 1.0;
        }
        group.share * sum / count.max(1.0).sqrt()
    }

    /// Mean of the truncated quadratic, each group counting by the root of its points: 1 where every point lies on its plane.
    pub fn score(&self, a_from_b: &Similarity) -> f64 {
        let (mut sum, mut all) = (0.0, 0.0);
        for group in &self.planes.groups {
            sum += self.votes_of(group, group.points.iter(), a_from_b);
            all += group.share * (group.points.len() as f64).sqrt();
        }
        sum / all
    }

    /// The groups at a pose, and the factor that bounds what all together count.
    fn weighed(&self, a_from_b: &Similarity) -> (Vec<Weighed<'a>>, f64) {
        let mut independent = 0.0;
        let mut all = Vec::with_capacity(self.planes.groups.len());
        for group in &self.planes.groups {
            let (mut weights, mut common, mut count) = (0.0, 0.0, 0.0);
            let mut rows = Vec::with_capacity(group.points.len());
            for point in &group.points {
                let m = self.measured(group, point, a_from_b);
                let robust = tukey_weight(whitened_sq(&m), self.limits.gate_sigmas);
                let weight = robust / m.own;
                weights += weight;
                common += robust * m.common;
                count += robust;
                rows.push((m, weight));
            }
            let shared = if count > 0.0 { weights * common / count } else { 0.0 };
            all.push(Weighed { group, rows, factor: group.share / (1.0 + shared) });
            independent += group.share * shared / (1.0 + shared);
        }
        (all, (self.limits.independent / f64::max(independent, 1.0)).min(1.0))
    }

    /// What each group says at a pose.
    fn of_groups(&self, a_from_b: &Similarity, parameters: &MotionParameters) -> Vec<NormalEquations> {
        let (groups, factor) = self.weighed(a_from_b);
        groups.iter().map(|g| scaled(&scaled(&g.rows(parameters), g.factor), factor)).collect()
    }
}

impl Weighed<'_> {
    fn rows(&self, parameters: &MotionParameters) -> NormalEquations {
        let mut sums = NormalEquations::default();
        for (m, weight) in &self.rows {
            sums.add(&parameters.row(&m.at, &m.normal), m.residual, *weight);
        }
        sums
    }

    fn tilts(&self, a_from_b: &Similarity, parameters: &MotionParameters) -> NormalEquations {
        let (axes, variances) = (self.group.axes_in_a(a_from_b), self.group.tilt_variances());
        let mut sums = NormalEquations::default();
        for (m, weight) in &self.rows {
            for (axis, variance) in axes.iter().zip(variances) {
                sums.add(&parameters.row(&m.at, axis), 0.0, weight * variance);
            }
        }
        sums
    }
}

/// What planes say by themselves about a pose that is known well enough to tell their bend.
pub(in crate::merging) fn settle_planes(planes: &SharedPlanes, near: &Similarity, limits: &FitLimits) -> OwnFit {
    settle_near(&mut PlaneRows { planes, bend: 0.0, limits }, near, limits)
}

fn whitened_sq(m: &Measured) -> f64 {
    if m.is_beside { f64::INFINITY } else { m.residual * m.residual / (m.own + m.common) }
}

fn scaled(sums: &NormalEquations, factor: f64) -> NormalEquations {
    NormalEquations { information: sums.information * factor, gradient: sums.gradient * factor }
}

impl Rows for PlaneRows<'_> {
    fn add_rows(&self, a_from_b: &Similarity, parameters: &MotionParameters, factor: f64, sums: &mut NormalEquations) {
        self.of_groups(a_from_b, parameters).iter().for_each(|of_group| sums.merge(of_group, factor));
    }

    fn noise(&self, a_from_b: &Similarity, parameters: &MotionParameters) -> Option<Matrix7> {
        let (groups, factor) = self.weighed(a_from_b);
        let mut sums = NormalEquations::default();
        for group in &groups {
            sums.merge(&scaled(&scaled(&group.tilts(a_from_b, parameters), group.factor), factor), 1.0);
        }
        Some(sums.full())
    }
}

impl Source for PlaneRows<'_> {
    fn parameters(&self, a_from_b: &Similarity) -> MotionParameters {
        let (mut sum, mut count) = (Vector3::zeros(), 0.0f64);
        for group in &self.planes.groups {
            for point in &group.points {
                sum += match group.plane_of {
                    PlaneOf::A => a_from_b.apply(&point.at).coords,
                    PlaneOf::B => point.at.coords,
                };
                count += 1.0;
            }
        }
        MotionParameters::of_similarity(Point3::from(sum / count.max(1.0)), self.planes.radius[0])
    }

    fn misses(&self, a_from_b: &Similarity) -> Vec<Miss> {
        let mut misses = Vec::with_capacity(self.planes.correspondences());
        for group in &self.planes.groups {
            let measured = group.points.iter().map(|p| self.measured(group, p, a_from_b));
            misses
                .extend(measured.map(|m| Miss { whitened_sq: whitened_sq(&m), distance_sq: m.residual * m.residual }));
        }
        misses
    }

    fn placed(&self, a_from_b: &Similarity, parameters: &MotionParameters) -> Vec<PlacedEquations> {
        let sums = self.of_groups(a_from_b, parameters);
        let place = |group: &PlaneGroup| match group.plane_of {
            PlaneOf::A => group.plane.center,
            PlaneOf::B => a_from_b.apply(&group.plane.center),
        };
        self.planes.groups.iter().zip(sums).map(|(group, sums)| PlacedEquations { place: place(group), sums }).collect()
    }

    fn median_size(&self) -> f64 {
        MEDIAN_SIZE
    }

    fn bend(&self) -> f64 {
        self.bend
    }

    fn set_bend(&mut self, bend: f64) {
        self.bend = bend;
    }
}
