//! What may be known of the place beforehand.

use std::f64::consts::{PI, TAU};

use crate::geometry::{Point3, Rotation3, Vector3};

/// Whatever is known; nothing by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlacePrior {
    /// The middle of the reconstruction lies within it.
    pub near: Option<Disc>,
    /// Metres per sfm unit, the least and the most.
    pub scale: Option<[f64; 2]>,
    pub heading: Option<HeadingPrior>,
}

/// A disc in plan; metres of the city.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    pub center: [f64; 2],
    pub radius_m: f64,
}

/// The heading is that of a rotation, or within so much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingPrior {
    pub city_from_sfm: Rotation3<f64>,
    pub within_rad: f64,
}

impl Disc {
    pub fn holds(&self, place: [f64; 2]) -> bool {
        (place[0] - self.center[0]).hypot(place[1] - self.center[1]) <= self.radius_m
    }

    pub fn widened(&self, by_m: f64) -> Disc {
        Disc { radius_m: self.radius_m + by_m, ..*self }
    }

    pub fn meets_box(&self, low: &Point3<f64>, high: &Point3<f64>) -> bool {
        let off = |k: usize| self.center[k] - self.center[k].clamp(low[k], high[k]);
        off(0).hypot(off(1)) <= self.radius_m
    }
}

impl PlacePrior {
    /// The same, in a frame with another origin.
    pub fn relative_to(&self, origin: &Vector3<f64>) -> PlacePrior {
        let moved = |near: Disc| Disc { center: [near.center[0] - origin.x, near.center[1] - origin.y], ..near };
        PlacePrior { near: self.near.map(moved), ..*self }
    }

    /// The turn about z from the level frame to the city that is expected, and how far it may be off.
    pub fn heading_of_level(&self, level_from_sfm: &Rotation3<f64>) -> Option<[f64; 2]> {
        self.heading.map(|heading| {
            let x = heading.city_from_sfm * (level_from_sfm.inverse() * Vector3::x());
            [x.y.atan2(x.x), heading.within_rad]
        })
    }
}

/// An angle brought to -pi to pi.
pub fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn a_disc_meets_a_box_where_it_holds_the_nearest_place_of_it() {
        let mut random = Random::stream(1, 0);
        let mut met = 0;
        for _ in 0..2000 {
            let mut draw = || 10.0 * (random.unit() - 0.5);
            let disc = Disc { center: [draw(), draw()], radius_m: draw().abs() };
            let (a, b) = (Point3::new(draw(), draw(), 0.0), Point3::new(draw(), draw(), 0.0));
            let (low, high) = (a.inf(&b), a.sup(&b));
            let nearest = [0, 1].map(|k| disc.center[k].max(low[k]).min(high[k]));
            assert_eq!(disc.meets_box(&low, &high), disc.holds(nearest), "{disc:?} {low} {high}");
            met += usize::from(disc.meets_box(&low, &high));
        }
        assert!((200..1800).contains(&met), "{met} of 2000");
    }

    #[test]
    fn wrapped_angles_are_the_same_direction_within_half_a_turn() {
        for k in -2000..2000 {
            let angle = 0.013 * f64::from(k);
            let found = wrapped(angle);
            assert!((-PI..=PI).contains(&found), "{angle} became {found}");
            let ((sin, cos), (found_sin, found_cos)) = (angle.sin_cos(), found.sin_cos());
            assert!((sin - found_sin).hypot(cos - found_cos) < 1e-13, "{angle} became {found}");
        }
    }

    #[test]
    fn the_heading_of_the_level_frame_is_what_is_left_of_the_turn() {
        let turn = |angle| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let heading = HeadingPrior { city_from_sfm: turn(2.0), within_rad: 0.1 };
        let prior = PlacePrior { heading: Some(heading), ..PlacePrior::default() };
        let [found, within] = prior.heading_of_level(&turn(0.5)).unwrap();
        assert!((found - 1.5).abs() < 1e-15 && within == 0.1, "{found}");
        assert_eq!(PlacePrior::default().heading_of_level(&turn(0.5)), None);
    }

    #[test]
    fn another_origin_moves_the_disc_and_nothing_else() {
        let disc = Disc { center: [100.0, 200.0], radius_m: 5.0 };
        let prior = PlacePrior { near: Some(disc), scale: Some([1.0, 2.0]), heading: None };
        let moved = prior.relative_to(&Vector3::new(90.0, 150.0, 7.0));
        assert_eq!(moved, PlacePrior { near: Some(Disc { center: [10.0, 50.0], radius_m: 5.0 }), ..prior });
        assert_eq!(disc.widened(2.5).radius_m, 7.5);
    }
}
