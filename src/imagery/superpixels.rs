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
    let mut merging = Merging::new(&image, &cells);
    merging.add_keypoints(&cells, &keypoint_pixels(&image, photo.dimensions(), keypoints));
    let labels = merging.down_to(options.count);
    let labels = cells.of_pixel.iter().map(|&cell| labels[cell as usize]).collect();
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
    /// Counts the changes, which make costs outdated.
    version: u32,
    /// What it has been merged into.
    part_of: Option<u32>,
}

#[derive(Clone, Copy)]
struct Border {
    with: u32,
    length_px: f32,
    contrast_sum: f32,
}

struct Merging {
    regions: Vec<Region>,
    /// The cheapest first.
    queue: BinaryHeap<Reverse<Offer>>,
}

/// What it costs to merge two regions, as they are at these versions; ordered by the cost, whose bits order as it does.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Offer {
    cost_bits: u32,
    pair: [u32; 2],
    versions: [u32; 2],
}

impl Merging {
    fn new(image: &LabImage, cells: &Cells) -> Merging {
        let empty =
            || Region { mass: 0.0, pixels: 0.0, colour_sum: [0.0; 3], borders: Vec::new(), version: 0, part_of: None };
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
        for ([a, b], border) in borders(image, cells) {
            regions[a as usize].borders.push(Border { with: b, ..border });
            regions[b as usize].borders.push(Border { with: a, ..border });
        }
        Merging { regions, queue: BinaryHeap::new() }
    }

    /// All keypoints together weigh as much as all pixels.
    fn add_keypoints(&mut self, cells: &Cells, pixels: &[usize]) {
        let mass = cells.of_pixel.len() as f32 / pixels.len() as f32;
        for &pixel in pixels {
            self.regions[cells.of_pixel[pixel] as usize].mass += mass;
        }
    }

