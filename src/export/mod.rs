//! Results written for people and for other programs. Writing never estimates and never judges; the shift of large
//! coordinates is undone here.

mod glb;
pub mod gltf;
mod output;
mod report;

pub use output::{Discard, Output, OutputError, OutputKind};
pub use report::{CityCounts, InputSummary, ReportError, SfmCounts, alignment_report};
