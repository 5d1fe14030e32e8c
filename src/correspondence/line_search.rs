//! Along the ways in which a pose may move: to the best of the places that lie there.
//!
//! Question     where along a direction does the pose explain most?
//! Method       the pose is moved by each offset along the direction and valued, in parallel; the best wins, the nearest of equals.
//!              Three searches use it: along what the data hold loosely, by the score ([`search_weak_directions`]); along all directions at once into
//!              neighbouring basins, each place refined first ([`basin_hopping`]; basin hopping, Wales and Doye 1997, with fixed moves instead of random ones);
//!              and along what nothing holds, by the planes that find points ([`search_free_directions`])
//! Why          a wall's top and foot tell the height softly, which says nothing to a least-squares step; a prior inside Gauss-Newton
//!              would drag the pose off its facets. And facades have several parallel planes some decimetres apart: a cloud may
//!              settle with some of its patches one plane off, held as firmly as at the right place

use rayon::prelude::*;

use super::prior::Prior;
use super::refine::{PoseRefiner, RefinedPose};
use super::scene::Scene;
use crate::geometry::Similarity;
use crate::robust::{Direction, MotionParameters, Spectrum};

/// Places along a direction.
pub(super) struct Stride {
    pub direction: Direction,
    /// Metres at the motion's radius.
    pub offsets_m: Vec<f64>,
}

impl Stride {
    /// So many even steps to either side, the nearest first.
    pub fn even(step_m: f64, steps: i32) -> Vec<f64> {
        (1..=steps).flat_map(|k| [f64::from(k) * step_m, -f64::from(k) * step_m]).collect()
    }
}

/// A pose and what it is worth.
pub(super) type Valued = (f64, Similarity);

/// The best of `from` and the places of some strides from it; `value` gives what a place is worth and the pose to go on with from
/// there. Places beyond the prior's reach do not count.
pub(super) fn line_search(
    prior: &Prior,
    parameters: &MotionParameters,
    from: Valued,
    strides: &[Stride],
    value: impl Fn(&Similarity) -> Valued + Sync,
) -> Valued {
    let place = |(direction, offset_m): (&Direction, f64)| {
        let moved = parameters.moved(&from.1, &(direction.unit * offset_m));
        let valued = prior.reaches(&moved).then(|| value(&moved));
        valued.filter(|(_, pose)| prior.reaches(pose))
    };
    let all = strides.iter().flat_map(|s| s.offsets_m.iter().map(|offset_m| (&s.direction, *offset_m)));
    let places: Vec<Option<Valued>> = all.collect::<Vec<_>>().into_par_iter().map(place).collect();
    places.into_iter().flatten().fold(from, |best, place| if place.0 > best.0 { place } else { best })
}

/// The pose after a search along each loose direction in turn, by the score of `point_subset` within `gate_m`.
pub fn search_weak_directions(
    scene: &Scene,
    point_subset: &[u32],
    parameters: &MotionParameters,
    spectrum: &Spectrum,
    pose: &Similarity,
    gate_m: f64,
) -> Similarity {
    let limits = &scene.limits.line_search;
    let step_m = limits.step_of_gate * gate_m;
    let value = |pose: &Similarity| (scene.score(point_subset, pose, gate_m), *pose);
    let mut loose = spectrum.directions().iter().filter(|d| d.sigma_m > limits.loose_m).peekable();
    if loose.peek().is_none() {
        return *pose;
    }
    let moved = loose.fold(value(pose), |best, direction| {
        // A loose direction that is held a little ends where its own sigmas end.
        let steps = (scene.limits.reach_sigmas * direction.sigma_m / step_m).min(f64::from(limits.most_steps)).ceil();
        let stride = Stride { direction: *direction, offsets_m: Stride::even(step_m, steps as i32) };
        line_search(&scene.prior, parameters, best, &[stride], value)
    });
    moved.1
}

