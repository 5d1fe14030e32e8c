//! Raw records as the specifications of the file formats write them, both directions.

mod alignment;
pub mod colmap;
pub mod file;
mod escape;
pub mod gltf;
pub mod obj;
mod placement;
pub mod ply;
mod start;

pub use alignment::{StoredAlignment, read_alignment};
pub use escape::escaped;
pub use placement::PlacementError;
pub use start::read_start;
