//! Photographs on their way to superpixels.

use std::path::Path;

use image::RgbImage;

use super::ImageryError;
use super::files::{Expected, Picture, open_picture};

/// A decoded photograph.
pub(super) struct Photo {
    pub pixels: RgbImage,
    pub truncated: bool,
}

const EXPECTED: Expected = Expected { noun: "photograph", format: "JPEG or PNG" };

/// Opens a photograph, JPEG or PNG, of an image of the size of `camera`, if that is known.
pub(super) fn open_photo(path: &Path, camera: Option<(u32, u32)>) -> Result<Picture<'_>, ImageryError> {
    open_picture(path, EXPECTED, camera)
}

/// Decodes a photograph of any colour type.
pub(super) fn decode_photo(picture: Picture<'_>) -> Result<Photo, ImageryError> {
    let decoded = picture.decode()?;
    Ok(Photo { pixels: decoded.pixels.into_rgb8(), truncated: decoded.truncated })
}
