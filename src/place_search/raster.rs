//! The raster of walls: what a pose looks up.
//!
//! Question     does a wall of this direction and side, as tall as that, stand here; and how often does one by chance?
//! Method       cells of half a metre, one word each: 36 bits say "a wall of this class of direction (10 degrees, by its outward side) within
//!              reach", 7 bits the height of the tallest. Chance is the share of cells in streets that answer so.

use std::f64::consts::TAU;

use super::blocks::{BLOCK_BITS, Blocks, CELL_M, CELLS_OF_BLOCK};
use super::city_walls::CityWall;
use crate::limits::PlaceSearchLimits;

/// Classes of direction, 10 degrees each.
const CLASSES: usize = 36;
/// One step of a cell's height, metres, and the tallest that can be told.
const HEIGHT_STEP_M: f64 = 1.0;
const HEIGHTS: usize = 128;

pub struct Raster {
    blocks: Blocks,
    cells: Vec<u64>,
    /// For each class and height how often a wall of it, so tall at least, is met by chance.
    chance: Vec<[f64; HEIGHTS]>,
    pub low: [f64; 2],
}

/// What is asked of a cell.
#[derive(Clone, Copy, Default)]
pub struct Question {
    /// Any of these classes.
    pub classes: u64,
    /// As [`height_code`] has it, in place.
    pub height: u64,
}

impl Raster {
    pub fn new(walls: &[CityWall], limits: &PlaceSearchLimits) -> Raster {
        let blocks = Blocks::around(walls, limits.near_wall_m);
        let mut raster =
            Raster { cells: vec![0; blocks.count * CELLS_OF_BLOCK], low: blocks.low, blocks, chance: Vec::new() };
        for wall in walls {
            raster.mark(wall, limits);
        }
        raster.count_chance(&Blocks::with_middles_within(walls, limits.street_m));
        raster
    }

    fn mark(&mut self, wall: &CityWall, limits: &PlaceSearchLimits) {
        let bits = classes_near(angle(wall.normal), limits.same_direction_deg.to_radians());
        let height = height_code(wall.height_m());
        for (x, y) in self.blocks.near(wall, limits.near_wall_m) {
            let first = self.blocks.number(x, y) * CELLS_OF_BLOCK;
            let corner = [x, y].map(|i| i << BLOCK_BITS);
            for cell in 0..CELLS_OF_BLOCK {
                let at = [cell & ((1 << BLOCK_BITS) - 1), cell >> BLOCK_BITS];
                let middle = [0, 1].map(|k| self.low[k] + (f64::from(corner[k]) + at[k] as f64 + 0.5) * CELL_M);
                if wall.distance_m(middle) <= limits.near_wall_m {
                    let word = &mut self.cells[first + cell];
                    *word = (*word | bits) & CLASS_MASK | (*word & !CLASS_MASK).max(height);
                }
            }
        }
    }

    fn count_chance(&mut self, street: &Blocks) {
        let mut counts = vec![[0u32; HEIGHTS]; CLASSES];
        for word in &self.cells {
            let (height, mut bits) = ((word >> CLASSES) as usize, word & CLASS_MASK);
            while bits != 0 {
                counts[bits.trailing_zeros() as usize][height] += 1;
                bits &= bits - 1;
            }
        }
        let cells = (street.area_m2() / (CELL_M * CELL_M)).max(1.0);
        let at_least = |of_class: &[u32; HEIGHTS]| {
            let mut taller = 0;
            let mut chance = of_class.map(f64::from);
            for (height, count) in of_class.iter().enumerate().rev() {
                taller += count;
                chance[height] = f64::from(taller) / cells;
            }
            chance
        };
        self.chance = counts.iter().map(at_least).collect();
    }

    /// How often chance answers a question.
    #[inline]
    pub fn chance(&self, question: Question) -> f64 {
        let (mut bits, mut sum) = (question.classes, 0.0);
        while bits != 0 {
            sum += self.chance[bits.trailing_zeros() as usize][(question.height >> CLASSES) as usize];
            bits &= bits - 1;
        }
        sum
    }