/// The best pose about `pose` in its own basin and those beside it, by the score of `point_subset`.
pub fn basin_hopping(refiner: &PoseRefiner, point_subset: &[u32], pose: &Similarity) -> Similarity {
    let scene = refiner.scene;
    let (limits, gate_unit_m) = (&scene.limits.line_search, scene.gate_unit_m);
    let gates_m = limits.basin_gates_units.map(|g| g * gate_unit_m);
    let refined = |pose: &Similarity| {
        let refined = refiner.refine(point_subset, pose, &gates_m);
        ((scene.score(point_subset, &refined.city_from_level, gate_unit_m), refined.city_from_level), refined)
    };
    let offsets_m = limits.basin_moves_units.map(|units| units * gate_unit_m).to_vec();
    let (mut best, mut from) = refined(pose);
    for _ in 0..limits.most_rounds {
        let begun = best;
        let spectrum = from.parameters.spectrum(&from.equations.full());
        let stride = |direction: &Direction| Stride { direction: *direction, offsets_m: offsets_m.clone() };
        let strides: Vec<Stride> = spectrum.directions().iter().map(stride).collect();
        best = line_search(&scene.prior, &from.parameters, best, &strides, |pose| refined(pose).0);
        if best.1 == begun.1 {
            break;
        }
        from = refined(&best.1).1;
    }
    best.1
}

/// Moves `refined`, made without loose points, along what it leaves loose to where most planes find points, as far as `reach_m`, and
/// sharpens with all of `point_subset`.
///
/// The few points of a grazed roof that alone hold a height count for nothing among the points of the walls; but by the
/// root of its points every plane has a say, and at the right height several find theirs at once.
pub fn search_free_directions(
    refiner: &PoseRefiner,
    point_subset: &[u32],
    refined: RefinedPose,
    gate_m: f64,
    reach_m: f64,
) -> RefinedPose {
    // A finer step than the gate of a loose point is wide: none may fall between.
    let step_m = refiner.point_sigma_m;
    let steps = (reach_m / step_m).ceil() as i32;
    let spectrum = refined.parameters.spectrum(&refined.equations.full());
    let most_sigma_m = refiner.scene.limits.refinement.most_sigma_m;
    let mut pose = refined.city_from_level;
    for direction in spectrum.directions().iter().filter(|d| d.sigma_m > most_sigma_m) {
        let free = without_unmoved(refiner, point_subset, &refined.parameters, &pose, direction, gate_m);
        let support = |pose: &Similarity| (planes_with_points(refiner, &free, pose, gate_m), *pose);
        let stride = Stride { direction: *direction, offsets_m: Stride::even(step_m, steps) };
        pose = line_search(&refiner.scene.prior, &refined.parameters, support(&pose), &[stride], support).1;
    }
    refiner.sharpen(point_subset, &pose, gate_m)
}

/// Points on planes, each plane counting by the root of its points.
pub(super) fn planes_with_points(refiner: &PoseRefiner, point_subset: &[u32], pose: &Similarity, gate_m: f64) -> f64 {
    let rows = refiner.point_plane_matches(point_subset, pose, gate_m);
    rows.chunk_by(|a, b| a.hit.plane == b.hit.plane).map(|p| p.iter().map(|r| r.weight).sum::<f64>().sqrt()).sum()
}

/// The point subset without the loose points on planes that a motion along `direction` does not leave: they are explained already, and
/// stray ones beside a wall would hold a roof that is not there.
fn without_unmoved(
    refiner: &PoseRefiner,
    point_subset: &[u32],
    parameters: &MotionParameters,
    pose: &Similarity,
    direction: &Direction,
    gate_m: f64,
) -> Vec<u32> {
    let unmoved = refiner.scene.limits.line_search.unmoved_share;
    let mut stays = vec![false; refiner.scene.level_cloud.sample_points.len()];
    for row in refiner.point_plane_matches(point_subset, pose, gate_m) {
        stays[row.sample_point as usize] =
            parameters.row(&row.place, &row.hit.normal).dot(&direction.unit).abs() < unmoved;
    }
    point_subset
        .iter()
        .copied()
        .filter(|&i| (i as usize) < refiner.scene.level_cloud.patch_points || !stays[i as usize])
        .collect()
}

#[cfg(test)]
mod tests;
