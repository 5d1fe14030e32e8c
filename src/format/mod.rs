//! Raw records as the specifications of the file formats write them, both directions.

mod alignment;
pub mod colmap;
pub mod control;
pub mod file;
mod escape;
pub mod gltf;
mod kind;
mod matrix;
pub mod obj;
mod placement;
pub mod positions;
mod problem;
pub mod ply;
mod ply_row;
mod start;
mod text;

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
#[cfg(feature = "cli")]
pub use text::text_from;
pub use text::{LARGEST_TEXT_BYTES, read_text};