    /// Whether a wall as asked stands at a place, in cells from the lowest corner.
    #[inline]
    pub fn answers(&self, x: f64, y: f64, question: Question) -> bool {
        let (x, y) = (x as i32 as u32, y as i32 as u32);
        const MASK: u32 = (1 << BLOCK_BITS) - 1;
        let block = self.blocks.number(x >> BLOCK_BITS, y >> BLOCK_BITS);
        let word = self.cells[block * CELLS_OF_BLOCK + (((y & MASK) << BLOCK_BITS) | (x & MASK)) as usize];
        word & question.classes != 0 && word & !CLASS_MASK >= question.height
    }
}

const CLASS_MASK: u64 = (1 << CLASSES) - 1;

/// A height as cells hold it.
pub fn height_code(height_m: f64) -> u64 {
    ((height_m / HEIGHT_STEP_M).max(0.0) as u64).min(HEIGHTS as u64 - 1) << CLASSES
}

pub fn angle(direction: [f64; 2]) -> f64 {
    direction[1].atan2(direction[0])
}

/// The class that an angle falls in.
fn class_of(angle: f64) -> usize {
    (angle.rem_euclid(TAU) / TAU * CLASSES as f64) as usize % CLASSES
}

/// The classes that a wall of this outward side asks for; both sides where it is not known.
pub fn classes_asked(angle: f64, sided: bool) -> u64 {
    let class = class_of(angle);
    let behind = (class + CLASSES / 2) % CLASSES;
    if sided { 1 << class } else { (1 << class) | (1 << behind) }
}

/// The classes whose middle lies within reach of an angle.
fn classes_near(angle: f64, reach_rad: f64) -> u64 {
    let middle = |class: usize| (class as f64 + 0.5) * TAU / CLASSES as f64;
    let near = |class: &usize| super::prior::wrapped(middle(*class) - angle).abs() <= reach_rad;
    (0..CLASSES).filter(near).fold(0, |bits, class| bits | 1 << class)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall() -> CityWall {
        CityWall { from: [0.0, 0.0], to: [10.0, 0.0], normal: [0.0, -1.0], foot_m: 0.0, top_m: 8.4 }
    }

    #[test]
    fn a_wall_answers_near_it_to_its_own_side_and_height_alone() {
        let raster = Raster::new(&[wall()], &PlaceSearchLimits::default());
        let at = |x: f64, y: f64, class: usize, height_m: f64| {
            let question = Question { classes: 1 << class, height: height_code(height_m) };
            raster.answers((x - raster.low[0]) / CELL_M, (y - raster.low[1]) / CELL_M, question)
        };
        let (south, north) = (class_of(-1.55), class_of(1.55));
        assert!(at(5.0, 0.4, south, 8.0) && at(5.0, -0.4, south, 8.0) && at(0.1, 0.0, south, 0.0));
        assert!(!at(5.0, 0.4, north, 8.0) && !at(5.0, 0.4, south, 9.5));
        assert!(!at(5.0, 2.0, south, 8.0) && !at(50.0, 0.0, south, 8.0) && !at(-1e6, 3e7, south, 0.0));
    }

    #[test]
    fn chance_is_the_share_of_the_street_that_answers() {
        let raster = Raster::new(&[wall()], &PlaceSearchLimits::default());
        // Some 11 x 1.5 m of some 34 x 24 m, in blocks of 4 m.
        let chance = |angle, height_m| {
            raster.chance(Question { classes: classes_asked(angle, true), height: height_code(height_m) })
        };
        assert!(chance(-1.55, 8.0) > 0.008 && chance(-1.55, 8.0) < 0.03, "{}", chance(-1.55, 8.0));
        assert_eq!(chance(-1.55, 9.0), 0.0);
        assert_eq!(chance(0.0, 0.0), 0.0);
    }
}
