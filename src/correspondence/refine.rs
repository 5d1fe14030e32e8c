//! From a rough pose to a sharp one: closest facets with their extents, bounded loss, a gate that narrows.
//!
//! Question     the pose near a given one that lies best on the facets
//! Input        level cloud, facet grid, a pose, a schedule of gates
//! Output       the pose, its information, which sample point lies on which facet
//! Method       iterated closest facets: each sample point takes the nearest facet of its side and direction within the gate; the distance
//!              from the facet's plane is minimised with Tukey's weights by Gauss-Newton steps that leave alone what the data
//!              do not hold. All points of one plane of the city share the model's error, so n of them with noise sigma weigh
//!              as n / (sigma^2 + n tau^2): one plane is one observation of limited weight.
//! Source       docs/mathematics.md 15 (16, 17)
//! Fails when   the pose is farther off than the gate: then it stays near where it was and scores badly

use rayon::prelude::*;

use super::scene::Scene;
use crate::geometry::{Point3, Similarity};
use crate::planes::Hit;
use crate::robust::{Motion, MotionParameters, NormalEquations, tukey_weight};

/// A refined pose and what holds it.
#[derive(Clone, Debug)]
pub struct RefinedPose {
    pub city_from_level: Similarity,
    pub parameters: MotionParameters,
    /// In units of 1 / m^2, with the error model applied.
    pub equations: NormalEquations,
}

/// Refines poses of one scene.
pub struct PoseRefiner<'a> {
    pub scene: &'a Scene<'a>,
    /// How poses may move.
    pub motion: Motion,
    /// Noise of one point across its plane, metres.
    pub point_sigma_m: f64,
}

/// Sample points per task.
const CHUNK: usize = 512;
/// Most steps of sharpening: pairs of points and facets do not change after some.
const SHARPENING_STEPS: usize = 5;
/// A cloud smaller than this has no turn or scale to speak of.
const SMALLEST_RADIUS_M: f64 = 1e-3;
/// Makes a standard deviation of a median magnitude.
const SIGMA_OF_MEDIAN: f64 = 1.4826;

/// A sample point on a facet.
#[derive(Clone, Copy, Debug)]
pub struct PointPlaneMatch {
    /// Index into the level cloud's sample points.
    pub sample_point: u32,
    /// In the city's local frame.
    pub place: Point3<f64>,
    pub hit: Hit,
    /// Tukey's weight of the residual.
    pub weight: f64,
}

