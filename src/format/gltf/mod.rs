//! glTF 2.0 and GLB: the triangles of a scene, every mesh where its nodes put it, in f64.
//!
//! The `gltf` crate knows the format; it rounds node transforms to f32, opens whatever file a buffer names, and trusts
//! accessors. So buffers and transforms are read here, and every accessor is checked before the crate reads it.

mod buffers;
mod check;
mod container;
mod file;
mod mesh;
mod nodes;
#[cfg(test)]
mod tests;

pub use container::is_glb;
pub use file::{GltfError, GltfFile, GltfPart, GltfProblem, read_gltf};
