//! Results written for people and for other programs. Writing never estimates and never judges; the shift of large
//! coordinates is undone here.

pub mod colmap;
mod file;
mod glb;
pub mod gltf;
mod output;
pub mod ply;
mod report;

pub use file::ExportError;
pub use output::{Discard, Output, OutputError, OutputKind};
pub use report::{CityCounts, InputSummary, ReportError, SfmCounts, alignment_report};
