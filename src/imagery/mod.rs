//! Photographs, label images and superpixels; which points of a reconstruction fall on which superpixel.
//!
//! Question: which points does one photograph show on one small, even piece of surface?
//! Input: a reconstruction with its observations; a folder of label images, or of photographs.
//! Output: per image and superpixel the points whose observations fall on it.
//! Method: a label image is read as it stands; a photograph is cut into superpixels ([`cut_superpixels`]); an observation
//! at (x, y) falls on the superpixel of the pixel (floor x, floor y).
//! Assumptions: the files show the pixels that the reconstruction was made from, at whatever size.
//! Fails when: no file is found, a file cannot be read, or its shape is not the camera's.

mod colour;
mod files;
mod folder;
mod labels;
mod lift;
mod memory;
mod photos;
mod size;
mod slic;
mod source;
mod superpixels;

pub use labels::{LabelMap, Labels};
pub use lift::{LiftedSuperpixels, Superpixel, lift_superpixels, lift_superpixels_of};
pub use source::{ImageryError, ImageryWarning, SuperpixelSource};
pub use superpixels::{SuperpixelOptions, cut_superpixels};
