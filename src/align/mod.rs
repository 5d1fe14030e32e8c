//! The main job on one page: patches, up, scene, search, refinement, evidence, verdict.

mod evidence;
mod obstacle;
mod report;
mod task;

pub use task::{AlignOptions, Up, align};
