//! How often chance answers a question that is asked of the raster.
//!
//! Question     in which share of the places in streets does a wall of this direction and side, as tall as that, stand?
//! Method       cells are counted by class and height, districts of a city one after the other; the street is all that lies near a wall

use rayon::prelude::*;

use super::blocks::{Blocks, CELL_M};
use super::city_walls::CityWall;
use super::raster::{CLASSES, HEIGHTS, Question, Raster};
use crate::limits::PlaceSearchLimits;

/// Cells of each class and height, and all cells in streets; of any part of a city.
pub struct CellCounts {
    of_class: Vec<[u64; HEIGHTS]>,
    street: f64,
}

/// For each class and height how often a wall of it, so tall at least, is met by chance.
pub struct Chance(Vec<[f64; HEIGHTS]>);

impl CellCounts {
    pub fn none() -> CellCounts {
        CellCounts { of_class: vec![[0; HEIGHTS]; CLASSES], street: 0.0 }
    }

    pub fn of(raster: &Raster, walls: &[CityWall], limits: &PlaceSearchLimits) -> CellCounts {
        let count = |mut counts: CellCounts, (mut bits, height): (u64, usize)| {
            while bits != 0 {
                counts.of_class[bits.trailing_zeros() as usize][height] += 1;
                bits &= bits - 1;
            }
            counts
        };
        let counts = raster.words().fold(CellCounts::none, count).reduce(CellCounts::none, CellCounts::with);
        let street = Blocks::with_middles_within(walls, limits.street_m).area_m2() / (CELL_M * CELL_M);
        CellCounts { street, ..counts }
    }

    pub fn with(mut self, other: CellCounts) -> CellCounts {
        let pairs = self.of_class.iter_mut().flatten().zip(other.of_class.iter().flatten());
        pairs.for_each(|(own, other)| *own += other);
        self.street += other.street;
        self
    }

    pub fn chance(&self) -> Chance {
        let at_least = |of_class: &[u64; HEIGHTS]| {
            let mut taller = 0;
            let mut chance = [0.0; HEIGHTS];
            for (height, count) in of_class.iter().enumerate().rev() {
                taller += count;
                chance[height] = taller as f64 / self.street.max(1.0);
            }
            chance
        };
        Chance(self.of_class.iter().map(at_least).collect())
    }
}

impl Chance {
    /// How often chance answers a question.
    #[inline]
    pub fn of(&self, question: Question) -> f64 {
        let (mut bits, mut sum) = (question.classes, 0.0);
        while bits != 0 {
            sum += self.0[bits.trailing_zeros() as usize][(question.height >> CLASSES) as usize];
            bits &= bits - 1;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::super::raster::{classes_asked, height_code};
    use super::*;

    #[test]
    fn chance_is_the_share_of_the_street_that_answers() {
        let wall = CityWall { from: [0.0, 0.0], to: [10.0, 0.0], normal: [0.0, -1.0], foot_m: 0.0, top_m: 8.4 };
        let limits = PlaceSearchLimits::default();
        let counts = CellCounts::of(&Raster::new(&[wall], &limits), &[wall], &limits);
        // Some 11 x 1.5 m of some 34 x 24 m, in blocks of 4 m.
        let chance = |angle, height_m| {
            counts.chance().of(Question { classes: classes_asked(angle, true), height: height_code(height_m) })
        };
        assert!(chance(-1.55, 8.0) > 0.008 && chance(-1.55, 8.0) < 0.03, "{}", chance(-1.55, 8.0));
        assert_eq!(chance(-1.55, 9.0), 0.0);
        assert_eq!(chance(0.0, 0.0), 0.0);
    }
}
