//! Raw records as the specifications of the file formats write them, both directions.

mod alignment;
pub mod cityjson;
pub mod bundler;
pub mod colmap;
pub mod e57;
pub mod file;
mod escape;
pub mod gltf;
pub mod las;
pub mod nerfstudio;
pub mod nvm;
mod json_kind;
pub mod control;
mod matrix;
pub mod obj;
pub mod openmvg;
pub mod opensfm;
pub mod picture_size;
mod placement;
pub mod positions;
mod problem;
pub mod ply;
pub mod sfm_file;
mod start;
pub mod surfaces;
mod text;
pub mod wkt;

pub use alignment::{StoredAlignment, read_alignment};
pub use escape::escaped;
#[cfg(feature = "cli")]
pub use escape::escaped_json;
pub use json_kind::JsonKind;
pub use placement::PlacementError;
pub use problem::{
    IllFormed, LARGEST_PROBLEM_BYTES, Primitive, ProblemKind, StoredPairs, StoredPlane, StoredUp, read_problem,
};
pub use start::read_start;
#[cfg(feature = "cli")]
pub use text::text_from;
pub use text::{LARGEST_TEXT_BYTES, read_text};
