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

use super::field::Hit;
use super::scoring::{Mover, Scorer};
use crate::geometry::{Point3, Similarity};
use crate::planes::{CityPlanes, PlaneId};
use crate::robust::{Chart, NormalEquations, Vector7, tukey_weight};

/// How the model errs.
#[derive(Clone, Copy, Debug)]
pub struct ErrorModel {
    /// Noise of one point across its plane, metres.
    pub point_sigma_m: f64,
    /// Error of one plane of the model as a whole, metres.
    pub plane_sigma_m: f64,
}

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
    pub scorer: &'a Scorer<'a>,
    pub planes: &'a CityPlanes,
    pub errors: ErrorModel,
    /// True where the scale is given and must not be moved.
    pub scale_is_fixed: bool,
}

/// A point whose foot lies farther outside its facet than this share of the gate is not on it.
const OUTSIDE_SHARE: f64 = 0.5;
/// Directions held worse than this are not moved by least squares, metres.
const HELD_M: f64 = 1.0;
/// Loose points, of unknown direction, are taken for a facet's own only this close to it, in sigmas of a point ...
const LOOSE_GATE_SIGMAS: f64 = 2.5;
/// ... and count for this much of a patch's point, since many of them lie there by chance.
const LOOSE_WEIGHT: f64 = 0.25;
/// Probes per task.
const CHUNK: usize = 512;

/// A probe on a facet.
#[derive(Clone, Copy, Debug)]
pub struct ProbeOnPlane {
    /// Index into the votes' probes.
    pub probe: u32,
    pub plane: PlaneId,
    /// In the city.
    pub place: Point3<f64>,
    pub hit: Hit,
    /// Tukey's weight of the residual.
    pub weight: f64,
}

