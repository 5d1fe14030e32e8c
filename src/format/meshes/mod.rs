//! Meshes without a scene, as scanners and modelling programs write them: PLY with faces, STL. COLLADA is recognised, and not read.
//!
//! Both are read here: the known crates take a binary STL whose name begins with `solid` for text, and a header's counts for true.

mod collada;
mod ply_mesh;
mod stl;
#[cfg(test)]
pub(in crate::format) mod tests;

pub use collada::is_collada;
pub use ply_mesh::{is_ply_mesh, read_ply_mesh};
pub use stl::{is_stl, read_stl};
