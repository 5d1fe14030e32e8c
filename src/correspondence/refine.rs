//! From a rough pose to a sharp one: closest facets with their extents, bounded loss, a gate that narrows.
//!
//! Question     the pose near a given one that lies best on the facets
//! Input        votes, field, a pose, a schedule of gates
//! Output       the pose, its information, which probe lies on which facet
//! Method       iterated closest facets: each probe takes the nearest facet of its side and direction within the gate; the distance
//!              from the facet's plane is minimised with Tukey's weights by Gauss-Newton steps that leave alone what the data
//!              do not hold. All points of one plane of the city share the model's error, so n of them with noise sigma weigh
//!              as n / (sigma^2 + n tau^2): one plane is one vote of limited weight.
//! Fails when   the pose is farther off than the gate: then it stays near where it was and scores badly

use rayon::prelude::*;

use super::scene::Scene;
use super::scoring::Mover;
use super::walk::{Stride, walk};
use crate::geometry::{Point3, Similarity};
use crate::planes::Hit;
use crate::robust::{Chart, Direction, Motion, NormalEquations, tukey_weight};

/// A refined pose and what holds it.
#[derive(Clone, Debug)]
pub struct Refined {
    pub city_from_level: Similarity,
    pub chart: Chart,
    /// In units of 1 / m^2, with the error model applied.
    pub equations: NormalEquations,
}

/// Refines poses of one scene.
pub struct Refiner<'a> {
    pub scene: &'a Scene<'a>,
    /// How poses may move.
    pub motion: Motion,
    /// Noise of one point across its plane, metres.
    point_sigma_m: f64,
}

/// Probes per task.
const CHUNK: usize = 512;
/// Pairs settle within some steps.
const SHARPENING_STEPS: usize = 5;
/// A cloud smaller than this has no turn or scale to speak of.
const SMALLEST_RADIUS_M: f64 = 1e-3;
/// Makes a standard deviation of a median magnitude.
const SIGMA_OF_MEDIAN: f64 = 1.4826;

/// A probe on a facet.
#[derive(Clone, Copy, Debug)]
pub struct ProbeOnPlane {
    /// Index into the votes' probes.
    pub probe: u32,
    /// In the city's local frame.
    pub place: Point3<f64>,
    pub hit: Hit,
    /// Tukey's weight of the residual.
    pub weight: f64,
}

