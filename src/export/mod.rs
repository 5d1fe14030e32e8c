//! Results written for people and for other programs. Writing never estimates and never judges; the shift of large
//! coordinates is undone here.

pub mod colmap;
mod earlier;
mod file;
mod folder;
mod glb;
mod merge_report;
pub mod gltf;
mod gltf_city;
mod gltf_photographs;
mod output;
mod output_error;
mod planes;
pub mod ply;
mod prior;
mod report;
mod scene_extent;
mod report_input;
mod similarity;
mod work;

pub use earlier::UnpackedFile;
pub use file::ExportError;
pub use folder::{Formats, write_alignment, write_placed};
pub use merge_report::{merge_report, write_merge};
pub use output::{Discard, Output, OutputKind, Replace};
pub use output_error::OutputError;
pub use planes::{PlaneAttitude, planes_report, write_planes_glb};
pub use report::{ReportError, alignment_report, start_report};
pub use report_input::{CityCounts, InputSummary, SfmCounts};
