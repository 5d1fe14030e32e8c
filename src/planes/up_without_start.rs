//! Which way may be up where no start says anything.
//!
//! Question     under which directions of up shall a reconstruction be sought whose pose is not known at all?
//! Input        patches and the cameras' rotations
//! Output       a few directions, the best supported first; a wrong one costs a search and no more
//! Method       cameras are held level: each up that they allow is made sharp by walls and floors near it. Points alone: the strongest
//!              axes of walls and floors, which have no sign of their own
//! Fails when   a cloud has neither cameras nor walls or floors of some number: then there is no direction

use std::f64::consts::PI;

use super::patches::Patches;
use super::upright::{UpCandidate, Upright, up_candidates, up_of_cameras};
use crate::geometry::Vector3;
use crate::limits::{Limits, UpLimits};

/// The directions to search under.
pub fn up_without_start(patches: &Patches, limits: &Limits) -> Vec<Upright> {
    let ups =
        if patches.cam_from_sfm_rotations.is_empty() { axes(patches, limits) } else { of_cameras(patches, limits) };
    let known = |up: &UpCandidate| up.sigma_rad <= limits.up.known_sigma_rad;
    ups.iter().map(|up| Upright { up: up.up, sigma_rad: up.sigma_rad, known: known(up) }).collect()
}

/// What cameras allow, held to it within what walls and floors may differ by.
fn of_cameras(patches: &Patches, limits: &Limits) -> Vec<UpCandidate> {
    let mut found: Vec<UpCandidate> = Vec::new();
    let mut add = |up: UpCandidate| {
        if found.len() < limits.up.most_known && found.iter().all(|other| other.up.angle(&up.up) > SAME_RAD) {
            found.push(up);
        }
    };
    for of_cameras in up_of_cameras(&patches.cam_from_sfm_rotations, limits) {
        let guess = Upright { up: of_cameras.up, sigma_rad: limits.up.cameras_sigma_rad, known: false };
        let with_walls = up_candidates(patches, &guess, limits);
        if with_walls.is_empty() {
            add(of_cameras);
        }
        with_walls.into_iter().for_each(&mut add);
    }
    found
}

/// The strongest axes of walls and floors, with every sign that is comparable.
fn axes(patches: &Patches, limits: &Limits) -> Vec<UpCandidate> {
    let anywhere = Upright { up: Vector3::z(), sigma_rad: PI, known: false };
    let weak_too = Limits { up: UpLimits { comparable_share: limits.up.axis_share, ..limits.up }, ..*limits };
    let (mut axes, mut found): (Vec<Vector3<f64>>, Vec<UpCandidate>) = (Vec::new(), Vec::new());
    for candidate in up_candidates(patches, &anywhere, &weak_too) {
        // Without walls and floors the guess comes back.
        if candidate.patches <= 0.0 {
            continue;
        }
        let is_along = |axis: &Vector3<f64>| axis.dot(&candidate.up).abs() > SAME_RAD.cos();
        if !axes.iter().any(is_along) {
            let is_near = |axis: &Vector3<f64>| axis.dot(&candidate.up).abs() > AXES_APART_RAD.cos();
            if axes.len() == limits.up.most_known || axes.iter().any(is_near) {
                continue;
            }
            axes.push(candidate.up);
        }
        if found.iter().all(|other| other.up.angle(&candidate.up) > SAME_RAD) {
            found.push(candidate);
        }
    }
    found
}

/// Axes of a town stand across each other: what lies between is one of them, seen with other walls. Chosen.
const AXES_APART_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// Directions nearer than this are one. Chosen: a search lands from there.
const SAME_RAD: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planes::patches;
    use crate::synthetic::{Block, CaptureOptions, CloudOptions, Ring, Survey};

    fn nearest_deg(survey: &Survey) -> f64 {
        let limits = Limits::default();
        let up = survey.city_from_sfm.rotation.inverse() * Vector3::z();
        let ups = up_without_start(&patches(&survey.sfm, None, &limits.patches), &limits);
        assert!(ups.len() <= 2 * limits.up.most_known);
        ups.iter().map(|found| found.up.angle(&up).to_degrees()).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn cameras_and_walls_tell_up_to_a_degree() {
        let block = Block::four_houses();
        let survey = block.capture(&Ring::street(12).stations(&block), &CaptureOptions::default());
        assert!(nearest_deg(&survey) < 1.0);
    }

    #[test]
    fn up_is_among_the_axes_of_points_alone() {
        let options = CloudOptions { points_per_roof: 100, ..CloudOptions::default() };
        assert!(nearest_deg(&Block::four_houses().with_ground().cloud(&options)) < 1.0);
    }

    #[test]
    fn nothing_tells_no_direction() {
        assert!(up_without_start(&Patches::default(), &Limits::default()).is_empty());
    }
}
