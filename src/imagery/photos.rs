//! Photographs on their way to superpixels.

use std::path::Path;

use image::RgbImage;

use super::ImageryError;
use super::files::read_picture;

/// A decoded photograph.
pub(super) struct Photo {
    pub pixels: RgbImage,
    pub truncated: bool,
}

/// Reads a photograph, JPEG or PNG, of any colour type.
pub(super) fn read_photo(path: &Path) -> Result<Photo, ImageryError> {
    let picture = read_picture(path, "photograph", "JPEG or PNG")?;
    Ok(Photo { pixels: picture.pixels.into_rgb8(), truncated: picture.truncated })
}
