//! Blocks of plan, 4 m wide, kept where there are walls only.
//!
//! Question     which block does a place lie in, in a city of any extent?
//! Method       two tables: tiles of 64 x 64 blocks over the box of the city, blocks within those tiles that hold any. A building astray in
//!              the coordinates costs one tile

use super::city_walls::CityWall;

/// Side of a cell of the raster, metres; the reach of "near a wall" is three of them.
pub const CELL_M: f64 = 0.5;
/// A block is 2^3 cells wide, a tile 2^6 blocks.
pub const BLOCK_BITS: u32 = 3;
const TILE_BITS: u32 = 6;
pub const CELLS_OF_BLOCK: usize = 1 << (2 * BLOCK_BITS);
const BLOCKS_OF_TILE: usize = 1 << (2 * TILE_BITS);
const BLOCK_M: f64 = CELL_M * (1 << BLOCK_BITS) as f64;
const HALF_DIAGONAL_M: f64 = BLOCK_M * std::f64::consts::FRAC_1_SQRT_2;

/// Numbers of the blocks near walls; 0 is no block.
pub struct Blocks {
    /// Of the lowest corner, metres.
    pub low: [f64; 2],
    columns: u32,
    rows: u32,
    /// Numbers of tiles, row by row; tile 0 is empty.
    tiles: Vec<u32>,
    /// Numbers of blocks, tile by tile.
    blocks: Vec<u32>,
    pub count: usize,
}

impl Blocks {
    /// Blocks whose middle lies within so much of a wall.
    pub fn with_middles_within(walls: &[CityWall], reach_m: f64) -> Blocks {
        Blocks::around(walls, (reach_m - HALF_DIAGONAL_M).max(0.0))
    }

    /// Blocks for what lies within `margin_m` of the walls.
    pub fn around(walls: &[CityWall], margin_m: f64) -> Blocks {
        let ends = || walls.iter().flat_map(|w| [w.from, w.to]);
        let bound = |k: usize, pick: fn(f64, f64) -> f64, start: f64| ends().map(|e| e[k]).fold(start, pick);
        let low = [0, 1].map(|k| bound(k, f64::min, f64::INFINITY) - margin_m - BLOCK_M);
        let size = |k: usize| bound(k, f64::max, f64::NEG_INFINITY) + margin_m + BLOCK_M - low[k];
        let tiles = |k: usize| (size(k) / (BLOCK_M * f64::from(1 << TILE_BITS))).ceil().max(1.0) as u32;
        let (columns, rows) = if walls.is_empty() { (1, 1) } else { (tiles(0), tiles(1)) };
        let low = if walls.is_empty() { [0.0; 2] } else { low };
        let mut blocks = Blocks {
            low,
            columns,
            rows,
            tiles: vec![0; columns as usize * rows as usize],
            blocks: vec![0; BLOCKS_OF_TILE],
            count: 1,
        };
        for wall in walls {
            for (x, y) in blocks.near(wall, margin_m) {
                blocks.open(x, y);
            }
        }
        blocks
    }

