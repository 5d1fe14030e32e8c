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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn knows_every_wall_that_is_near_a_place_and_few_that_are_far() {
        let mut random = Random::stream(6, 0);
        let mut draw = |width: f64| width * (random.unit() - 0.5);
        let mut wall = || {
            let from = [draw(800.0), draw(500.0)];
            let to = [from[0] + draw(50.0), from[1] + draw(50.0)];
            CityWall { from, to, normal: [1.0, 0.0], foot_m: 0.0, top_m: 8.0 }
        };
        let walls: Vec<CityWall> = (0..60).map(|_| wall()).collect();
        for reach_m in [0.5, 3.0, 20.0] {
            let index = WallIndex::new(walls.clone(), reach_m);
            let mut near = 0;
            for _ in 0..4000 {
                let place = [draw(1000.0), draw(700.0)];
                let ends = |wall: &CityWall| (wall.from, wall.to);
                let found: Vec<_> = index.near(place).map(ends).collect();
                for wall in walls.iter().filter(|wall| wall.distance_m(place) <= reach_m) {
                    near += 1;
                    assert!(found.contains(&ends(wall)), "{place:?} lies within {reach_m} m of {wall:?}");
                }
                // Across a block of 4 m on the way to its middle and on from it.
                let farthest = index.near(place).map(|wall| wall.distance_m(place)).fold(0.0, f64::max);
                assert!(farthest <= reach_m + 6.0, "{farthest} m off, asked for {reach_m} m");
            }
            assert!(near > 5, "{near} within {reach_m} m");
        }
    }

    #[test]
    fn a_city_without_walls_has_none_near_any_place() {
        let index = WallIndex::new(Vec::new(), 3.0);
        assert_eq!(index.near([0.0, 0.0]).count() + index.near([1e9, -1e9]).count(), 0);
    }
}
