//! Which walls stand near a place.

use super::blocks::Blocks;
use super::city_walls::CityWall;

/// The walls by the blocks that they are near to.
pub struct WallIndex {
    pub walls: Vec<CityWall>,
    blocks: Blocks,
    /// For each block where its walls begin in `listed`, and where the last one's end.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

impl WallIndex {
    /// An index that knows all walls within `reach_m` of any place.
    pub fn new(walls: Vec<CityWall>, reach_m: f64) -> WallIndex {
        let blocks = Blocks::around(&walls, reach_m);
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (wall, number) in walls.iter().zip(0..) {
            pairs.extend(blocks.near(wall, reach_m).map(|(x, y)| (blocks.number(x, y) as u32, number)));
        }
        pairs.sort_unstable();
        let mut starts = vec![0; blocks.count + 1];
        pairs.iter().for_each(|(block, _)| starts[*block as usize + 1] += 1);
        (0..blocks.count).for_each(|block| starts[block + 1] += starts[block]);
        WallIndex { walls, blocks, starts, listed: pairs.into_iter().map(|(_, wall)| wall).collect() }
    }

    /// The walls near a place, some farther ones among them.
    pub fn near(&self, place: [f64; 2]) -> impl Iterator<Item = &CityWall> {
        let block = self.blocks.of(place);
        let range = self.starts[block] as usize..self.starts[block + 1] as usize;
        self.listed[range].iter().map(|&wall| &self.walls[wall as usize])
    }
}
