//! Superpixels of a photograph: pieces that each show, as well as colours can tell, one plane.
//!
//! Method       Cells ([`slic`]) are merged, always the pair that costs least, until as many are left as asked for. The cost grows
//!              with what the merged superpixel would hold (Ward 1963: one that holds much must not become uneven), with the
//!              difference of the mean colours and with the contrast across the common border, and falls with the border's
//!              length, so that pieces grow round instead of long. What a superpixel holds are its pixels, and the keypoints in it:
//!              where the photograph has many of them, superpixels stay small, and few points are lost with one that bends.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use image::RgbImage;

use super::colour::{Colour, LabImage, distance};
use super::labels::index_at;
use super::slic::{Cells, slic};
use super::{LabelMap, Labels};

/// How photographs are cut into superpixels.
#[derive(Clone, Debug, PartialEq)]
pub struct SuperpixelOptions {
    /// As many are left of each photograph.
    pub count: usize,
    /// Whether superpixels are smaller where the reconstruction has keypoints. Two reconstructions of one photograph have
    /// the same superpixels only without.
    pub by_keypoints: bool,
}

impl Default for SuperpixelOptions {
    fn default() -> SuperpixelOptions {
        SuperpixelOptions { count: 150, by_keypoints: true }
    }
}

/// Weight of the contrast across the border against the difference of the mean colours.
const BORDER_WEIGHT: f32 = 2.0;
/// Contrast is taken between the pixels this far behind the border on either side, since edges are two pixels wide.
const BEHIND_BORDER_PX: usize = 1;

/// Cuts a photograph into connected superpixels with the labels 1, 2, ...; `keypoints` are places (x, y) in the photograph,
/// in pixels, where it shows points. The map may be smaller than the photograph.
pub fn cut_superpixels(photo: &RgbImage, keypoints: &[(f64, f64)], options: &SuperpixelOptions) -> LabelMap {
    let image = LabImage::of(photo);
    if image.is_empty() {
        return LabelMap { width: photo.width(), height: photo.height(), labels: Labels::U8(Vec::new()) };
    }
    let cells = slic(&image);
    let keypoints = keypoint_pixels(&image, photo.dimensions(), keypoints);
    let labels = Merging::new(regions(&image, &cells, &keypoints)).down_to(options.count);
    let labels = cells.of_pixel.into_iter().map(|cell| labels[cell as usize]).collect();
    LabelMap { width: image.width as u32, height: image.height as u32, labels: Labels::U32(labels) }
}

/// Indices of the pixels under the keypoints; those outside are left out.
fn keypoint_pixels(image: &LabImage, size: (u32, u32), keypoints: &[(f64, f64)]) -> Vec<usize> {
    let size_here = (image.width as u32, image.height as u32);
    keypoints.iter().filter_map(|&(x, y)| index_at(x, y, size, size_here)).collect()
}

/// A superpixel as it grows.
struct Region {
    /// Pixels, and keypoints in pixels' worth.
    mass: f32,
    pixels: f32,
    colour_sum: Colour,
    /// To every neighbour, one each.
    borders: Vec<Border>,
    /// What merging with some neighbour costs at least.
    cheapest: Cost,
    /// What it has been merged into.
    part_of: Option<u32>,
}

/// Border of a region with one neighbour; both regions have it.
#[derive(Clone, Copy)]
struct Border {
    with: u32,
    length_px: f32,
    contrast_sum: f32,
    /// Of merging the two as they are.
    cost: Cost,
}

/// The bits of a number that is not negative, which order as it does.
type Cost = u32;

/// More than merging costs.
const NOTHING_TO_MERGE_WITH: Cost = Cost::MAX;

struct Merging {
    regions: Vec<Region>,
    /// What is cheapest to each region, the cheapest first. What was its cheapest before is there too, and passed over.
    queue: BinaryHeap<Reverse<(Cost, u32)>>,
}

