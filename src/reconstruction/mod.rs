//! A reconstruction as a structure-from-motion tool left it: cameras, images, points, tracks, in its own frame.
//!
//! `recognise.rs` finds out what lies at a path, `read.rs` reads it, `consistency.rs` holds it against itself. A file for each format
//! says what its records mean; `posed.rs` is the shape that those without ids of their own are brought to.

mod bundler;
mod checker;
mod cloud;
mod colmap;
mod colmap_gaps;
mod consistency;
mod frames;
mod ids;
mod model;
mod names;
mod nerfstudio;
mod nvm;
mod openmvg;
mod opensfm;
mod picture_sizes;
mod ply;
mod posed;
mod read;
mod recognise;
mod tracks;
mod transform;
mod warning;

pub use consistency::PoseReading;
pub use model::{
    CameraIndex, ColmapParts, Image, ImageIndex, KnownPositions, LasPacking, Observation, PointIndex, Reconstruction,
    SfmFormat, Sight,
};
pub use names::{AmbiguousName, NameIndex, NameMatch, match_names};
pub use read::{ReconstructionError, SfmOptions, read_reconstruction, read_reconstruction_with};
pub use recognise::{SfmSource, recognise};
pub use warning::{ReconstructionWarning, WarningKind};
