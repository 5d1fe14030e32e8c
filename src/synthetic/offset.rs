//! How far a start, or an answer, is from the truth.

use super::Block;
use crate::geometry::{Rotation3, Similarity, Vector3};

/// How a start is off, about the middle of the block; the default is not off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// East, north, up.
    pub shift_m: [f64; 3],
    /// Counter-clockwise from above.
    pub heading_rad: f64,
    /// About the x and the y axis of the city.
    pub tilt_rad: [f64; 2],
    /// How many times too large.
    pub scale: f64,
}

impl Default for Offset {
    fn default() -> Offset {
        Offset { shift_m: [0.0; 3], heading_rad: 0.0, tilt_rad: [0.0; 2], scale: 1.0 }
    }
}

/// The farthest that a block's corners are moved, level and along up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Move {
    pub level_m: f64,
    pub up_m: f64,
}

impl Block {
    /// The map from the city to itself that is off by so much: `block.off(&offset) * survey.city_from_sfm` is a start.
    pub fn off(&self, offset: &Offset) -> Similarity {
        let middle = self.middle();
        let rotation = Rotation3::from_euler_angles(offset.tilt_rad[0], offset.tilt_rad[1], offset.heading_rad);
        Similarity::about(&middle, &(middle + Vector3::from(offset.shift_m)), offset.scale, rotation)
    }

    /// How far a map from the city to itself moves the houses: `block.move_by(&(found * truth.inverse()))` is the error of
    /// what was found.
    pub fn move_by(&self, city_from_city: &Similarity) -> Move {
        let corners = self.houses.iter().flat_map(|house| &house.faces).flat_map(|face| &face.corners);
        corners
            .map(|c| city_from_city.apply(c) - c)
            .fold(Move::default(), |m, d| Move { level_m: d.xy().norm().max(m.level_m), up_m: d.z.abs().max(m.up_m) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_moves_the_middle_by_its_shift_and_corners_by_the_rest() {
        let block = Block::four_houses();
        let offset = Offset { shift_m: [3.0, 4.0, 1.0], ..Offset::default() };
        let by_shift = block.move_by(&block.off(&offset));
        assert!((by_shift.level_m - 5.0).abs() < 1e-12 && (by_shift.up_m - 1.0).abs() < 1e-12);
        let all = Offset { heading_rad: 0.3, tilt_rad: [0.1, -0.1], scale: 1.2, ..offset };
        let moved = block.off(&all).apply(&block.middle()) - block.middle();
        assert!((moved - Vector3::new(3.0, 4.0, 1.0)).norm() < 1e-12);
        assert!(block.move_by(&block.off(&all)).level_m > 6.0);
        assert_eq!(block.move_by(&Similarity::identity()), Move::default());
    }
}