impl<'a> PoseRefiner<'a> {
    /// Moves poses as the scene's prior allows.
    pub fn new(scene: &'a Scene<'a>) -> PoseRefiner<'a> {
        let point_sigma_m = scene.level_cloud.noise_m.max(scene.limits.least_point_sigma_m);
        PoseRefiner { scene, motion: scene.prior.motion, point_sigma_m }
    }

    /// The same with the scale free, though it may be given.
    pub fn with_free_scale(&self) -> PoseRefiner<'a> {
        PoseRefiner { motion: Motion::Similarity, ..*self }
    }

    /// Refines `pose` with the given gates (metres of the start), one step each, using the sample points of `point_subset`.
    pub fn refine(&self, point_subset: &[u32], pose: &Similarity, gates_m: &[f64]) -> RefinedPose {
        let mut pose = *pose;
        let mut refined = RefinedPose {
            city_from_level: pose,
            parameters: self.parameters(&pose),
            equations: NormalEquations::default(),
        };
        for &gate_m in gates_m {
            let parameters = self.parameters(&pose);
            let rows = self.point_plane_matches(point_subset, &pose, gate_m);
            let equations = self.equations(&parameters, &rows);
            pose = parameters.moved(&pose, &parameters.step(&equations, self.scene.limits.refinement.most_sigma_m));
            refined = RefinedPose { city_from_level: pose, parameters, equations };
        }
        refined
    }

    /// Refines `pose` with a gate that follows the residuals: Tukey's width for their robust sigma, at most `gate_m` (metres of
    /// the start).
    pub fn sharpen(&self, point_subset: &[u32], pose: &Similarity, gate_m: f64) -> RefinedPose {
        let limits = &self.scene.limits.refinement;
        let mut refined = self.refine(point_subset, pose, &[gate_m]);
        for _ in 0..SHARPENING_STEPS {
            let pose = refined.city_from_level;
            let rows = self.point_plane_matches(point_subset, &pose, gate_m);
            let narrow_m = (limits.tukey_sigmas * robust_sigma(&rows) / pose.scale)
                .clamp(limits.least_gate_share * gate_m, gate_m);
            refined = self.refine(point_subset, &pose, &[narrow_m]);
        }
        refined
    }

    /// The same pose with its information, nothing moved.
    pub fn assess(&self, point_subset: &[u32], pose: &Similarity, gate_m: f64) -> RefinedPose {
        let parameters = self.parameters(pose);
        let equations = self.equations(&parameters, &self.point_plane_matches(point_subset, pose, gate_m));
        RefinedPose { city_from_level: *pose, parameters, equations }
    }

    /// Which sample point of `point_subset` lies on which plane within `gate_m` (metres of the start), sorted by plane.
    pub fn point_plane_matches(&self, point_subset: &[u32], pose: &Similarity, gate_m: f64) -> Vec<PointPlaneMatch> {
        let chunk = |point_subset: &[u32]| self.chunk_on_planes(point_subset, pose, gate_m * pose.scale);
        let mut rows = point_subset.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().concat();
        rows.sort_by_cached_key(|r| r.hit.plane);
        rows
    }

    fn chunk_on_planes(&self, point_subset: &[u32], pose: &Similarity, firm_gate_m: f64) -> Vec<PointPlaneMatch> {
        let (level_cloud, limits) = (&self.scene.level_cloud, &self.scene.limits.refinement);
        let loose_gate_m = firm_gate_m.min(limits.unsegmented_gate_sigmas * self.point_sigma_m);
        let is_firm = |i: u32| (i as usize) < level_cloud.patch_points;
        let gate_m = |i: u32| if is_firm(i) { firm_gate_m } else { loose_gate_m };
        let mut rows = Vec::new();
        self.scene.meet(point_subset, pose, firm_gate_m, gate_m, |k, sample_point, hit| {
            let i = point_subset[k];
            let trust = if is_firm(i) { 1.0 } else { limits.unsegmented_weight };
            let weight = trust * tukey_weight(hit.across_m * hit.across_m, gate_m(i));
            if hit.outside_m <= limits.outside_share * gate_m(i) && weight > 0.0 {
                rows.push(PointPlaneMatch { sample_point: i, place: sample_point.position, hit: *hit, weight });
            }
        });
        rows
    }

    fn equations(&self, parameters: &MotionParameters, rows: &[PointPlaneMatch]) -> NormalEquations {
        let mut sums = NormalEquations::default();
        for of_plane in rows.chunk_by(|a, b| a.hit.plane == b.hit.plane) {
            sums.merge(&self.equations_of_plane(parameters, of_plane), 1.0);
        }
        sums
    }

    /// What the sample points on one plane say, with the model's error common to all of them.
    pub fn equations_of_plane(&self, parameters: &MotionParameters, rows: &[PointPlaneMatch]) -> NormalEquations {
        let mut plane = NormalEquations::default();
        let mut count = 0.0;
        for row in rows {
            // At the foot on the facet: a smaller scale must not seem to make the noise across it smaller.
            let foot = row.place - row.hit.normal * row.hit.across_m;
            plane.add(&parameters.row(&foot, &row.hit.normal), row.hit.across_m, row.weight);
            count += row.weight;
        }
        let variance = self.point_sigma_m.powi(2) + count * self.scene.limits.plane_sigma_m.powi(2);
        let mut scaled = NormalEquations::default();
        scaled.merge(&plane, 1.0 / variance);
        scaled
    }

    fn parameters(&self, pose: &Similarity) -> MotionParameters {
        let radius = (self.scene.level_cloud.radius_m * pose.scale).max(SMALLEST_RADIUS_M);
        MotionParameters { center: pose.apply(&Point3::origin()), radius, motion: self.motion }
    }
}

/// Standard deviation of the residuals, from their median magnitude; metres.
fn robust_sigma(rows: &[PointPlaneMatch]) -> f64 {
    let mut across: Vec<f64> = rows.iter().map(|r| r.hit.across_m.abs()).collect();
    across.sort_by(f64::total_cmp);
    SIGMA_OF_MEDIAN * across.get(across.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
