//! A photograph in CIELAB, in which distances follow what the eye tells apart, freed of the finest noise.
//!
//! Source       sRGB: IEC 61966-2-1; CIELAB about the white of sRGB (D65): CIE 15

use std::ops::Range;

use image::RgbImage;
use image::imageops::{FilterType, resize};

/// L in 0 to 100, a and b about -100 to 100.
pub(super) type Colour = [f32; 3];

/// Where planes end shows at this many pixels; more only take longer.
const WORKING_PIXELS: f64 = 1e6;

/// Colours row by row from the top left, each channel by itself, so that several pixels are handled at once.
pub(super) struct LabImage {
    pub width: usize,
    pub height: usize,
    pub channels: [Vec<f32>; 3],
}

impl LabImage {
    /// The photograph, scaled down where it is larger than it need be, converted and smoothed with [1 2 1] both ways.
    pub fn of(photo: &RgbImage) -> LabImage {
        let (width, height) = photo.dimensions();
        let shrink = (WORKING_PIXELS / (f64::from(width) * f64::from(height))).sqrt();
        if shrink >= 1.0 {
            return smoothed(converted(photo));
        }
        let side = |length: u32| (f64::from(length) * shrink).round().max(1.0) as u32;
        smoothed(converted(&resize(photo, side(width), side(height), FilterType::Triangle)))
    }

    pub fn is_empty(&self) -> bool {
        self.width == 0 || self.height == 0
    }

    pub fn pixel(&self, at: usize) -> Colour {
        let [l, a, b] = &self.channels;
        [l[at], a[at], b[at]]
    }

    /// Of some pixels behind each other.
    pub fn sum(&self, pixels: Range<usize>) -> Colour {
        let [l, a, b] = self.channels.each_ref().map(|channel| &channel[pixels.clone()]);
        let pixels = l.iter().zip(a).zip(b);
        pixels.fold([0.0; 3], |sum, ((l, a), b)| [sum[0] + l, sum[1] + a, sum[2] + b])
    }
}

pub(super) fn distance(a: &Colour, b: &Colour) -> f32 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

/// Linear sRGB to CIE XYZ, over the white.
const XYZ_OF_RGB: [[f32; 3]; 3] = [
    [0.412_456_4 / 0.950_47, 0.357_576_1 / 0.950_47, 0.180_437_5 / 0.950_47],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9 / 1.088_83, 0.119_192 / 1.088_83, 0.950_304_1 / 1.088_83],
];

/// Row by row, while a row is at hand.
fn converted(photo: &RgbImage) -> LabImage {
    let linear: Vec<f32> = (0..256u32).map(linear).collect();
    let (width, height) = (photo.width() as usize, photo.height() as usize);
    let mut channels = [(); 3].map(|()| vec![0.0; width * height]);
    let [r, g, b] = channels.each_mut().map(|channel| channel.chunks_mut(width.max(1)));
    for (((row, r), g), b) in photo.rows().zip(r).zip(g).zip(b) {
        for (((pixel, r), g), b) in row.zip(r.iter_mut()).zip(g.iter_mut()).zip(b.iter_mut()) {
            let [red, green, blue] = pixel.0;
            (*r, *g, *b) = (linear[usize::from(red)], linear[usize::from(green)], linear[usize::from(blue)]);
        }
        to_lab(r, g, b);
    }
    LabImage { width, height, channels }
}

/// Linear red, green and blue to CIELAB, in place.
#[inline(never)]
fn to_lab(r: &mut [f32], g: &mut [f32], b: &mut [f32]) {
    for ((r, g), b) in r.iter_mut().zip(g).zip(b) {
        let [x, y, z] = XYZ_OF_RGB.map(|row| lightness(row[0] * *r + row[1] * *g + row[2] * *b));
        (*r, *g, *b) = (116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z));
    }
}

/// Of an sRGB value of eight bits.
fn linear(value: u32) -> f32 {
    let share = value as f32 / 255.0;
    if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
}

/// CIELAB's cube root, linear where it is dark.
#[inline]
fn lightness(t: f32) -> f32 {
    let dark = 841.0 / 108.0 * t + 4.0 / 29.0;
    // A third of the logarithm, to 4 %; a step of Halley's, which takes one division, leaves some hundred-thousandths.
    let root = f32::from_bits(t.to_bits() / 3 + 0x2a50_8c2d);
    let cube = root * root * root;
    let root = root * (cube + 2.0 * t) / (2.0 * cube + t);
    // Without a branch, so that the compiler handles several pixels at once.
    let is_light = u32::from(t > 216.0 / 24_389.0).wrapping_neg();
    f32::from_bits(root.to_bits() & is_light | dark.to_bits() & !is_light)
}

/// Along rows, then along columns; the border counts twice.
fn smoothed(mut image: LabImage) -> LabImage {
    let width = image.width;
    // What a row was before it was smoothed: itself, or the one above.
    let (mut before, mut here) = (vec![0.0; width], vec![0.0; width]);
    for channel in &mut image.channels {
        for row in channel.chunks_mut(width.max(1)) {
            here.copy_from_slice(row);
            let last = width - 1;
            row[0] = 0.25 * (3.0 * here[0] + here[1.min(last)]);
            row[last] = 0.25 * (3.0 * here[last] + here[last.saturating_sub(1)]);
            for (out, three) in row.iter_mut().skip(1).zip(here.windows(3)) {
                *out = 0.25 * (three[0] + 2.0 * three[1] + three[2]);
            }
        }
        let mut rows = channel.chunks_mut(width.max(1)).peekable();
        if let Some(first) = rows.peek() {
            before.copy_from_slice(first);
        }
        while let Some(row) = rows.next() {
            here.copy_from_slice(row);
            let below = rows.peek().map_or(&here[..], |below| below);
            for (((out, above), here), below) in row.iter_mut().zip(&before).zip(&here).zip(below) {
                *out = 0.25 * (above + 2.0 * here + below);
            }
            std::mem::swap(&mut before, &mut here);
        }
    }
    image
}

#[cfg(test)]
mod tests;