impl Merging {
    fn new(regions: Vec<Region>) -> Merging {
        let queue = regions.iter().zip(0..).map(|(region, number)| Reverse((region.cheapest, number))).collect();
        Merging { regions, queue }
    }

    /// Merges until `count` are left, or nothing touches; the label of each cell.
    fn down_to(mut self, count: usize) -> Vec<u32> {
        let mut left = self.regions.len();
        while left > count.max(1) {
            let Some(Reverse((cost, number))) = self.queue.pop() else { break };
            let region = &self.regions[number as usize];
            let cheapest = region.borders.iter().filter(|border| border.cost == cost && region.cheapest == cost);
            if let Some(with) = cheapest.map(|border| border.with).min() {
                self.merge(number, with);
                left -= 1;
            }
        }
        self.labels()
    }

    /// The one with fewer neighbours goes into the other.
    fn merge(&mut self, a: u32, b: u32) {
        let neighbours = |region: u32| self.regions[region as usize].borders.len();
        let (into, from) = if neighbours(a) >= neighbours(b) { (a, b) } else { (b, a) };
        let gone = &mut self.regions[from as usize];
        gone.part_of = Some(into);
        gone.cheapest = NOTHING_TO_MERGE_WITH;
        let (mass, pixels, colour_sum) = (gone.mass, gone.pixels, gone.colour_sum);
        let inherited = std::mem::take(&mut gone.borders);
        let grown = &mut self.regions[into as usize];
        grown.mass += mass;
        grown.pixels += pixels;
        add(&mut grown.colour_sum, &colour_sum);
        grown.borders.retain(|border| border.with != from);
        for border in inherited.into_iter().filter(|border| border.with != into) {
            self.regions[into as usize].join_border(border);
            let beside = &mut self.regions[border.with as usize];
            beside.borders.retain(|border| border.with != from);
            beside.join_border(Border { with: into, ..border });
        }
        self.count_costs(into);
    }

    /// Counts anew what merging costs a region that has changed, and its neighbours.
    fn count_costs(&mut self, number: u32) {
        let mut borders = std::mem::take(&mut self.regions[number as usize].borders);
        for border in &mut borders {
            border.cost = merging_cost(&self.regions[number as usize], &self.regions[border.with as usize], border);
            let beside = &mut self.regions[border.with as usize];
            if let Some(theirs) = beside.borders.iter_mut().find(|theirs| theirs.with == number) {
                theirs.cost = border.cost;
            }
            if beside.find_cheapest() {
                self.queue.push(Reverse((beside.cheapest, border.with)));
            }
        }
        let here = &mut self.regions[number as usize];
        here.borders = borders;
        if here.find_cheapest() {
            self.queue.push(Reverse((here.cheapest, number)));
        }
    }

    /// 1, 2, ... as the first cells come.
    fn labels(&self) -> Vec<u32> {
        let mut labels = vec![0; self.regions.len()];
        let mut count = 0;
        for cell in 0..self.regions.len() {
            let mut root = cell;
            while let Some(into) = self.regions[root].part_of {
                root = into as usize;
            }
            if labels[root] == 0 {
                count += 1;
                labels[root] = count;
            }
            labels[cell] = labels[root];
        }
        labels
    }
}

impl Region {
    fn mean_colour(&self) -> Colour {
        self.colour_sum.map(|sum| sum / self.pixels)
    }

    /// Whether the cheapest has another cost than before.
    fn find_cheapest(&mut self) -> bool {
        let before = self.cheapest;
        self.cheapest = self.borders.iter().map(|border| border.cost).min().unwrap_or(NOTHING_TO_MERGE_WITH);
        self.cheapest != before
    }

    fn join_border(&mut self, more: Border) {
        match self.borders.iter_mut().find(|border| border.with == more.with) {
            Some(border) => {
                border.length_px += more.length_px;
                border.contrast_sum += more.contrast_sum;
            }
            None => self.borders.push(more),
        }
    }
}

