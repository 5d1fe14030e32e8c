//! The raster of walls: what a pose looks up.
//!
//! Question     does a wall of this direction and side, as tall as that, stand here; and how often does one by chance?
//! Method       cells of half a metre, one word each: 36 bits say "a wall of this class of direction (10 degrees, by its outward side) within
//!              reach", 7 bits the height of the tallest. How often chance
//!              answers is counted in `chance`

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::blocks::{BLOCK_BITS, Blocks, CELL_M, CELLS_OF_BLOCK};
use super::city_walls::CityWall;
use crate::limits::PlaceSearchLimits;

/// Classes of direction, 10 degrees each.
pub const CLASSES: usize = 36;
/// One step of a cell's height, metres, and the tallest that can be told.
const HEIGHT_STEP_M: f64 = 1.0;
pub const HEIGHTS: usize = 128;

/// Cells of the plan, and for each block of them the classes that any of its cells has.
pub struct Raster {
    blocks: Blocks,
    /// For each place of a block in the tables its number, and below [`CLASSES`] bits the classes of its cells: most questions end here, in a
    /// table a sixty-fourth as long as that of the cells.
    pooled: Vec<u64>,
    cells: Vec<u64>,
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
        let reach_m = limits.near_wall_m;
        let blocks = Blocks::around(walls, reach_m);
        let mut by_block: Vec<BlockWall> = walls
            .par_iter()
            .zip(0..walls.len() as u32)
            .flat_map_iter(|(wall, number)| {
                let blocks = &blocks;
                blocks.near(wall, reach_m).map(move |place| BlockWall {
                    block: blocks.number(place.0, place.1) as u32,
                    number,
                    place,
                })
            })
            .collect();
        by_block.par_sort_unstable();
        let mut cells = vec![0; blocks.count * CELLS_OF_BLOCK];
        let marks: Vec<Mark> = walls.par_iter().map(|wall| Mark::new(wall, limits)).collect();
        // Each block has its walls one after the other, so that blocks are filled independently.
        let of_blocks: Vec<&[BlockWall]> = by_block.chunk_by(|a, b| a.block == b.block).collect();
        let mut filled: Vec<(&[BlockWall], &mut [u64])> = Vec::with_capacity(of_blocks.len());
        let mut rest = cells.chunks_exact_mut(CELLS_OF_BLOCK).enumerate();
        for of_block in of_blocks {
            let own = rest.by_ref().find(|(block, _)| *block == of_block[0].block as usize);
            filled.extend(own.map(|(_, cells)| (of_block, cells)));
        }
        filled.into_par_iter().for_each(|(of_block, cells)| {
            for wall in of_block {
                marks[wall.number as usize].put(wall.place, blocks.low, reach_m, cells);
            }
        });
        let pool = |number: &u32| {
            let first = *number as usize * CELLS_OF_BLOCK;
            let classes = cells[first..first + CELLS_OF_BLOCK].iter().fold(0, |all, word| all | word);
            (u64::from(*number) << CLASSES) | (classes & CLASS_MASK)
        };
        let pooled = blocks.numbers().par_iter().map(pool).collect();
        Raster { low: blocks.low, pooled, cells, blocks }
    }

    /// What each cell has: its classes, and the step of its height.
    pub fn words(&self) -> impl ParallelIterator<Item = (u64, usize)> {
        self.cells.par_iter().filter(|word| **word != 0).map(|word| (word & CLASS_MASK, (word >> CLASSES) as usize))
    }

    /// Whether a wall as asked stands at a place, in cells from the lowest corner.
    #[inline]
    pub fn answers(&self, x: f64, y: f64, question: Question) -> bool {
        let (x, y) = (x as i32 as u32, y as i32 as u32);
        const MASK: u32 = (1 << BLOCK_BITS) - 1;
        let pooled = self.pooled[self.blocks.at(x >> BLOCK_BITS, y >> BLOCK_BITS)];
        if pooled & question.classes == 0 {
            return false;
        }
        let block = (pooled >> CLASSES) as usize;
        let word = self.cells[block * CELLS_OF_BLOCK + (((y & MASK) << BLOCK_BITS) | (x & MASK)) as usize];
        word & question.classes != 0 && word & !CLASS_MASK >= question.height
    }
}

/// A wall that comes near a block: the block's number, the wall's, and the block's column and row.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct BlockWall {
    block: u32,
    number: u32,
    place: (u32, u32),
}

/// What a wall leaves in the cells near it.
struct Mark {
    from: [f64; 2],
    along: [f64; 2],
    length_sq: f64,
    bits: u64,
    height: u64,
}

impl Mark {
    fn new(wall: &CityWall, limits: &PlaceSearchLimits) -> Mark {
        let along = [0, 1].map(|k| wall.to[k] - wall.from[k]);
        Mark {
            from: wall.from,
            along,
            length_sq: along[0] * along[0] + along[1] * along[1],
            bits: classes_near(angle(wall.normal), limits.same_direction_deg.to_radians()),
            height: height_code(wall.height_m()),
        }
    }

    fn put(&self, (x, y): (u32, u32), low: [f64; 2], reach_m: f64, cells: &mut [u64]) {
        let corner = [x, y].map(|i| i << BLOCK_BITS);
        for (cell, word) in cells.iter_mut().enumerate() {
            let at = [cell & ((1 << BLOCK_BITS) - 1), cell >> BLOCK_BITS];
            let middle = [0, 1].map(|k| low[k] + (f64::from(corner[k]) + at[k] as f64 + 0.5) * CELL_M);
            let to = [0, 1].map(|k| middle[k] - self.from[k]);
            let share = ((self.along[0] * to[0] + self.along[1] * to[1]) / self.length_sq).clamp(0.0, 1.0);
            let off = [0, 1].map(|k| to[k] - share * self.along[k]);
            if off[0] * off[0] + off[1] * off[1] <= reach_m * reach_m {
                *word = (*word | self.bits) & CLASS_MASK | (*word & !CLASS_MASK).max(self.height);
            }
        }
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
}
