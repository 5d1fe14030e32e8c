//! The geometry that all rooms share: points and planes, seven-parameter (Helmert) transformations, camera models, lines of sight. It reads
//! no files and draws no random numbers.
//!
//! | file | what it holds |
//! |---|---|
//! | `similarity` | x_to = s R x_from + t, its inverse and product |
//! | `plane` | n . x + d = 0, and how a point's distance from it changes with a motion |
//! | `rotation`, `axes` | the rotation nearest to a matrix; three orthonormal axes about a given one |
//! | `camera`, `camera_model`, `lens`, `distortion` | from the camera frame to pixels and back, for every camera model of COLMAP |
//! | `rays` | which triangle a line of sight meets first |
//! | `start` | approximate values of a pose, with their standard deviations |
//!
//! Every coordinate and every transformation names its frames: `x_in_city`, `city_from_sfm`; in `city_from_cam = city_from_sfm * sfm_from_cam`
//! the inner names cancel. *City*: metres, z up, about a local origin. *Sfm*: the model coordinate system of one reconstruction, of arbitrary
//! scale. *Cam*: x right, y down, z forward.

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