fn merging_cost(a: &Region, b: &Region, border: &Border) -> Cost {
    // To the power of 1.25: Ward's 1 lets small pieces stay too long.
    let mass = a.mass * b.mass / (a.mass + b.mass);
    let mass = mass * mass.sqrt().sqrt();
    let contrast = border.contrast_sum / border.length_px;
    let difference = distance(&a.mean_colour(), &b.mean_colour()) + BORDER_WEIGHT * contrast;
    let relative_length = border.length_px / a.pixels.min(b.pixels).sqrt();
    (mass * difference * difference / relative_length).to_bits()
}

/// A region of each cell, with its borders and what merging across them costs.
fn regions(image: &LabImage, cells: &Cells, keypoint_pixels: &[usize]) -> Vec<Region> {
    let empty = || Region {
        mass: 0.0,
        pixels: 0.0,
        colour_sum: [0.0; 3],
        borders: Vec::new(),
        cheapest: NOTHING_TO_MERGE_WITH,
        part_of: None,
    };
    let mut regions: Vec<Region> = std::iter::repeat_with(empty).take(cells.count).collect();
    let mut first = 0;
    for run in cells.of_pixel.chunk_by(|a, b| a == b) {
        let region = &mut regions[run[0] as usize];
        let pixels = first..first + run.len();
        region.pixels += run.len() as f32;
        add(&mut region.colour_sum, &image.sum(pixels.clone()));
        first = pixels.end;
    }
    regions.iter_mut().for_each(|region| region.mass = region.pixels);
    // All keypoints together weigh as much as all pixels.
    let mass = cells.of_pixel.len() as f32 / keypoint_pixels.len() as f32;
    keypoint_pixels.iter().for_each(|&pixel| regions[cells.of_pixel[pixel] as usize].mass += mass);
    for_each_step(image, cells, |[a, b], contrast_sum| {
        regions[a.min(b) as usize].join_border(Border { with: a.max(b), length_px: 1.0, contrast_sum, cost: 0 });
    });
    // So far the smaller number has the border of a pair.
    for number in 0..cells.count {
        let mut borders = std::mem::take(&mut regions[number].borders);
        for border in borders.iter_mut().filter(|border| border.with as usize > number) {
            border.cost = merging_cost(&regions[number], &regions[border.with as usize], border);
            regions[border.with as usize].borders.push(Border { with: number as u32, ..*border });
        }
        regions[number].borders = borders;
        regions[number].find_cheapest();
    }
    regions
}

/// Tells of each step from pixel to pixel that crosses the border of two cells: which two, and the contrast there.
fn for_each_step(image: &LabImage, cells: &Cells, mut step: impl FnMut([u32; 2], f32)) {
    let (width, height) = (image.width, image.height);
    let contrast = |[a, b]: [usize; 2]| distance(&image.pixel(a), &image.pixel(b));
    let before = |at: usize| at.saturating_sub(BEHIND_BORDER_PX);
    let after = |at: usize, length: usize| (at + 1 + BEHIND_BORDER_PX).min(length - 1);
    for y in 0..height {
        let row = &cells.of_pixel[y * width..(y + 1) * width];
        for (x, pair) in row.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]) {
            step([pair[0], pair[1]], contrast([before(x), after(x, width)].map(|x| y * width + x)));
        }
        let below = cells.of_pixel.get((y + 1) * width..(y + 2) * width).unwrap_or_default();
        for (x, (a, b)) in row.iter().zip(below).enumerate().filter(|(_, (a, b))| a != b) {
            step([*a, *b], contrast([before(y), after(y, height)].map(|y| y * width + x)));
        }
    }
}

fn add(sum: &mut Colour, colour: &Colour) {
    for (sum, value) in sum.iter_mut().zip(colour) {
        *sum += value;
    }
}

#[cfg(test)]
mod tests;
