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
