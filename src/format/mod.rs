//! File formats, read and written: bytes and text to plain records, and back. What the records mean is for `city` and `reconstruction` to say.
//!
//! | read | written |
//! |---|---|
//! | city models: `obj`, `gltf` | `obj` |
//! | reconstructions: `colmap` (text and binary), `ply` | `colmap` (text and binary) |
//! | JSON: starts (`start`), stored alignments (`alignment`), problems of `cityweld solve` (`problem`) | |
//!
//! A file is opened by `file` alone: regular files, up to a limit. Counts in a header are checked against the bytes that are there before
//! memory is taken for them. `json_kind` tells which of the program's own JSON files a text is; `escape` shows text from files safely on a terminal.

mod alignment;
pub mod crs;
pub mod cityjson;
pub mod bundler;
pub mod city_index;
pub mod citygml;
pub mod colmap;
pub mod e57;
pub mod file;
#[cfg(feature = "flatcitybuf")]
pub mod flatcitybuf;
mod escape;
pub mod footprints;
pub mod gltf;
pub mod las;
pub mod nerfstudio;
pub mod nvm;
mod json_kind;
pub mod control;
mod matrix;
pub mod meshes;
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
mod surface_builder;
mod surface_error;
pub mod surfaces;
#[cfg(test)]
mod tests;
mod text;
pub mod wkt;
pub mod tileset;
mod uri;

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
pub use surface_error::SurfaceError;
#[cfg(feature = "cli")]
pub use text::text_from;
pub use text::{LARGEST_TEXT_BYTES, read_text};
