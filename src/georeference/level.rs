//! Up in the reconstruction's frame, from gravity or from how cameras are held.
//!
//! A similarity with seven freedoms from positions leaves the roll about their line open: with the noise of phones it tilts a street by 25
//! degrees in the mean. Cameras are held level, or turned by a quarter: that gives up to 0.3 to 0.8 degrees.

use super::matched::Matched;
use crate::geometry::{Rotation3, Vector3};
use crate::limits::Limits;
use crate::planes::up_of_cameras;
use crate::reconstruction::Reconstruction;

/// A direction that up may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levelled {
    /// Unit, sfm frame.
    pub up: Vector3<f64>,
    pub sigma_rad: f64,
}

/// Cameras that were held level, all alike a little askew: one sigma. Measured on simulated captures: 0.3 to 0.8 degrees.
const HELD_LEVEL_RAD: f64 = 1.5 * std::f64::consts::PI / 180.0;
/// What a phone's or drone's gravity is off by, all alike. Chosen.
const GRAVITY_RAD: f64 = 1.0 * std::f64::consts::PI / 180.0;
/// A single reading of gravity further than this from the others is left out, radians. Chosen: of a camera that was shaken.
const LARGEST_SCATTER_RAD: f64 = 0.2;
/// Fewer readings are no majority.
const LEAST_READINGS: usize = 2;

/// Directions that up may have; by gravity there is one.
pub(super) fn levelled(matched: &[Matched], sfm: &Reconstruction, limits: &Limits) -> Vec<Levelled> {
    let readings = matched.iter().filter_map(|m| {
        let gravity = Vector3::from(m.gravity_in_cam?).try_normalize(0.0)?;
        Some(-(sfm.images[m.image.0 as usize].cam_from_sfm_rotation.inverse() * gravity))
    });
    if let Some(by_gravity) = by_gravity(&readings.collect::<Vec<_>>()) {
        return vec![by_gravity];
    }
    let rotations: Vec<Rotation3<f64>> = sfm.images.iter().map(|image| image.cam_from_sfm_rotation).collect();
    let levelled = |c: &crate::planes::UpCandidate| Levelled { up: c.up, sigma_rad: c.sigma_rad.max(HELD_LEVEL_RAD) };
    up_of_cameras(&rotations, limits).iter().map(levelled).collect()
}

/// The mean of the readings near the one that most are near to.
fn by_gravity(readings: &[Vector3<f64>]) -> Option<Levelled> {
    let near = |a: &Vector3<f64>| readings.iter().filter(|b| a.angle(b) <= LARGEST_SCATTER_RAD).count();
    // The first of the best, whatever the order in which maxima are kept.
    let best = readings.iter().rev().max_by_key(|a| near(a))?;
    let count = near(best);
    if count < LEAST_READINGS || 2 * count < readings.len() {
        return None;
    }
    let agreeing = || readings.iter().filter(|b| best.angle(b) <= LARGEST_SCATTER_RAD);
    let up = agreeing().sum::<Vector3<f64>>().try_normalize(0.0)?;
    let scatter_sq = agreeing().map(|b| up.angle(b).powi(2)).sum::<f64>() / (2.0 * count as f64);
    Some(Levelled { up, sigma_rad: GRAVITY_RAD.hypot((scatter_sq / count as f64).sqrt()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted(degrees: f64) -> Vector3<f64> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vector3::new(sin, 0.0, cos)
    }

    #[test]
    fn gravity_is_the_mean_of_readings_that_agree() {
        let level = by_gravity(&[tilted(-1.0), tilted(1.0), tilted(3.0)]).unwrap();
        assert!(level.up.angle(&tilted(1.0)) < 1e-6, "{}", level.up);
        // Never surer than the instrument, however well readings agree.
        assert!(by_gravity(&[tilted(0.0); 9]).unwrap().sigma_rad >= GRAVITY_RAD);
        assert!(level.sigma_rad > GRAVITY_RAD);
    }

    #[test]
    fn a_shaken_camera_is_left_out() {
        let level = by_gravity(&[tilted(90.0), tilted(0.0), tilted(0.0), tilted(180.0)]).unwrap();
        assert!(level.up.angle(&tilted(0.0)) < 1e-6, "{}", level.up);
    }

    #[test]
    fn readings_without_a_majority_tell_nothing() {
        assert!(by_gravity(&[]).is_none());
        assert!(by_gravity(&[tilted(0.0)]).is_none());
        assert!(by_gravity(&[tilted(0.0), tilted(90.0)]).is_none());
        assert!(by_gravity(&[tilted(0.0), tilted(0.0), tilted(60.0), tilted(90.0), tilted(120.0)]).is_none());
    }
}
