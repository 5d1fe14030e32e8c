//! What can be seen of a block: which of its triangles, and the walls that they make.

use zerocopy::{FromBytes, IntoBytes};

use super::fault::IndexFault;
use super::records::WallRecord;

/// What can be seen of a block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockSight {
    /// Of each triangle, in the block's order.
    pub exposed: Vec<bool>,
    pub walls: Vec<WallRecord>,
}

impl BlockSight {
    pub fn to_bytes(&self) -> Vec<u8> {
        let exposed: Vec<u8> = self.exposed.iter().map(|&exposed| u8::from(exposed)).collect();
        [&exposed, self.walls.as_bytes()].concat()
    }

    /// Of a block with so many triangles, out of bytes of the file whose first is at `at`.
    pub fn read(bytes: &[u8], triangles: usize, at: u64) -> Result<BlockSight, IndexFault> {
        let nonsense = |found: &str| IndexFault::Nonsense { what: "what is seen of a block", at, found: found.into() };
        let (exposed, walls) = bytes.split_at_checked(triangles).ok_or_else(|| nonsense("it is too short"))?;
        let walls = <[WallRecord]>::ref_from_bytes(walls).map_err(|_| nonsense("a wall is cut off"))?;
        let is_wall = |wall: &WallRecord| {
            let numbers = [&wall.from[..], &wall.to, &wall.normal, &[wall.foot_m, wall.top_m]].concat();
            numbers.iter().all(|value| value.get().is_finite())
        };
        match exposed.iter().all(|&seen| seen <= 1) && walls.iter().all(is_wall) {
            true => Ok(BlockSight { exposed: exposed.iter().map(|&seen| seen == 1).collect(), walls: walls.to_vec() }),
            false => Err(nonsense("neither seen nor hidden, or a wall that is nowhere")),
        }
    }
}
