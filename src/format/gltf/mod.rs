//! glTF 2.0 and GLB: the triangles of a scene, every mesh where its nodes put it, in f64.
//!
//! The `gltf` crate knows the format; it rounds node transforms to f32, opens whatever file a buffer names, and trusts
//! accessors. So buffers, transforms and the numbers of positions are read here, and every accessor is checked before the crate reads it.
//! Extensions that move a surface (KHR_mesh_quantization, EXT_mesh_gpu_instancing, CESIUM_RTC) are read, those that pack it are named.

mod accessor;
mod buffers;
mod check;
mod container;
mod extensions;
mod file;
mod instancing;
mod mesh;
mod nodes;
#[cfg(test)]
mod tests;

pub use container::is_glb;
pub use file::{GltfError, GltfFile, GltfPart, GltfProblem, read_gltf};
