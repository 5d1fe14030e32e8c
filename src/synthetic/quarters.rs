//! Quarters: a town of blocks that differ in kind, with streets between, and rows and courts that repeat themselves.

use std::f64::consts::{FRAC_PI_2, PI};

use super::block::{Block, town_house};
use super::draws::{between, stream, whole};
use super::house::House;
use crate::geometry::{Point3, Vector3};
use crate::solvers::scene::Random;

/// From one block to the next, and how long the side of a block is: a street of 16 m stays between them.
pub(super) const STEP_M: f64 = 60.0;
pub(super) const SIDE_M: f64 = 44.0;

/// A town of blocks in columns and rows; the first block's corner is the origin.
#[derive(Clone, Debug)]
pub struct Quarters {
    pub block: Block,
    pub columns: usize,
    pub rows: usize,
    /// Which of the three kinds the first block is.
    first: usize,
}

/// What a block is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quarter {
    /// Houses wall to wall round a court, each of its own height.
    Court,
    /// Houses with gardens between.
    Detached,
    /// Two rows of houses, back to back, alike but for some of their heights.
    Rows,
}

impl Quarters {
    pub fn new(columns: usize, rows: usize, seed: u64) -> Quarters {
        let mut random = stream(seed, 0);
        let mut town = Quarters { block: Block::new(Vec::new()), columns, rows, first: whole(&mut random, 0, 3) };
        for cell in 0..columns * rows {
            let houses = match town.kind(cell) {
                Quarter::Court => court(&mut random),
                Quarter::Detached => detached(&mut random),
                Quarter::Rows => rows_of(&mut random),
            };
            // Blocks of a town are never quite in line.
            let turn_rad = between(&mut random, -4.0, 4.0).to_radians();
            let middle = [0.5 * SIDE_M, 0.5 * SIDE_M, 0.0];
            let place = town.middle_of(cell);
            let placed =
                houses.into_iter().map(|h| h.at(middle.map(|m| -m)).turned(turn_rad).at([place.x, place.y, 0.0]));
            town.block.houses.extend(placed);
        }
        town
    }

    pub fn kind(&self, cell: usize) -> Quarter {
        // Diagonals, so that every neighbourhood has all three.
        [Quarter::Court, Quarter::Detached, Quarter::Rows][(cell % self.columns + cell / self.columns + self.first) % 3]
    }

    /// The middle of a block, on the ground.
    pub fn middle_of(&self, cell: usize) -> Point3<f64> {
        let [column, row] = [cell % self.columns, cell / self.columns].map(|k| STEP_M * k as f64 + 0.5 * SIDE_M);
        Point3::new(column, row, 0.0)
    }
}

/// Houses that would be told apart by nothing: rows, grids, and blocks that are their own mirror image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Repeated {
    Row,
    StreetOfRows,
    Detached,
    SymmetricBlock,
    Courtyard,
}

impl Repeated {
    pub const ALL: [Repeated; 5] =
        [Repeated::Row, Repeated::StreetOfRows, Repeated::Detached, Repeated::SymmetricBlock, Repeated::Courtyard];

    /// Equal houses of seeded sizes.
    pub fn block(self, random: &mut Random) -> Block {
        let mut drawn = |low: f64, high: f64| between(random, low, high);
        let (width, depth, eaves) = (drawn(5.0, 8.0), drawn(8.0, 11.0), drawn(3.0, 8.0));
        let rise = if drawn(0.0, 1.0) < 0.6 { drawn(1.5, 4.0) } else { 0.0 };
        let house = |size: [f64; 3]| if rise > 0.0 { House::gabled(size, rise) } else { House::flat(size) };
        let count = drawn(5.0, 14.0) as usize;
        match self {
            Repeated::Row => Block::row(&house([width, depth, eaves]), count, width),
            Repeated::StreetOfRows => {
                let mut block = Block::row(&house([width, depth, eaves]), count, width);
                let across = Vector3::new(width * count as f64, -14.0, 0.0);
                let other = block.houses.iter().map(|h| h.clone().turned(PI).at(across.into())).collect::<Vec<_>>();
                block.houses.extend(other);
                block
            }
            Repeated::Detached => {
                let place = |k: usize| [(width + 8.0) * (k % 4) as f64, (depth + 10.0) * (k / 4) as f64, 0.0];
                Block::new((0..12).map(|k| house([width, depth, eaves]).at(place(k))).collect())
            }
            Repeated::SymmetricBlock => {
                let side = drawn(10.0, 22.0);
                let other = if drawn(0.0, 1.0) < 0.4 { side } else { 0.6 * side };
                Block::new(vec![house([side, other, eaves + 3.0])])
            }
            Repeated::Courtyard => {
                // Four wings about the origin, each an end short so that they meet.
                let side = drawn(22.0, 36.0);
                let wing = |k: u32| {
                    house([side - 8.0, 8.0, eaves + 4.0])
                        .at([-0.5 * side, -0.5 * side, 0.0])
                        .turned(FRAC_PI_2 * f64::from(k))
                };
                Block::new((0..4).map(wing).collect())
            }
        }
    }
}