    /// Merges until `count` are left, or nothing touches; the label of each cell.
    fn down_to(mut self, count: usize) -> Vec<u32> {
        let all = 0..self.regions.len() as u32;
        let offers = all.flat_map(|region| self.offers(region).filter(move |offer| offer.pair[1] > region));
        self.queue = offers.map(Reverse).collect();
        let mut left = self.regions.len();
        while left > count.max(1) {
            let Some(Reverse(Offer { pair: [a, b], versions, .. })) = self.queue.pop() else { break };
            let holds = [a, b].iter().zip(versions).all(|(&region, version)| {
                let region = &self.regions[region as usize];
                region.part_of.is_none() && region.version == version
            });
            if holds {
                self.merge(a, b);
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
        let (mass, pixels, colour_sum) = (gone.mass, gone.pixels, gone.colour_sum);
        let inherited = std::mem::take(&mut gone.borders);
        let grown = &mut self.regions[into as usize];
        grown.mass += mass;
        grown.pixels += pixels;
        add(&mut grown.colour_sum, &colour_sum);
        grown.version += 1;
        grown.borders.retain(|border| border.with != from);
        for border in inherited.into_iter().filter(|border| border.with != into) {
            self.regions[into as usize].join_border(border);
            let beside = &mut self.regions[border.with as usize];
            beside.borders.retain(|border| border.with != from);
            beside.join_border(Border { with: into, ..border });
        }
        let mut queue = std::mem::take(&mut self.queue);
        queue.extend(self.offers(into).map(Reverse));
        self.queue = queue;
    }

    /// To merge a region with each of its neighbours.
    fn offers(&self, region: u32) -> impl Iterator<Item = Offer> {
        let here = &self.regions[region as usize];
        here.borders.iter().map(move |border| {
            let there = &self.regions[border.with as usize];
            Offer {
                cost_bits: merging_cost(here, there, border).to_bits(),
                pair: [region, border.with],
                versions: [here.version, there.version],
            }
        })
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

fn merging_cost(a: &Region, b: &Region, border: &Border) -> f32 {
    // To the power of 1.25: Ward's 1 lets small pieces stay too long.
    let mass = a.mass * b.mass / (a.mass + b.mass);
    let mass = mass * mass.sqrt().sqrt();
    let contrast = border.contrast_sum / border.length_px;
    let difference = distance(&a.mean_colour(), &b.mean_colour()) + BORDER_WEIGHT * contrast;
    let relative_length = border.length_px / a.pixels.min(b.pixels).sqrt();
    mass * difference * difference / relative_length
}

/// The border of each two cells that touch, by the pair, smaller number first; `with` is not set yet.
fn borders(image: &LabImage, cells: &Cells) -> Vec<([u32; 2], Border)> {
    let (width, height) = (image.width, image.height);
    let mut steps: Vec<Step> = Vec::new();
    let mut step = |[a, b]: [u32; 2], behind: [usize; 2]| {
        let contrast = distance(&image.pixel(behind[0]), &image.pixel(behind[1]));
        steps.push(Step { pair: [a.min(b), a.max(b)], contrast });
    };
    let before = |at: usize| at.saturating_sub(BEHIND_BORDER_PX);
    let after = |at: usize, length: usize| (at + 1 + BEHIND_BORDER_PX).min(length - 1);
    for y in 0..height {
        let row = &cells.of_pixel[y * width..(y + 1) * width];
        for (x, pair) in row.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]) {
            step([pair[0], pair[1]], [before(x), after(x, width)].map(|x| y * width + x));
        }
        let below = cells.of_pixel.get((y + 1) * width..(y + 2) * width).unwrap_or_default();
        for (x, (a, b)) in row.iter().zip(below).enumerate().filter(|(_, (a, b))| a != b) {
            step([*a, *b], [before(y), after(y, height)].map(|y| y * width + x));
        }
    }
    let gather = |steps: &[Step]| {
        let contrast_sum = steps.iter().map(|step| step.contrast).sum();
        (steps[0].pair, Border { with: 0, length_px: steps.len() as f32, contrast_sum })
    };
    sorted(&steps, cells.count).chunk_by(|a, b| a.pair == b.pair).map(gather).collect()
}

/// A step from pixel to pixel across the border of two cells, the smaller number first.
#[derive(Clone, Copy)]
struct Step {
    pair: [u32; 2],
    contrast: f32,
}

/// By the pair; stable, so that sums do not depend on anything but the picture. Few steps begin at one cell: they are put to it first.
fn sorted(steps: &[Step], cells: usize) -> Vec<Step> {
    let mut next = vec![0usize; cells + 1];
    steps.iter().for_each(|step| next[step.pair[0] as usize + 1] += 1);
    (1..next.len()).for_each(|i| next[i] += next[i - 1]);
    let mut sorted = vec![Step { pair: [0; 2], contrast: 0.0 }; steps.len()];
    for step in steps {
        let place = &mut next[step.pair[0] as usize];
        sorted[*place] = *step;
        *place += 1;
    }
    sorted.chunk_by_mut(|a, b| a.pair[0] == b.pair[0]).for_each(|of_cell| of_cell.sort_by_key(|step| step.pair[1]));
    sorted
}

fn add(sum: &mut Colour, colour: &Colour) {
    for (sum, value) in sum.iter_mut().zip(colour) {
        *sum += value;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Two walls that meet at x = 47 and a strip of sky above them, each with a little texture.
    fn corner() -> RgbImage {
        RgbImage::from_fn(120, 90, |x, y| {
            let grain = ((x * 7 + y * 13) % 11) as u8;
            let base = match (x < 47, y < 20) {
                (_, true) => [150, 180, 220],
                (true, _) => [170, 90, 70],
                (false, _) => [120, 110, 100],
            };
            image::Rgb(base.map(|v| v + grain))
        })
    }

    fn labels_of(map: &LabelMap, keep: impl Fn(u32, u32) -> bool) -> BTreeSet<u32> {
        let indexed = map.labels.iter().enumerate();
        indexed.filter(|(i, _)| keep(*i as u32 % map.width, *i as u32 / map.width)).map(|(_, label)| label).collect()
    }

    #[test]
    fn as_many_superpixels_are_left_as_asked_for() {
        for count in [1, 3, 20] {
            let map = cut_superpixels(&corner(), &[], &SuperpixelOptions { count, ..SuperpixelOptions::default() });
            assert_eq!(labels_of(&map, |_, _| true), (1..=count as u32).collect());
        }
    }

    #[test]
    fn no_superpixel_lies_on_both_sides_of_an_edge() {
        let map = cut_superpixels(&corner(), &[], &SuperpixelOptions { count: 6, ..SuperpixelOptions::default() });
        let sky = labels_of(&map, |_, y| y < 19);
        let left = labels_of(&map, |x, y| x < 46 && y > 21);
        let right = labels_of(&map, |x, y| x > 48 && y > 21);
        assert!(sky.is_disjoint(&left) && left.is_disjoint(&right) && right.is_disjoint(&sky));
    }

    #[test]
    fn superpixels_are_smaller_where_keypoints_are_dense() {
        let keypoints: Vec<(f64, f64)> =
            (0..200).map(|i| (60.0 + f64::from(i % 50), 30.0 + f64::from(i / 50) * 12.0)).collect();
        let on_right = |keypoints: &[(f64, f64)]| {
            let map =
                cut_superpixels(&corner(), keypoints, &SuperpixelOptions { count: 20, ..SuperpixelOptions::default() });
            labels_of(&map, |x, y| x > 48 && y > 21).len()
        };
        assert!(on_right(&keypoints) > on_right(&[]));
    }

    #[test]
    fn tiny_and_empty_pictures_are_cut_too() {
        for (width, height) in [(0, 0), (1, 1), (1, 40), (3, 2)] {
            let map = cut_superpixels(&RgbImage::new(width, height), &[(0.5, 0.5)], &SuperpixelOptions::default());
            assert_eq!(map.labels.len(), (width * height) as usize);
        }
    }
}