impl Refiner<'_> {
    /// Refines `pose` with the given gates (metres of the start), one step each, using the probes of `panel`.
    pub fn refine(&self, panel: &[u32], pose: &Similarity, gates_m: &[f64]) -> Refined {
        let mut pose = *pose;
        let mut refined =
            Refined { city_from_level: pose, chart: self.chart(&pose), equations: NormalEquations::default() };
        for &gate_m in gates_m {
            let chart = self.chart(&pose);
            let rows = self.probes_on_planes(panel, &pose, gate_m);
            let equations = self.equations(&chart, &rows);
            pose = chart.moved(&pose, &equations.step(HELD_M));
            refined = Refined { city_from_level: pose, chart, equations };
        }
        refined
    }

    /// Refines `pose` with a gate that follows the residuals: Tukey's width for their robust sigma, at most `gate_m` (metres of
    /// the start).
    pub fn sharpen(&self, panel: &[u32], pose: &Similarity, gate_m: f64) -> Refined {
        let mut refined = self.refine(panel, pose, &[gate_m]);
        for _ in 0..SHARPENING_STEPS {
            let pose = refined.city_from_level;
            let rows = self.probes_on_planes(panel, &pose, gate_m);
            let narrow_m = (TUKEY_SIGMAS * robust_sigma(&rows) / pose.scale).clamp(LEAST_GATE_SHARE * gate_m, gate_m);
            refined = self.refine(panel, &pose, &[narrow_m]);
        }
        refined
    }

    /// Slides `refined`, made without loose points, along what it leaves loose to where most planes find points, as far as `reach_m`, and sharpens with
    /// all of `panel`.
    ///
    /// The few points of a grazed roof that alone hold a height count for nothing among the votes of the walls; but by the
    /// root of its points every plane has a say, and at the right height several find theirs at once.
    pub fn settle(&self, panel: &[u32], refined: Refined, gate_m: f64, reach_m: f64) -> Refined {
        let spectrum = refined.equations.spectrum();
        // A finer step than the gate of a loose point is wide: none may fall between.
        let step_m = self.errors.point_sigma_m;
        let steps = (reach_m / step_m).ceil() as i32;
        let support = |panel: &[u32], pose: &Similarity| -> f64 {
            let rows = self.probes_on_planes(panel, pose, gate_m);
            rows.chunk_by(|a, b| a.plane == b.plane).map(|p| p.iter().map(|r| r.weight).sum::<f64>().sqrt()).sum()
        };
        let start = refined.city_from_level;
        let mut best = start;
        let mut open: Vec<usize> = (0..7).filter(|&k| spectrum.sigmas_m[k] > HELD_M).collect();
        open.sort_by(|&a, &b| spectrum.sigmas_m[b].total_cmp(&spectrum.sigmas_m[a]));
        for k in open {
            let direction = spectrum.directions.column(k).into_owned();
            let free = self.without_bystanders(panel, &refined.chart, &best, &direction, gate_m);
            let from = best;
            let mut most = support(&free, &from);
            for step in (-steps..=steps).filter(|s| *s != 0) {
                let pose = refined.chart.moved(&from, &(direction * (f64::from(step) * step_m)));
                let found = support(&free, &pose);
                if found > most && self.scorer.within_reach(&pose) {
                    (most, best) = (found, pose);
                }
            }
        }
        self.sharpen(panel, &best, gate_m)
    }

    /// The panel without the loose points on planes that a motion along `direction` does not leave: they are explained already.
    fn without_bystanders(
        &self,
        panel: &[u32],
        chart: &Chart,
        pose: &Similarity,
        direction: &Vector7,
        gate_m: f64,
    ) -> Vec<u32> {
        let mut stays = vec![false; self.scorer.votes.probes.len()];
        for row in self.probes_on_planes(panel, pose, gate_m) {
            let normal = &self.scorer.field.triangles[row.hit.triangle as usize].normal;
            stays[row.probe as usize] = chart.row(&row.place, normal).dot(direction).abs() < BYSTANDER;
        }
        panel.iter().copied().filter(|&i| (i as usize) < self.scorer.votes.firm || !stays[i as usize]).collect()
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
        rows.sort_by_key(|r| r.plane);
        rows
    }

    fn chunk_on_planes(&self, panel: &[u32], pose: &Similarity, firm_gate_m: f64) -> Vec<ProbeOnPlane> {
        let Scorer { votes, field, .. } = self.scorer;
        let mover = Mover::new(pose);
        let loose_gate_m = firm_gate_m.min(LOOSE_GATE_SIGMAS * self.errors.point_sigma_m);
        let row = |&i: &u32| {
            let probe = mover.probe(&votes.probes[i as usize]);
            let is_firm = (i as usize) < votes.firm;
            let (gate_m, trust) = if is_firm { (firm_gate_m, 1.0) } else { (loose_gate_m, LOOSE_WEIGHT) };
            let hit = field.nearest(&probe, gate_m)?;
            let weight = trust * tukey_weight(hit.across_m * hit.across_m, gate_m);
            let plane = self.planes.of_facet(field.triangles[hit.triangle as usize].facet);
            (hit.outside_m <= OUTSIDE_SHARE * gate_m && weight > 0.0).then_some(ProbeOnPlane {
                probe: i,
                plane,
                place: probe.position,
                hit,
                weight,
            })
        };
        panel.iter().filter_map(row).collect()
    }

    fn equations(&self, chart: &Chart, rows: &[ProbeOnPlane]) -> NormalEquations {
        let mut sums = NormalEquations::default();
        for of_plane in rows.chunk_by(|a, b| a.plane == b.plane) {
            sums.merge(&self.equations_of_plane(chart, of_plane), 1.0);
        }
        sums
    }

    /// What the probes on one plane say, with the model's error common to all of them.
    pub fn equations_of_plane(&self, chart: &Chart, rows: &[ProbeOnPlane]) -> NormalEquations {
        let mut plane = NormalEquations::default();
        let mut count = 0.0;
        for row in rows {
            let normal = &self.scorer.field.triangles[row.hit.triangle as usize].normal;
            let mut jacobian = chart.row(&row.place, normal);
            if self.scale_is_fixed {
                jacobian[6] = 0.0;
            }
            plane.add(&jacobian, row.hit.across_m, row.weight);
            count += row.weight;
        }
        let variance = self.errors.point_sigma_m.powi(2) + count * self.errors.plane_sigma_m.powi(2);
        let mut scaled = NormalEquations::default();
        scaled.merge(&plane, 1.0 / variance);
        scaled
    }

    fn chart(&self, pose: &Similarity) -> Chart {
        let radius = (self.scorer.votes.radius_m * pose.scale).max(SMALLEST_RADIUS_M);
        Chart { center: pose.apply(&Point3::origin()), radius }
    }
}

/// Standard deviation of the residuals, from their median magnitude; metres.
fn robust_sigma(rows: &[ProbeOnPlane]) -> f64 {
    let mut across: Vec<f64> = rows.iter().map(|r| r.hit.across_m.abs()).collect();
    across.sort_by(f64::total_cmp);
    1.4826 * across.get(across.len() / 2).copied().unwrap_or(0.0)
}

/// Tukey's biweight of this width (in sigmas) is 95 % efficient on Gaussian noise.
const TUKEY_SIGMAS: f64 = 4.685;
/// The narrowest gate, as a share of the widest.
const LEAST_GATE_SHARE: f64 = 0.2;
/// Pairs settle within some steps.
const SHARPENING_STEPS: usize = 5;

/// A plane whose distance changes by less than this share of a motion is not left by it.
const BYSTANDER: f64 = 0.3;

/// A cloud smaller than this has no turn or scale to speak of.
const SMALLEST_RADIUS_M: f64 = 1e-3;