fn detached(random: &mut Random) -> Vec<House> {
    (0..6).map(|plot| town_house(random, [15.0 * f64::from(plot % 3), 20.0 * f64::from(plot / 3)])).collect()
}

/// A row along x of houses with their fronts at y = 0, from 0 to `length_m`.
fn row(random: &mut Random, length_m: f64) -> Vec<House> {
    let (mut x, mut houses) = (0.0, Vec::new());
    while x < length_m - 1e-9 {
        let drawn = between(random, 6.0, 9.0);
        // What is left must be a house.
        let width = if length_m - x - drawn < 5.0 { length_m - x } else { drawn };
        let size = [width, between(random, 9.0, 11.0), between(random, 7.0, 14.0)];
        let house =
            if random.unit() < 0.4 { House::flat(size) } else { House::gabled(size, between(random, 1.5, 4.0)) };
        houses.push(house.at([x, 0.0, 0.0]));
        x += width;
    }
    houses
}

/// The depth of the deepest house of a row: the sides of a court begin behind it.
const DEEPEST_M: f64 = 11.0;

fn court(random: &mut Random) -> Vec<House> {
    let side = SIDE_M - 2.0;
    let mut houses = Vec::new();
    // South, east, north, west: turned about the origin, then put into its corner.
    for (k, corner) in [[0.0, 0.0], [side, DEEPEST_M], [side, side], [0.0, side - DEEPEST_M]].iter().enumerate() {
        let length = if k % 2 == 0 { side } else { side - 2.0 * DEEPEST_M };
        let turned =
            row(random, length).into_iter().map(|h| h.turned(FRAC_PI_2 * k as f64).at([corner[0], corner[1], 0.0]));
        houses.extend(turned);
    }
    houses
}

fn rows_of(random: &mut Random) -> Vec<House> {
    let (width, depth, eaves) = (between(random, 5.5, 7.5), between(random, 8.0, 10.0), between(random, 5.0, 8.0));
    let rise = between(random, 2.0, 4.0);
    let count = ((SIDE_M - 2.0) / width) as usize;
    let mut house = || {
        let raised = if random.unit() < 0.3 { 2.8 * random.unit() } else { 0.0 };
        House::gabled([width, depth, eaves + raised], rise)
    };
    let mut houses: Vec<House> = (0..count).map(|i| house().at([width * i as f64, 0.0, 0.0])).collect();
    houses.extend((0..count).map(|i| house().turned(PI).at([width * (i + 1) as f64, SIDE_M - 4.0, 0.0])));
    houses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_town_of_quarters_is_a_sound_city_and_repeats() {
        let town = Quarters::new(4, 3, 7);
        assert!(town.block.houses.len() > 90, "{}", town.block.houses.len());
        assert_eq!(town.block, Quarters::new(4, 3, 7).block);
        assert_ne!(town.block, Quarters::new(4, 3, 8).block);
        for kind in [Quarter::Court, Quarter::Detached, Quarter::Rows] {
            assert!((0..12).any(|cell| town.kind(cell) == kind));
        }
        assert!(town.block.city().is_ok());
    }

    #[test]
    fn streets_are_free() {
        let town = Quarters::new(3, 3, 5);
        let corners = town.block.houses.iter().flat_map(|h| &h.faces).flat_map(|f| &f.corners);
        for corner in corners {
            for across in [corner.x, corner.y] {
                let from_street = (across + 0.5 * (STEP_M - SIDE_M)).rem_euclid(STEP_M);
                assert!(from_street.min(STEP_M - from_street) > 4.0, "{corner}");
            }
        }
    }

    #[test]
    fn repeated_houses_have_twins() {
        for kind in Repeated::ALL {
            let block = kind.block(&mut stream(3, 1));
            assert!(block.city().is_ok(), "{kind:?}");
            assert!(kind == Repeated::SymmetricBlock || block.houses.len() >= 4, "{kind:?}");
        }
    }
}
