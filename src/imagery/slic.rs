//! Superpixels of a photograph.

use image::RgbImage;
use simple_clustering::slic_from_bytes;

use super::LabelMap;

/// How photographs are cut into superpixels.
#[derive(Clone, Debug, PartialEq)]
pub struct SlicOptions {
    /// Side of a usual superpixel as a share of the geometric mean of the photograph's width and height.
    pub cell_share: f64,
}

impl Default for SlicOptions {
    fn default() -> SlicOptions {
        SlicOptions { cell_share: 0.1 }
    }
}

/// Cuts a photograph into connected superpixels with the labels 1, 2, ...
pub fn slic(photo: &RgbImage, options: &SlicOptions) -> LabelMap {
    let (width, height) = photo.dimensions();
    let count = (1.0 / (options.cell_share * options.cell_share)).round().clamp(1.0, 65_000.0) as u32;
    let labels = match slic_from_bytes(count, 10, width, height, None, photo.as_raw()) {
        Ok(labels) => labels.into_iter().map(|label| label as u32 + 1).collect(),
        // Pictures too small to be cut are one superpixel.
        Err(_) => vec![1; width as usize * height as usize],
    };
    LabelMap { width, height, labels }
}
