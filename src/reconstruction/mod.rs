//! A reconstruction as a structure-from-motion tool left it: cameras, images, points, tracks, in its own frame.

mod checker;
mod colmap;
mod frames;
mod ids;
mod model;
mod ply;
mod read;
mod tracks;
mod transform;

pub use model::{
    CameraIndex, ColmapParts, Image, ImageIndex, Observation, PointIndex, Reconstruction, ReconstructionWarning,
    WarningKind,
};
pub use read::{ReconstructionError, read_reconstruction};
