//! Label images: one superpixel id a pixel.

use std::path::Path;

use image::DynamicImage;

use super::ImageryError;
use super::files::{Expected, Picture, open_picture};

/// Superpixel ids of one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelMap {
    pub width: u32,
    pub height: u32,
    pub labels: Labels,
}

/// Ids row by row from the top left, as wide as their file has them; 0 is no superpixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Labels {
    U8(Vec<u8>),
    U16(Vec<u16>),
    U32(Vec<u32>),
}

impl Labels {
    pub fn get(&self, index: usize) -> Option<u32> {
        match self {
            Labels::U8(ids) => ids.get(index).map(|&id| id.into()),
            Labels::U16(ids) => ids.get(index).map(|&id| id.into()),
            Labels::U32(ids) => ids.get(index).copied(),
        }
    }

    /// Pixels.
    pub fn len(&self) -> usize {
        match self {
            Labels::U8(ids) => ids.len(),
            Labels::U16(ids) => ids.len(),
            Labels::U32(ids) => ids.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.len()).filter_map(|index| self.get(index))
    }
}

impl LabelMap {
    /// The label under a point of an image of `image_size` (width, height), to which this map is scaled by nearest
    /// neighbour; 0 where there is none, `None` outside the image.
    pub fn label_at(&self, x_px: f64, y_px: f64, image_size: (u32, u32)) -> Option<u32> {
        self.labels.get(index_at(x_px, y_px, image_size, (self.width, self.height))?)
    }
}

/// The index of the pixel under a point of an image of `image_size`, in a picture of `size` that shows the same.
pub(super) fn index_at(x_px: f64, y_px: f64, image_size: (u32, u32), size: (u32, u32)) -> Option<usize> {
    let column = scaled_index(x_px, image_size.0, size.0)?;
    let row = scaled_index(y_px, image_size.1, size.1)?;
    Some(row * size.0 as usize + column)
}

/// The cell of `cells` into which a coordinate falls when they cover `extent_px` evenly.
fn scaled_index(coordinate_px: f64, extent_px: u32, cells: u32) -> Option<usize> {
    let extent_px = f64::from(extent_px);
    if !(coordinate_px >= 0.0 && coordinate_px < extent_px) {
        return None;
    }
    let cell = (coordinate_px * f64::from(cells) / extent_px) as usize;
    // Rounding can carry a coordinate just below the far edge over it.
    Some(cell.min((cells as usize).saturating_sub(1)))
}

const EXPECTED: Expected = Expected { noun: "label image", format: "8 or 16 bit grey PNG" };

/// Opens a label image (PNG, 8 or 16 bit grey) of an image of the size of `camera`, if that is known.
pub(super) fn open_labels(path: &Path, camera: Option<(u32, u32)>) -> Result<Picture<'_>, ImageryError> {
    open_picture(path, EXPECTED, camera)
}

/// Decodes a label image, values as they are.
pub(super) fn decode_labels(picture: Picture<'_>) -> Result<LabelMap, ImageryError> {
    let path = picture.path;
    let pixels = picture.decode()?.pixels;
    let (width, height) = (pixels.width(), pixels.height());
    let labels = match pixels {
        DynamicImage::ImageLuma8(pixels) => Labels::U8(pixels.into_raw()),
        DynamicImage::ImageLuma16(pixels) => Labels::U16(pixels.into_raw()),
        other => {
            return Err(ImageryError::NotGrey { found: format!("{:?}", other.color()), path: path.to_path_buf() });
        }
    };
    Ok(LabelMap { width, height, labels })
}

#[cfg(test)]
mod tests;
