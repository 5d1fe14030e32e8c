//! Raw records as the specifications of the file formats write them, both directions.

mod alignment;
pub mod citygml;
pub mod colmap;
pub mod file;
mod escape;
pub mod footprints;
pub mod gltf;
mod kind;
pub mod meshes;
pub mod obj;
mod placement;
mod problem;
pub mod ply;
mod ply_row;
mod start;
mod surface_builder;
mod surface_error;
pub mod surfaces;
#[cfg(test)]
mod tests;
mod text;
pub mod tileset;
mod uri;

pub use alignment::{StoredAlignment, read_alignment};
pub use escape::escaped;
#[cfg(feature = "cli")]
pub use escape::escaped_json;
pub use kind::JsonKind;
pub use placement::PlacementError;
pub use problem::{
    IllFormed, LARGEST_PROBLEM_BYTES, Primitive, ProblemKind, StoredPairs, StoredPlane, StoredUp, read_problem,
};
pub use start::read_start;
pub use surface_error::{Place, SurfaceError};
#[cfg(feature = "cli")]
pub use text::text_from;
pub use text::{LARGEST_TEXT_BYTES, read_text};