    /// Columns and rows of the blocks with anything within `margin_m` of a wall, some others among them.
    pub fn near<'w>(&self, wall: &'w CityWall, margin_m: f64) -> impl Iterator<Item = (u32, u32)> + use<'w> {
        let low = self.low;
        let index = move |k: usize, at: f64| ((at - low[k]) / BLOCK_M).max(0.0) as u32;
        let span = move |k: usize| {
            let (a, b) = (wall.from[k].min(wall.to[k]), wall.from[k].max(wall.to[k]));
            index(k, a - margin_m)..=index(k, b + margin_m)
        };
        let reach_m = margin_m + HALF_DIAGONAL_M;
        let middle = move |k: usize, i: u32| low[k] + (f64::from(i) + 0.5) * BLOCK_M;
        span(1)
            .flat_map(move |y| span(0).map(move |x| (x, y)))
            .filter(move |&(x, y)| wall.distance_m([middle(0, x), middle(1, y)]) <= reach_m)
    }

    fn open(&mut self, x: u32, y: u32) {
        let tile = &mut self.tiles[((y >> TILE_BITS) * self.columns + (x >> TILE_BITS)) as usize];
        if *tile == 0 {
            *tile = (self.blocks.len() / BLOCKS_OF_TILE) as u32;
            self.blocks.resize(self.blocks.len() + BLOCKS_OF_TILE, 0);
        }
        let block = &mut self.blocks[*tile as usize * BLOCKS_OF_TILE + in_tile(x, y)];
        if *block == 0 {
            *block = self.count as u32;
            self.count += 1;
        }
    }

    /// The number of a block by its column and row.
    #[inline]
    pub fn number(&self, x: u32, y: u32) -> usize {
        self.blocks[self.at(x, y)] as usize
    }

    /// Where the number of a block stands in [`Blocks::numbers`].
    #[inline]
    pub fn at(&self, x: u32, y: u32) -> usize {
        let (column, row) = (x >> TILE_BITS, y >> TILE_BITS);
        if column >= self.columns || row >= self.rows {
            return 0;
        }
        let tile = self.tiles[(row * self.columns + column) as usize] as usize;
        tile * BLOCKS_OF_TILE + in_tile(x, y)
    }

    /// Numbers of the blocks, tile by tile; those of the first tile, and of places that are far from walls, are 0.
    pub fn numbers(&self) -> &[u32] {
        &self.blocks
    }

    /// The block that a place lies in.
    pub fn of(&self, place: [f64; 2]) -> usize {
        let index = |k: usize| (place[k] - self.low[k]) / BLOCK_M;
        if index(0) < 0.0 || index(1) < 0.0 { 0 } else { self.number(index(0) as u32, index(1) as u32) }
    }

    pub fn area_m2(&self) -> f64 {
        (self.count - 1) as f64 * BLOCK_M * BLOCK_M
    }
}

#[inline]
fn in_tile(x: u32, y: u32) -> usize {
    const MASK: u32 = (1 << TILE_BITS) - 1;
    (((y & MASK) << TILE_BITS) | (x & MASK)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn walls(random: &mut Random, count: usize) -> Vec<CityWall> {
        let mut draw = |width: f64| width * (random.unit() - 0.5);
        let wall = |_| {
            let from = [draw(900.0), draw(700.0)];
            let to = [from[0] + draw(60.0), from[1] + draw(60.0)];
            CityWall { from, to, normal: [1.0, 0.0], foot_m: 0.0, top_m: 10.0 }
        };
        (0..count).map(wall).collect()
    }

    #[test]
    fn every_place_near_a_wall_has_a_block_and_blocks_have_numbers_of_their_own() {
        let mut random = Random::stream(2, 0);
        let walls = walls(&mut random, 40);
        let blocks = Blocks::around(&walls, 6.0);
        let mut corner_of = std::collections::HashMap::new();
        let mut near = 0;
        for _ in 0..20_000 {
            let place = [1100.0 * (random.unit() - 0.5), 900.0 * (random.unit() - 0.5)];
            let number = blocks.of(place);
            assert!(number < blocks.count);
            if walls.iter().any(|wall| wall.distance_m(place) <= 6.0) {
                near += 1;
                assert!(number > 0, "{place:?} is near a wall and in no block");
            }
            let corner = [0, 1].map(|k| ((place[k] - blocks.low[k]) / BLOCK_M).floor() as i64);
            if number > 0 {
                assert_eq!(*corner_of.entry(number).or_insert(corner), corner, "block {number} is in two places");
            }
        }
        assert!(near > 200, "{near}");
        assert_eq!(blocks.area_m2(), (blocks.count - 1) as f64 * BLOCK_M * BLOCK_M);
    }

    #[test]
    fn there_is_no_block_without_walls_nor_beyond_them() {
        let none = Blocks::around(&[], 6.0);
        assert_eq!((none.of([0.0, 0.0]), none.of([-1e9, 1e9]), none.count), (0, 0, 1));
        let blocks = Blocks::around(&walls(&mut Random::stream(2, 1), 3), 6.0);
        for far in [[1e7, 0.0], [0.0, -1e7], [f64::MAX, f64::MAX], [f64::NEG_INFINITY, 0.0]] {
            assert_eq!(blocks.of(far), 0, "{far:?}");
        }
    }
}
