//! Relief: what stands before and behind the plane of a facade, and where on it keypoints are found.

use super::draws::{between, stream};
use super::house::{Face, Surface};
use crate::geometry::{Point3, Vector3};

/// Keypoints crowd at the edges of windows, within this part of their pitch.
const EDGE: f64 = 0.12;

/// One face's relief. Windows stand in a grid, level and upright.
pub(super) struct Relief {
    /// Level, along the wall.
    along: Vector3<f64>,
    is_wall: bool,
    /// How rich in contrast the face is, 0 to 1.
    texture: f64,
    /// From window to window, along and up, metres, and the share of it that is window.
    pitch_m: [f64; 2],
    phase: [f64; 2],
    window_share: [f64; 2],
    /// How deep windows lie, how far balconies stand out of some columns, and where all of the facade lies: metres outwards.
    recess_m: f64,
    balcony_m: f64,
    cladding_m: f64,
    has_balconies: [bool; 16],
}

impl Relief {
    /// That of face `number`; `level` 1 is usual.
    pub(super) fn new(face: &Face, level: f64, seed: u64, number: usize) -> Relief {
        let mut chance = stream(seed, number as u64);
        let mut drawn = |low: f64, high: f64| between(&mut chance, low, high);
        Relief {
            along: Vector3::z().cross(&face.normal()),
            is_wall: face.surface == Surface::Wall,
            texture: 10f64.powf(drawn(-1.2, 0.0)),
            pitch_m: [drawn(1.8, 4.5), drawn(2.6, 3.4)],
            phase: [drawn(0.0, 1.0), drawn(0.0, 1.0)],
            window_share: [drawn(0.3, 0.6), drawn(0.35, 0.55)],
            recess_m: level * drawn(0.08, 0.35),
            balcony_m: if drawn(0.0, 1.0) < 0.25 * level { drawn(0.4, 1.0) } else { 0.0 },
            // The spread of a uniform number of this width is 0.15 m.
            cladding_m: if drawn(0.0, 1.0) < 0.3 { level * drawn(-0.26, 0.26) } else { 0.0 },
            has_balconies: std::array::from_fn(|_| drawn(0.0, 1.0) < 0.4),
        }
    }

    /// How far before the face its surface stands at a point, and the chance that a keypoint is found there.
    pub(super) fn at(&self, x: &Point3<f64>) -> (f64, f64) {
        if !self.is_wall {
            return (0.0, self.texture);
        }
        let u = self.along.dot(&x.coords) / self.pitch_m[0] + self.phase[0];
        let v = x.z / self.pitch_m[1] + self.phase[1];
        let (column, u, v) = (u.floor().rem_euclid(16.0) as usize, u.rem_euclid(1.0), v.rem_euclid(1.0));
        let is_edge = (u - self.window_share[0]).abs() < EDGE || u < EDGE;
        let found = (self.texture * if is_edge { 1.6 } else { 0.8 }).min(1.0);
        let before_m = if self.balcony_m > 0.0 && self.has_balconies[column] && v < 0.4 {
            self.balcony_m
        } else if u < self.window_share[0] && v < self.window_share[1] {
            self.cladding_m - self.recess_m
        } else {
            self.cladding_m
        };
        (before_m, found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::House;

    #[test]
    fn windows_lie_behind_the_wall_and_without_relief_all_is_flat() {
        let wall = &House::flat([20.0, 8.0, 12.0]).faces[0];
        let places: Vec<Point3<f64>> =
            (0..400).map(|i| Point3::new(f64::from(i % 20), 0.0, f64::from(i / 20) * 0.6)).collect();
        let depths = |level: f64| {
            let relief = Relief::new(wall, level, 3, 1);
            places.iter().map(|x| relief.at(x).0).collect::<Vec<_>>()
        };
        assert!(depths(0.0).iter().all(|d| *d == 0.0));
        let depths = depths(1.0);
        let deepest = depths.iter().copied().fold(f64::INFINITY, f64::min);
        let windows = depths.iter().filter(|d| **d == deepest).count();
        assert!((40..200).contains(&windows), "{windows}");
        assert!(depths.iter().all(|d| *d == deepest || *d >= deepest + 0.08));
    }
}
