//! Small, even cells of a photograph, which are later put together to superpixels.
//!
//! Method       SLIC (Achanta, Shaji, Smith, Lucchi, Fua, Süsstrunk, PAMI 2012): k-means in colour and place, each centre looking
//!              only at the pixels about it. Pieces that hang together become cells of their own: here a stray piece may stay
//!              one, since merging decides what it belongs to. (Crates that absorb stray pieces at once leave planes more often
//!              and take twice as long.)

use super::colour::{Colour, LabImage};

/// Side of a cell. Window frames and ledges are as fine.
const CELL_PX: f32 = 10.0;
/// Colour difference that weighs as much as the side of a cell (the paper's m).
const COMPACTNESS: f32 = 10.0;
/// The paper's ten change little after the fourth.
const ROUNDS: usize = 4;

/// Connected cells: their number, and the cell of each pixel.
pub(super) struct Cells {
    pub count: usize,
    pub of_pixel: Vec<u32>,
}

pub(super) fn slic(image: &LabImage) -> Cells {
    let mut centers = seeds(image);
    let mut nearest = vec![0; image.pixels.len()];
    for _ in 0..ROUNDS {
        assign(image, &centers, &mut nearest);
        recenter(image, &nearest, &mut centers);
    }
    connected(&nearest, image.width, image.height)
}

#[derive(Clone, Copy)]
struct Center {
    colour: Colour,
    x: f32,
    y: f32,
}

fn seeds(image: &LabImage) -> Vec<Center> {
    let cells = |length: usize| ((length as f32 / CELL_PX).round() as usize).max(1);
    let (columns, rows) = (cells(image.width), cells(image.height));
    let middle = |i: usize, cells: usize, length: usize| (2 * i + 1) * length / (2 * cells);
    let seed = |i: usize| {
        let (x, y) = (middle(i % columns, columns, image.width), middle(i / columns, rows, image.height));
        Center { colour: image.pixels[y * image.width + x], x: x as f32, y: y as f32 }
    };
    (0..columns * rows).map(seed).collect()
}

/// Gives each pixel the nearest of the centres within a cell's side; the first of equals.
fn assign(image: &LabImage, centers: &[Center], nearest: &mut [u32]) {
    let per_px = (COMPACTNESS / CELL_PX).powi(2);
    let window = |at: f32, length: usize| ((at - CELL_PX).max(0.0) as usize, ((at + CELL_PX) as usize + 1).min(length));
    let mut least = vec![f32::INFINITY; nearest.len()];
    for (index, center) in centers.iter().enumerate() {
        let ((left, right), (top, bottom)) = (window(center.x, image.width), window(center.y, image.height));
        for y in top..bottom {
            let down = (y as f32 - center.y).powi(2);
            let row = y * image.width..(y + 1) * image.width;
            let pixels = &image.pixels[row.clone()][left..right];
            let (least, nearest) = (&mut least[row.clone()][left..right], &mut nearest[row][left..right]);
            for (i, pixel) in pixels.iter().enumerate() {
                let colour: f32 = (0..3).map(|k| (pixel[k] - center.colour[k]).powi(2)).sum();
                let distance = colour + per_px * (((left + i) as f32 - center.x).powi(2) + down);
                if distance < least[i] {
                    (least[i], nearest[i]) = (distance, index as u32);
                }
            }
        }
    }
}

/// Moves each centre to the mean of its pixels; one without pixels stays.
fn recenter(image: &LabImage, nearest: &[u32], centers: &mut [Center]) {
    let mut sums = vec![[0.0_f64; 6]; centers.len()];
    for (i, (pixel, &center)) in image.pixels.iter().zip(nearest).enumerate() {
        let (x, y) = (i % image.width, i / image.width);
        let parts = [f64::from(pixel[0]), f64::from(pixel[1]), f64::from(pixel[2]), x as f64, y as f64, 1.0];
        for (sum, part) in sums[center as usize].iter_mut().zip(parts) {
            *sum += part;
        }
    }
    for (center, [l, a, b, x, y, count]) in centers.iter_mut().zip(sums) {
        if count > 0.0 {
            let mean = |sum: f64| (sum / count) as f32;
            *center = Center { colour: [mean(l), mean(a), mean(b)], x: mean(x), y: mean(y) };
        }
    }
}

/// Pieces of equal value that hang together by their sides, numbered as they come.
fn connected(values: &[u32], width: usize, height: usize) -> Cells {
    const NONE: u32 = u32::MAX;
    let mut of_pixel = vec![NONE; values.len()];
    let mut count = 0;
    let mut open = Vec::new();
    for first in 0..values.len() {
        if of_pixel[first] != NONE {
            continue;
        }
        of_pixel[first] = count;
        open.push(first);
        while let Some(pixel) = open.pop() {
            let (x, y) = (pixel % width, pixel / width);
            let left = (x > 0).then(|| pixel - 1);
            let right = (x + 1 < width).then(|| pixel + 1);
            let above = (y > 0).then(|| pixel - width);
            let below = (y + 1 < height).then(|| pixel + width);
            for beside in [left, right, above, below].into_iter().flatten() {
                if of_pixel[beside] == NONE && values[beside] == values[first] {
                    of_pixel[beside] = count;
                    open.push(beside);
                }
            }
        }
        count += 1;
    }
    Cells { count: count as usize, of_pixel }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_one_value_that_do_not_touch_become_cells_of_their_own() {
        let cells = connected(&[7, 7, 3, 3, 7, 3, 7, 7, 3], 3, 3);
        assert_eq!((cells.count, cells.of_pixel), (3, vec![0, 0, 1, 2, 0, 1, 0, 0, 1]));
    }

    #[test]
    fn a_cell_ends_where_the_colour_does() {
        let photo =
            image::RgbImage::from_fn(60, 40, |x, _| image::Rgb(if x < 27 { [200, 40, 40] } else { [40, 60, 200] }));
        let image = LabImage::of(&photo);
        let cells = slic(&image);
        for (i, cell) in cells.of_pixel.iter().enumerate().filter(|(i, _)| i % 60 < 26) {
            let other_side = i / 60 * 60 + 28;
            assert_ne!(*cell, cells.of_pixel[other_side]);
        }
    }
}
