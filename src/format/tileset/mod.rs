//! 3D Tiles 1.0 and 1.1: the finest content of a tree of tiles, as triangles with their features.
//!
//! `tree.rs` is the tree as its JSON has it, `tiles.rs` walks it and the tilesets that it names, `content.rs` takes containers (b3dm, cmpt)
//! apart, `mesh.rs` puts what our glTF reader finds where the tile is. A position is
//! `transforms of the tiles * (RTC_CENTER + y-up-to-z-up(glTF))` (3D Tiles 1.1, sections 6.7.1.4 and 9.2.3). What stands on the earth (ECEF)
//! is set upright by `earth.rs`.

mod content;
mod earth;
mod mesh;
#[cfg(test)]
mod tests;
mod tiles;
mod tree;

pub use content::is_tile;
pub use tiles::{TilesetFile, read_tile, read_tileset};
#[cfg(test)]
pub(in crate::format) use tree::is_tileset;
