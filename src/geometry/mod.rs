//! Points, planes, similarities, cameras and spatial indices. No files, no randomness.
//!
//! Frames stand in names: `x_in_city`, `n_in_sfm`; a transform is always `to_from_from`, so that
//! `city_from_cam = city_from_sfm * sfm_from_cam` cancels by reading. *City*: metres, z up, about a local origin.
//! *Sfm*: one reconstruction's own frame, of arbitrary scale. *Cam*: x right, y down, z forward.

mod axes;
mod camera;
mod camera_model;
mod distortion;
mod lens;
mod plane;
mod rays;
mod rotation;
mod similarity;
mod start;
mod umeyama;

pub use axes::Axes;
pub use camera::Camera;
pub use camera_model::CameraModel;
pub use plane::{Plane, distance_derivative};
pub use rays::RayCaster;
pub use rotation::{nearest_rotation, orthonormalised};
pub use similarity::{NotASimilarity, Similarity};
pub use start::{LEAST_SPREAD_M, Start, StartError, StartSigmas};
pub use umeyama::umeyama;

pub use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
