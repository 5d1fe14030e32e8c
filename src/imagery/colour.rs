//! A photograph in CIELAB, in which distances follow what the eye tells apart, freed of the finest noise.

use image::RgbImage;
use image::imageops::{FilterType, resize};
use palette::{FromColor, Lab, LinSrgb, Srgb};

/// L in 0 to 100, a and b about -100 to 100.
pub(super) type Colour = [f32; 3];

/// Where planes end shows at this many pixels; more only take longer.
const WORKING_PIXELS: f64 = 1e6;

/// Colours row by row from the top left.
pub(super) struct LabImage {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Colour>,
}

impl LabImage {
    /// The photograph, scaled down where it is larger than it need be, converted and smoothed with [1 2 1] both ways.
    pub fn of(photo: &RgbImage) -> LabImage {
        let (width, height) = photo.dimensions();
        let shrink = (WORKING_PIXELS / (f64::from(width) * f64::from(height))).sqrt();
        if shrink >= 1.0 {
            return smoothed(&converted(photo));
        }
        let side = |length: u32| (f64::from(length) * shrink).round().max(1.0) as u32;
        smoothed(&converted(&resize(photo, side(width), side(height), FilterType::Triangle)))
    }
}

pub(super) fn distance(a: &Colour, b: &Colour) -> f32 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

fn converted(photo: &RgbImage) -> LabImage {
    let to_lab = |rgb: &image::Rgb<u8>| {
        let linear: LinSrgb<f32> = Srgb::new(rgb[0], rgb[1], rgb[2]).into_linear();
        let lab = Lab::from_color(linear);
        [lab.l, lab.a, lab.b]
    };
    let (width, height) = (photo.width() as usize, photo.height() as usize);
    LabImage { width, height, pixels: photo.pixels().map(to_lab).collect() }
}

/// Along rows, then along columns; the border counts twice.
fn smoothed(image: &LabImage) -> LabImage {
    let (width, height) = (image.width, image.height);
    let blend = |pixels: &[Colour], before: usize, here: usize, after: usize| -> Colour {
        std::array::from_fn(|k| 0.25 * (pixels[before][k] + 2.0 * pixels[here][k] + pixels[after][k]))
    };
    let mut pixels = image.pixels.clone();
    for (i, out) in pixels.iter_mut().enumerate() {
        let x = i % width;
        *out = blend(&image.pixels, i - usize::from(x > 0), i, i + usize::from(x + 1 < width));
    }
    let rows = pixels.clone();
    for (i, out) in pixels.iter_mut().enumerate() {
        let y = i / width;
        let step = |inside: bool| if inside { width } else { 0 };
        *out = blend(&rows, i - step(y > 0), i, i + step(y + 1 < height));
    }
    LabImage { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_black_and_red_have_their_cielab_values() {
        let lab = |rgb| LabImage::of(&RgbImage::from_pixel(3, 2, image::Rgb(rgb))).pixels[4];
        // CIE 15 for sRGB's primaries under D65.
        for (rgb, expected) in
            [([255, 255, 255], [100.0, 0.0, 0.0]), ([0, 0, 0], [0.0, 0.0, 0.0]), ([255, 0, 0], [53.24, 80.09, 67.20])]
        {
            assert!(distance(&lab(rgb), &expected) < 0.1, "{rgb:?}: {:?}", lab(rgb));
        }
    }

    #[test]
    fn a_large_photograph_is_scaled_down_in_its_shape() {
        let image = LabImage::of(&RgbImage::new(4000, 1000));
        assert_eq!((image.width, image.height), (2000, 500));
    }
}
