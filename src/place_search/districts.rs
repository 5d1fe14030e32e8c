//! A city in squares that are scanned one after the other.
//!
//! Question     how is a city searched whose raster is larger than memory?
//! Method       squares of eight kilometres; the raster of one holds its own walls and those that a cloud on them reaches. Poses are tied to its
//!              own alone, so that every wall's turn comes once. Most cities are one square

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::city_walls::CityWall;
use crate::limits::PlaceSearchLimits;

/// The walls of a city by districts.
pub struct Districts {
    low: [f64; 2],
    side_m: f64,
    /// Row by row, each in an order that is the same wherever the walls came from.
    by_square: BTreeMap<[i64; 2], Vec<CityWall>>,
}

/// The walls of one district, and then those around it.
pub struct District {
    pub walls: Vec<CityWall>,
    own: usize,
}

/// Walls of a square of so many metres stand one after the other: they look at the same cells. Chosen: half of the cells of a processor's cache.
const TOGETHER_M: f64 = 64.0;

impl Districts {
    pub fn new(walls: Vec<CityWall>, limits: &PlaceSearchLimits) -> Districts {
        let low = [0, 1].map(|k| walls.iter().map(|wall| wall.from[k]).fold(f64::INFINITY, f64::min));
        let square = |at: [f64; 2], side_m: f64| [1, 0].map(|k| ((at[k] - low[k]) / side_m).floor() as i64);
        let side_m = limits.district_m;
        let mut by_square: BTreeMap<[i64; 2], Vec<CityWall>> = BTreeMap::new();
        for wall in walls {
            by_square.entry(square(wall.from, side_m)).or_default().push(wall);
        }
        let order = |a: &CityWall, b: &CityWall| {
            let numbers = |w: &CityWall| [w.from[1], w.from[0], w.to[1], w.to[0], w.foot_m, w.top_m, w.normal[0]];
            let exact = || numbers(a).iter().zip(&numbers(b)).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
            let (a, b) = (square(a.from, TOGETHER_M), square(b.from, TOGETHER_M));
            a.cmp(&b).then_with(|| exact().unwrap_or(std::cmp::Ordering::Equal))
        };
        by_square.values_mut().for_each(|walls| walls.par_sort_unstable_by(order));
        Districts { low, side_m, by_square }
    }

    pub fn count(&self) -> usize {
        self.by_square.len()
    }

    /// The walls of each district.
    pub fn own(&self) -> impl Iterator<Item = &[CityWall]> {
        self.by_square.values().map(Vec::as_slice)
    }

    /// A district by its number, with the walls within `reach_m` of it.
    pub fn with_reach(&self, number: usize, reach_m: f64) -> Option<District> {
        let (square, own) = self.by_square.iter().nth(number)?;
        let low = [0, 1].map(|k| self.low[k] + square[1 - k] as f64 * self.side_m - reach_m);
        let high = low.map(|value| value + self.side_m + 2.0 * reach_m);
        let is_near = |wall: &&CityWall| {
            (0..2).all(|k| wall.from[k].min(wall.to[k]) <= high[k] && wall.from[k].max(wall.to[k]) >= low[k])
        };
        // A wall begins in its square and may end a little beyond it.
        let squares = (reach_m / self.side_m).ceil() as u64 + 1;
        let beside = |other: &[i64; 2]| other != square && (0..2).all(|k| other[k].abs_diff(square[k]) <= squares);
        let others = self.by_square.iter().filter(|(other, _)| beside(other)).flat_map(|(_, walls)| walls);
        let mut walls = own.clone();
        walls.extend(others.filter(is_near));
        Some(District { walls, own: own.len() })
    }
}

impl District {
    /// Those that poses are tied to.
    pub fn own(&self) -> &[CityWall] {
        &self.walls[..self.own]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(x: f64, y: f64) -> CityWall {
        CityWall { from: [x, y], to: [x + 5.0, y], normal: [0.0, -1.0], foot_m: 0.0, top_m: 8.0 }
    }

    #[test]
    fn every_wall_is_of_one_district_and_near_ones_are_seen_across_borders() {
        let limits = PlaceSearchLimits { district_m: 100.0, ..PlaceSearchLimits::default() };
        let walls: Vec<CityWall> = (0..200).map(|k| wall(f64::from(k % 20) * 17.0, f64::from(k / 20) * 31.0)).collect();
        let districts = Districts::new(walls.clone(), &limits);
        assert_eq!((districts.count(), districts.own().map(<[CityWall]>::len).sum::<usize>()), (12, 200));
        for number in 0..districts.count() {
            let district = districts.with_reach(number, 40.0).unwrap();
            for own in district.own() {
                let near = walls.iter().filter(|w| (0..2).all(|k| (w.from[k] - own.from[k]).abs() <= 40.0));
                assert!(near.into_iter().all(|w| district.walls.iter().any(|other| other.from == w.from)));
            }
        }
        assert!(districts.with_reach(districts.count(), 40.0).is_none());
    }

    #[test]
    fn the_order_of_walls_is_their_own_whoever_told_them() {
        let walls: Vec<CityWall> = (0..50).map(|k| wall(f64::from(k * 37 % 50), f64::from(k * 11 % 50))).collect();
        let told = |walls: Vec<CityWall>| {
            let districts = Districts::new(walls, &PlaceSearchLimits::default());
            districts.own().flatten().map(|wall| wall.from).collect::<Vec<_>>()
        };
        assert_eq!(told(walls.clone()), told(walls.into_iter().rev().collect()));
    }
}
