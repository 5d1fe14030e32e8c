//! Meshes without a scene, as scanners and modelling programs write them: PLY with faces, STL.
//!
//! Both are read here: a binary STL may begin with the word `solid`, too, and counts of a header are held against the bytes that are there.

mod ply_mesh;
mod stl;
#[cfg(test)]
pub(in crate::format) mod tests;

pub use ply_mesh::{is_ply_mesh, read_ply_mesh};
pub use stl::{is_stl, read_stl};
