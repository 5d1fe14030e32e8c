//! Raw records as the specifications of the file formats write them, both directions.

mod alignment;
pub mod colmap;
pub mod file;
mod escape;
pub mod gltf;
mod kind;
pub mod obj;
mod placement;
mod problem;
pub mod ply;
mod start;
mod text;

pub use alignment::{Spread, StoredAlignment, read_alignment};
pub use escape::{escaped, escaped_json};
pub use kind::JsonKind;
pub use placement::PlacementError;
pub use problem::{
    IllFormed, LARGEST_PROBLEM_BYTES, Primitive, ProblemKind, StoredPairs, StoredPlane, StoredProblem, StoredUp,
    read_problem,
};
pub use start::read_start;
pub use text::{LARGEST_TEXT_BYTES, read_text, text_from};
