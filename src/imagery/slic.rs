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
    let (mut least, mut nearest) = (vec![0.0; image.width * image.height], vec![0; image.width * image.height]);
    for round in 0..ROUNDS {
        if round > 0 {
            recenter(image, &nearest, &mut centers);
        }
        least.fill(f32::INFINITY);
        assign(image, &centers, &mut least, &mut nearest);
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
        Center { colour: image.pixel(y * image.width + x), x: x as f32, y: y as f32 }
    };
    (0..columns * rows).map(seed).collect()
}

/// Pixels that a processor handles at once.
const LANES: usize = 4;

/// Gives each pixel the nearest of the centres within a cell's side, or a few pixels farther; the first of equals. `least` is how far it is.
fn assign(image: &LabImage, centers: &[Center], least: &mut [f32], nearest: &mut [u32]) {
    let per_px = (COMPACTNESS / CELL_PX).powi(2);
    let window = |at: f32, length: usize| ((at - CELL_PX).max(0.0) as usize, ((at + CELL_PX) as usize + 1).min(length));
    let (mut across, mut down) = (Vec::new(), Vec::new());
    for (center, index) in centers.iter().zip(0..) {
        let ((left, right), (top, bottom)) = (window(center.x, image.width), window(center.y, image.height));
        let right = (left + (right - left).next_multiple_of(LANES)).min(image.width);
        let apart = |at: usize, center: f32| per_px * (at as f32 - center).powi(2);
        across.clear();
        across.extend((left..right).map(|x| apart(x, center.x)));
        down.clear();
        down.extend((top..bottom).map(|y| apart(y, center.y)));
        let window = top * image.width + left..(bottom - 1) * image.width + right;
        let channels = image.channels.each_ref().map(|channel| &channel[window.clone()]);
        let apart = Apart { across: &across, down: &down, width: image.width };
        offer(center, index, channels, &apart, &mut least[window.clone()], &mut nearest[window]);
    }
}

/// What the columns and rows of a window stand off a centre, squared, in colours; and the width of the image.
struct Apart<'a> {
    across: &'a [f32],
    down: &'a [f32],
    width: usize,
}

/// Offers a centre to the pixels of a window. Without branches, so that the compiler handles several pixels at once.
#[inline(never)]
fn offer(center: &Center, index: u32, [l, a, b]: [&[f32]; 3], apart: &Apart, least: &mut [f32], nearest: &mut [u32]) {
    let (across, count, [of_l, of_a, of_b]) = (apart.across, apart.across.len(), center.colour);
    for (row, down) in apart.down.iter().enumerate() {
        let row = row * apart.width..row * apart.width + count;
        let (l, a, b) = (&l[row.clone()], &a[row.clone()], &b[row.clone()]);
        let (least, nearest) = (&mut least[row.clone()], &mut nearest[row]);
        for i in 0..count {
            let off = [l[i] - of_l, a[i] - of_a, b[i] - of_b];
            let distance = off[0] * off[0] + off[1] * off[1] + off[2] * off[2] + (across[i] + down);
            let is_nearer = distance < least[i];
            let mask = u32::from(is_nearer).wrapping_neg();
            least[i] = f32::from_bits(choose(mask, distance.to_bits(), least[i].to_bits()));
            nearest[i] = choose(mask, index, nearest[i]);
        }
    }
}

/// `a` where all bits of the mask are set, `b` where none is; without a branch, so that several pixels are done at once.
#[inline]
fn choose(mask: u32, a: u32, b: u32) -> u32 {
    a & mask | b & !mask
}

/// Moves each centre to the mean of its pixels; one without pixels stays.
fn recenter(image: &LabImage, nearest: &[u32], centers: &mut [Center]) {
    let mut sums = vec![[0.0_f64; 6]; centers.len()];
    for (y, row) in nearest.chunks(image.width).enumerate() {
        let mut first = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let pixels = y * image.width + first..y * image.width + first + run.len();
            let [l, a, b] = image.sum(pixels).map(f64::from);
            let count = run.len() as f64;
            let along = count * (first as f64 + 0.5 * (count - 1.0));
            let parts = [l, a, b, along, count * y as f64, count];
            sums[run[0] as usize].iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            first += run.len();
        }
    }
    for (center, [l, a, b, x, y, count]) in centers.iter_mut().zip(sums) {
        if count > 0.0 {
            let mean = |sum: f64| (sum / count) as f32;
            *center = Center { colour: [mean(l), mean(a), mean(b)], x: mean(x), y: mean(y) };
        }
    }
}

/// Pieces of equal value that hang together by their sides, numbered as they come: runs of a row are joined to those that they touch
/// above.
fn connected(values: &[u32], width: usize, height: usize) -> Cells {
    let mut runs: Vec<Run> = Vec::with_capacity(values.len() / 4);
    let mut above = 0..0;
    for row in values.chunks(width.max(1)).take(height) {
        let begun = runs.len();
        let (mut first, mut touched) = (0, above.start);
        for run in row.chunk_by(|a, b| a == b) {
            let (end, at) = (first + run.len() as u32, runs.len() as u32);
            runs.push(Run { value: run[0], first, end, piece: at });
            // Those that end before this one begins touch none that follow.
            while touched < above.end && runs[touched].end <= first {
                touched += 1;
            }
            let mut other = touched;
            while other < above.end && runs[other].first < end {
                if runs[other].value == run[0] {
                    join(&mut runs, other as u32, at);
                }
                other += 1;
            }
            first = end;
        }
        above = begun..runs.len();
    }
    let mut cells = Cells { count: 0, of_pixel: Vec::with_capacity(values.len()) };
    let mut numbers = vec![0; runs.len()];
    for at in 0..runs.len() as u32 {
        let piece = piece_of(&mut runs, at);
        if piece == at {
            numbers[at as usize] = cells.count as u32;
            cells.count += 1;
        }
        let run = &runs[at as usize];
        let length = (run.end - run.first) as usize;
        cells.of_pixel.extend(std::iter::repeat_n(numbers[piece as usize], length));
    }
    cells
}

/// Pixels of one value beside each other in a row.
struct Run {
    value: u32,
    first: u32,
    end: u32,
    /// A run of the same piece that came before it; itself where there is none.
    piece: u32,
}

/// Two runs are of one piece, whose number is that of its first.
fn join(runs: &mut [Run], a: u32, b: u32) {
    let (a, b) = (piece_of(runs, a), piece_of(runs, b));
    runs[a.max(b) as usize].piece = a.min(b);
}

fn piece_of(runs: &mut [Run], mut run: u32) -> u32 {
    loop {
        let before = runs[run as usize].piece;
        if before == run {
            return run;
        }
        runs[run as usize].piece = runs[before as usize].piece;
        run = before;
    }
}

#[cfg(test)]
mod tests;