impl<'a> Refiner<'a> {
    /// Moves poses as the scene's prior allows.
    pub fn new(scene: &'a Scene<'a>) -> Refiner<'a> {
        let point_sigma_m = scene.votes.noise_m.max(scene.limits.least_point_sigma_m);
        Refiner { scene, motion: scene.prior.motion, point_sigma_m }
    }

    /// The same with the scale free, though it may be given.
    pub fn with_free_scale(&self) -> Refiner<'a> {
        Refiner { motion: Motion::Similarity, ..*self }
    }

    /// Refines `pose` with the given gates (metres of the start), one step each, using the probes of `panel`.
    pub fn refine(&self, panel: &[u32], pose: &Similarity, gates_m: &[f64]) -> Refined {
        let mut pose = *pose;
        let mut refined =
            Refined { city_from_level: pose, chart: self.chart(&pose), equations: NormalEquations::default() };
        for &gate_m in gates_m {
            let chart = self.chart(&pose);
            let rows = self.probes_on_planes(panel, &pose, gate_m);
            let equations = self.equations(&chart, &rows);
            pose = chart.moved(&pose, &chart.step(&equations, self.scene.limits.refinement.held_m));
            refined = Refined { city_from_level: pose, chart, equations };
        }
        refined
    }

    /// Refines `pose` with a gate that follows the residuals: Tukey's width for their robust sigma, at most `gate_m` (metres of
    /// the start).
    pub fn sharpen(&self, panel: &[u32], pose: &Similarity, gate_m: f64) -> Refined {
        let limits = &self.scene.limits.refinement;
        let mut refined = self.refine(panel, pose, &[gate_m]);
        for _ in 0..SHARPENING_STEPS {
            let pose = refined.city_from_level;
            let rows = self.probes_on_planes(panel, &pose, gate_m);
            let narrow_m = (limits.tukey_sigmas * robust_sigma(&rows) / pose.scale)
                .clamp(limits.least_gate_share * gate_m, gate_m);
            refined = self.refine(panel, &pose, &[narrow_m]);
        }
        refined
    }

    /// Moves `refined`, made without loose points, along what it leaves loose to where most planes find points, as far as `reach_m`, and
    /// sharpens with all of `panel`.
    ///
    /// The few points of a grazed roof that alone hold a height count for nothing among the votes of the walls; but by the
    /// root of its points every plane has a say, and at the right height several find theirs at once.
    pub fn settle(&self, panel: &[u32], refined: Refined, gate_m: f64, reach_m: f64) -> Refined {
        // A finer step than the gate of a loose point is wide: none may fall between.
        let step_m = self.point_sigma_m;
        let steps = (reach_m / step_m).ceil() as i32;
        let spectrum = refined.chart.spectrum(&refined.equations.full());
        let held_m = self.scene.limits.refinement.held_m;
        let mut pose = refined.city_from_level;
        for direction in spectrum.directions().iter().filter(|d| d.sigma_m > held_m) {
            let free = self.without_unmoved(panel, &refined.chart, &pose, direction, gate_m);
            let support = |pose: &Similarity| (self.support(&free, pose, gate_m), *pose);
            let stride = Stride { direction: *direction, offsets_m: Stride::even(step_m, steps) };
            pose = walk(&self.scene.prior, &refined.chart, support(&pose), &[stride], support).1;
        }
        self.sharpen(panel, &pose, gate_m)
    }

    /// Points on planes, each plane counting by the root of its points.
    fn support(&self, panel: &[u32], pose: &Similarity, gate_m: f64) -> f64 {
        let rows = self.probes_on_planes(panel, pose, gate_m);
        rows.chunk_by(|a, b| a.hit.plane == b.hit.plane).map(|p| p.iter().map(|r| r.weight).sum::<f64>().sqrt()).sum()
    }

    /// The panel without the loose points on planes that a motion along `direction` does not leave: they are explained already, and
    /// stray ones beside a wall would hold a roof that is not there.
    fn without_unmoved(
        &self,
        panel: &[u32],
        chart: &Chart,
        pose: &Similarity,
        direction: &Direction,
        gate_m: f64,
    ) -> Vec<u32> {
        let unmoved = self.scene.limits.walk.unmoved_share;
        let mut stays = vec![false; self.scene.votes.probes.len()];
        for row in self.probes_on_planes(panel, pose, gate_m) {
            stays[row.probe as usize] = chart.row(&row.place, &row.hit.normal).dot(&direction.unit).abs() < unmoved;
        }
        panel.iter().copied().filter(|&i| (i as usize) < self.scene.votes.firm || !stays[i as usize]).collect()
    }

    /// The same pose with its information, nothing moved.
    pub fn assess(&self, panel: &[u32], pose: &Similarity, gate_m: f64) -> Refined {
        let chart = self.chart(pose);
        let equations = self.equations(&chart, &self.probes_on_planes(panel, pose, gate_m));
        Refined { city_from_level: *pose, chart, equations }
    }

    /// Which probe of `panel` lies on which plane within `gate_m` (metres of the start), sorted by plane.
    pub fn probes_on_planes(&self, panel: &[u32], pose: &Similarity, gate_m: f64) -> Vec<ProbeOnPlane> {
        let chunk = |panel: &[u32]| self.chunk_on_planes(panel, pose, gate_m * pose.scale);
        let mut rows = panel.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().concat();
        rows.sort_by_key(|r| r.hit.plane);
        rows
    }

    fn chunk_on_planes(&self, panel: &[u32], pose: &Similarity, firm_gate_m: f64) -> Vec<ProbeOnPlane> {
        let (votes, limits) = (&self.scene.votes, &self.scene.limits.refinement);
        let mover = Mover::new(pose);
        let loose_gate_m = firm_gate_m.min(limits.loose_gate_sigmas * self.point_sigma_m);
        let row = |&i: &u32| {
            let probe = mover.probe(&votes.probes[i as usize]);
            let is_firm = (i as usize) < votes.firm;
            let (gate_m, trust) = if is_firm { (firm_gate_m, 1.0) } else { (loose_gate_m, limits.loose_weight) };
            let hit = self.scene.nearest(&probe, gate_m)?;
            let weight = trust * tukey_weight(hit.across_m * hit.across_m, gate_m);
            let lies_on = hit.outside_m <= limits.outside_share * gate_m && weight > 0.0;
            lies_on.then_some(ProbeOnPlane { probe: i, place: probe.position, hit, weight })
        };
        panel.iter().filter_map(row).collect()
    }

    fn equations(&self, chart: &Chart, rows: &[ProbeOnPlane]) -> NormalEquations {
        let mut sums = NormalEquations::default();
        for of_plane in rows.chunk_by(|a, b| a.hit.plane == b.hit.plane) {
            sums.merge(&self.equations_of_plane(chart, of_plane), 1.0);
        }
        sums
    }

    /// What the probes on one plane say, with the model's error common to all of them.
    pub fn equations_of_plane(&self, chart: &Chart, rows: &[ProbeOnPlane]) -> NormalEquations {
        let mut plane = NormalEquations::default();
        let mut count = 0.0;
        for row in rows {
            plane.add(&chart.row(&row.place, &row.hit.normal), row.hit.across_m, row.weight);
            count += row.weight;
        }
        let variance = self.point_sigma_m.powi(2) + count * self.scene.limits.plane_sigma_m.powi(2);
        let mut scaled = NormalEquations::default();
        scaled.merge(&plane, 1.0 / variance);
        scaled
    }

    fn chart(&self, pose: &Similarity) -> Chart {
        let radius = (self.scene.votes.radius_m * pose.scale).max(SMALLEST_RADIUS_M);
        Chart { center: pose.apply(&Point3::origin()), radius, motion: self.motion }
    }
}

/// Standard deviation of the residuals, from their median magnitude; metres.
fn robust_sigma(rows: &[ProbeOnPlane]) -> f64 {
    let mut across: Vec<f64> = rows.iter().map(|r| r.hit.across_m.abs()).collect();
    across.sort_by(f64::total_cmp);
    SIGMA_OF_MEDIAN * across.get(across.len() / 2).copied().unwrap_or(0.0)
}
