//! COLMAP models: cameras, images, points3D, and (since COLMAP 3.12) rigs and frames; binary and text.
//!
//! Records stand here as the files hold them, with the files' own ids; what they mean together is for
//! `reconstruction` to judge. <https://colmap.github.io/format.html> describes the files.

mod binary;
mod fault;
mod model;
mod records;
mod text;
mod write;

pub use model::{ColmapError, cloud_file, missing_files, read_model, record_file};
pub use records::*;
pub use write::{cameras_file, can_be_named, frames_file, rigs_file, write_images, write_points};
