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
use crate::robust::{Chart, NormalEquations, tukey_weight};

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

/// A point whose foot lies farther outside its facet than this share of the gate is not on it.
const OUTSIDE_SHARE: f64 = 0.5;
/// Directions held worse than this are not moved by least squares, metres.
const HELD_M: f64 = 1.0;
/// Loose points, of unknown direction, are taken for a facet's own only this close to it, in sigmas of a point.
const LOOSE_GATE_SIGMAS: f64 = 4.0;
/// Probes per task.
const CHUNK: usize = 512;

/// Refines `pose` with the given gates (metres of the start), one step each, using the probes of `panel`.
pub fn refine(
    scorer: &Scorer,
    planes: &CityPlanes,
    panel: &[u32],
    pose: &Similarity,
    gates_m: &[f64],
    errors: &ErrorModel,
) -> Refined {
    let mut refined =
        Refined { city_from_level: *pose, chart: chart(scorer, pose), equations: NormalEquations::default() };
    for &gate_m in gates_m {
        let pose = refined.city_from_level;
        refined.chart = chart(scorer, &pose);
        refined.equations = equations(scorer, planes, panel, &pose, &refined.chart, gate_m, errors);
        let step = refined.equations.step(HELD_M);
        refined.city_from_level = refined.chart.moved(&pose, &step);
    }
    refined
}

fn chart(scorer: &Scorer, pose: &Similarity) -> Chart {
    Chart { center: pose.apply(&Point3::origin()), radius: (scorer.votes.radius_m * pose.scale).max(1e-9) }
}

/// A probe on a facet: its plane, the row, the residual, the robust weight.
#[derive(Clone)]
struct RowOnPlane {
    plane: PlaneId,
    place: Point3<f64>,
    hit: Hit,
    weight: f64,
}

fn equations(
    scorer: &Scorer,
    planes: &CityPlanes,
    panel: &[u32],
    pose: &Similarity,
    chart: &Chart,
    gate_m: f64,
    errors: &ErrorModel,
) -> NormalEquations {
    let mut rows: Vec<RowOnPlane> = panel
        .par_chunks(CHUNK)
        .map(|chunk| rows(scorer, planes, chunk, pose, gate_m, errors))
        .collect::<Vec<_>>()
        .concat();
    rows.sort_by_key(|r| r.plane);
    let mut sums = NormalEquations::default();
    for of_plane in rows.chunk_by(|a, b| a.plane == b.plane) {
        let mut plane_sums = NormalEquations::default();
        let mut count = 0.0;
        for row in of_plane {
            let triangle = &scorer.field.triangles[row.hit.triangle as usize];
            plane_sums.add(&chart.row(&row.place, &triangle.normal), row.hit.across_m, row.weight);
            count += row.weight;
        }
        let variance = errors.point_sigma_m.powi(2) + count * errors.plane_sigma_m.powi(2);
        sums.merge(&plane_sums, 1.0 / variance);
    }
    sums
}

fn rows(
    scorer: &Scorer,
    planes: &CityPlanes,
    panel: &[u32],
    pose: &Similarity,
    gate_m: f64,
    errors: &ErrorModel,
) -> Vec<RowOnPlane> {
    let mover = Mover::new(pose);
    let gate_m = gate_m * pose.scale;
    let loose_gate_m = gate_m.min(LOOSE_GATE_SIGMAS * errors.point_sigma_m);
    let row = |&i: &u32| {
        let probe = mover.probe(&scorer.votes.probes[i as usize]);
        let gate_m = if (i as usize) < scorer.votes.firm { gate_m } else { loose_gate_m };
        let hit = scorer.field.nearest(&probe, gate_m)?;
        let weight = tukey_weight(hit.across_m * hit.across_m, gate_m);
        let facet = scorer.field.triangles[hit.triangle as usize].facet;
        (hit.outside_m <= OUTSIDE_SHARE * gate_m && weight > 0.0).then(|| RowOnPlane {
            plane: planes.of_facet(facet),
            place: probe.position,
            hit,
            weight,
        })
    };
    panel.iter().filter_map(row).collect()
}
