use super::*;
use crate::geometry::{Rotation3, Vector3};
use crate::merging::limits::MergeLimits;

fn pose(shift: f64, turn: f64, log_scale: f64) -> Similarity {
    Similarity::about(
        &CENTER,
        &(CENTER + Vector3::new(shift, 0.0, 0.0)),
        log_scale.exp(),
        Rotation3::new(Vector3::new(0.0, turn, 0.0)),
    )
}

const CENTER: Point3<f64> = Point3::new(5.0, -3.0, 2.0);

#[test]
fn two_poses_are_one_place_while_shift_turn_and_scale_are_within_their_limits() {
    let limits = MergeLimits::default().search;
    let same = SamePlace { center_b: CENTER, radius_a: 8.0, limits: &limits };
    let at = pose(0.0, 0.0, 0.0);
    let (shift, turn, scale) = (8.0 * limits.same_shift, limits.same_turn_rad, limits.same_log_scale);
    for share in [-0.95, 0.0, 0.95] {
        assert!(same.holds(&at, &pose(share * shift, share * turn, share * scale)));
    }
    for sign in [-1.05, 1.05] {
        for other in [pose(sign * shift, 0.0, 0.0), pose(0.0, sign * turn, 0.0), pose(0.0, 0.0, sign * scale)] {
            assert!(!same.holds(&at, &other) && !same.holds(&other, &at));
        }
    }
}
