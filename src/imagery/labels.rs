//! Label images: one superpixel id a pixel.

use std::path::Path;

use image::DynamicImage;

use super::ImageryError;
use super::files::read_picture;

/// Superpixel ids of one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelMap {
    pub width: u32,
    pub height: u32,
    /// Row by row from the top left; 0 is no superpixel.
    pub labels: Vec<u32>,
}

impl LabelMap {
    /// The label under a point of an image of `image_size` (width, height), to which this map is scaled by nearest
    /// neighbour; 0 where there is none, `None` outside the image.
    pub fn label_at(&self, x_px: f64, y_px: f64, image_size: (u32, u32)) -> Option<u32> {
        self.labels.get(self.index_at(x_px, y_px, image_size)?).copied()
    }

    /// The index of that pixel.
    pub(super) fn index_at(&self, x_px: f64, y_px: f64, image_size: (u32, u32)) -> Option<usize> {
        let column = scaled_index(x_px, image_size.0, self.width)?;
        let row = scaled_index(y_px, image_size.1, self.height)?;
        Some(row * self.width as usize + column)
    }
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

/// Reads a label image: PNG, 8 or 16 bit grey, values as they are.
pub(super) fn read_labels(path: &Path) -> Result<LabelMap, ImageryError> {
    let picture = read_picture(path, "label image", "8 or 16 bit grey PNG")?;
    let labels = match &picture.pixels {
        DynamicImage::ImageLuma8(pixels) => pixels.as_raw().iter().map(|&v| u32::from(v)).collect(),
        DynamicImage::ImageLuma16(pixels) => pixels.as_raw().iter().map(|&v| u32::from(v)).collect(),
        other => {
            return Err(ImageryError::NotGrey { found: format!("{:?}", other.color()), path: path.to_path_buf() });
        }
    };
    Ok(LabelMap { width: picture.pixels.width(), height: picture.pixels.height(), labels })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> LabelMap {
        LabelMap { width: 2, height: 2, labels: vec![1, 2, 3, 4] }
    }

    #[test]
    fn a_point_falls_on_the_pixel_of_its_floor() {
        let map = two_by_two();
        assert_eq!(map.label_at(0.99, 0.0, (2, 2)), Some(1));
        assert_eq!(map.label_at(1.0, 0.5, (2, 2)), Some(2));
        assert_eq!(map.label_at(0.5, 1.5, (2, 2)), Some(3));
    }

    #[test]
    fn a_smaller_map_is_stretched_over_the_image() {
        let map = two_by_two();
        assert_eq!(map.label_at(4.99, 4.99, (10, 10)), Some(1));
        assert_eq!(map.label_at(5.0, 9.99, (10, 10)), Some(4));
    }

    #[test]
    fn points_outside_and_nan_have_no_label() {
        let map = two_by_two();
        for (x, y) in [(-0.1, 0.5), (2.0, 0.5), (0.5, 2.0), (f64::NAN, 0.5), (f64::INFINITY, 0.5)] {
            assert_eq!(map.label_at(x, y, (2, 2)), None);
        }
        assert_eq!(map.label_at(2.0_f64.next_down(), 0.0, (2, 2)), Some(2));
    }
}
