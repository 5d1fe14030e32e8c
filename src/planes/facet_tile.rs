//! One tile of a grid of facets: the triangles that come within reach of its cells.
//!
//! Question     which triangle of a cell lies nearest to a point and faces its way?
//! Method       Triangles that face another way are passed over class by class; of the others, one cache line each tells in single precision
//!              how far the point is, to within a margin that is known; what may be the nearest is looked at in double precision, so
//!              that the answer is that of double precision throughout.
//!              Neighbouring cells mostly have the same triangles, and share their list.

use super::directions::{Directions, Facing};
use super::facet_visibility::FacetVisibility;
use super::hit::{Hit, OrientedPoint};
use super::surface::CitySurface;
use super::tile_triangle::{Outline, TileTriangle};
use crate::geometry::{Point3, Vector3};

/// Cells along an edge of a tile.
pub(super) const TILE: usize = 16;
const CELLS: usize = TILE * TILE * TILE;

/// Where a tile stands.
pub(super) struct TileSite {
    pub low: Point3<f64>,
    pub cell_m: f64,
    pub reach_m: f64,
}

/// The cells of one tile.
pub(super) struct Tile {
    /// Single precision is about this.
    middle: Point3<f64>,
    /// Single precision tells distances to within this, metres.
    margin_m: f64,
    /// For each cell where its list begins in `lists`, by [`Cell`].
    cells: Box<[u32; CELLS]>,
    /// Lists behind each other: runs of triangles of one class, each after its [`Run`], and a run of none at the end. The first list is
    /// that of cells without triangles.
    lists: Vec<u32>,
    outlines: Vec<Outline>,
    triangles: Vec<TileTriangle>,
}

/// Where a list begins.
#[derive(Clone, Copy, Default)]
pub(super) struct List(u32);

impl List {
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Where a cell stands among those of its tile: blocks of 4 by 4 by 4, so that what is near in space is near in memory.
#[derive(Clone, Copy)]
pub(super) struct Cell(u16);

impl Cell {
    #[inline]
    pub fn at([x, y, z]: [usize; 3]) -> Cell {
        let block = (z / 4 * 4 + y / 4) * 4 + x / 4;
        Cell((block * 64 + (z % 4 * 4 + y % 4) * 4 + x % 4) as u16)
    }
}

/// Triangles that are fetched before they are looked at.
const FETCHED: usize = 4;

/// Head of a run of triangles in a list: their class, and how many they are.
struct Run;

impl Run {
    const COUNT_BITS: u32 = 26;

    fn head(class: u32, count: usize) -> u32 {
        class << Run::COUNT_BITS | count as u32
    }

    #[inline]
    fn of(head: u32) -> (u32, usize) {
        (head >> Run::COUNT_BITS, (head & ((1 << Run::COUNT_BITS) - 1)) as usize)
    }
}

/// What single precision may be off, as a share of a tile's width: places and offsets of up to two widths, rounded (6e-8) some times.
const MARGIN_OF_TILE: f64 = 4e-6;
/// Rounding of a place in cells, and of a reach as a share of it.
const CELL_ROUNDING: f64 = 1e-6;

impl Tile {
    /// `near` are the triangles that may come within reach, in rising order.
    pub fn new(site: &TileSite, near: &[u32], surface: &CitySurface, exposure: &FacetVisibility) -> Tile {
        let width_m = site.cell_m * TILE as f64;
        let middle = site.low + Vector3::repeat(0.5 * width_m);
        let prepared = |&t: &u32| TileTriangle::new(t, &surface.corners(t), surface, surface.facet_of(t));
        let mut triangles: Vec<TileTriangle> = near.iter().filter_map(prepared).collect();
        triangles.sort_by_key(|t| Directions::class(&t.normal));
        let stretches = Stretches::of(site, &mut triangles, surface, exposure);
        let classes: Vec<u32> = triangles.iter().map(|t| Directions::class(&t.normal)).collect();
        let (cells, lists) = stretches.lists(&classes);
        Tile {
            middle,
            margin_m: MARGIN_OF_TILE * width_m,
            cells,
            lists,
            outlines: triangles.iter().map(|t| Outline::new(t, &middle, width_m)).collect(),
            triangles,
        }
    }

    #[inline]
    pub fn list(&self, Cell(at): Cell) -> List {
        List(self.cells[usize::from(at)])
    }

    /// Begins to fetch a list from memory.
    #[inline]
    pub fn fetch_list(&self, List(at): List) {
        std::hint::black_box(self.lists.get(at as usize + 1));
    }

    /// Begins to fetch the first triangles of a list.
    #[inline]
    pub fn fetch_triangles(&self, List(at): List) {
        for next in at as usize + 1..at as usize + 1 + FETCHED {
            // Heads of runs are larger than any index.
            let outline = self.lists.get(next).and_then(|i| self.outlines.get(*i as usize));
            std::hint::black_box(outline.map(|outline| outline.offset[0]));
        }
    }

    /// The nearest triangle of a list within `gate_m`, at most the grid's reach, whose outward normal agrees with the sample point's; of
    /// equals the first of the model.
    #[inline]
    pub fn nearest(&self, List(at): List, sample_point: &OrientedPoint, facing: &Facing, gate_m: f64) -> Option<Hit> {
        let mut at = at as usize;
        let place = (sample_point.position - self.middle).map(|x| x as f32);
        let (mut best, mut best_sq, mut wide) = (None, gate_m * gate_m, self.widened(gate_m * gate_m));
        loop {
            let (class, count) = Run::of(self.lists[at]);
            let run = at + 1..at + 1 + count;
            at = run.end;
            if count == 0 {
                break;
            }
            if facing.classes >> class & 1 == 0 {
                continue;
            }
            for &i in &self.lists[run] {
                let outline = &self.outlines[i as usize];
                let cos = outline.cos(&facing.normal);
                let cos = if sample_point.sided { cos } else { cos.abs() };
                // Both are told before either is asked: what cannot be foreseen is asked once.
                if (outline.distance_sq(&place) > wide) | (cos < facing.least_cos) {
                    continue;
                }
                let t = &self.triangles[i as usize];
                let Some(hit) = t.hit(sample_point) else { continue };
                let distance_sq = hit.distance_sq();
                let is_first = best.is_none_or(|(_, triangle)| t.triangle < triangle);
                if distance_sq < best_sq || best.is_some() && distance_sq == best_sq && is_first {
                    (best, best_sq, wide) = (Some((hit, t.triangle)), distance_sq, self.widened(distance_sq));
                }
            }
        }
        best.map(|(hit, _)| hit)
    }

    /// A square that no squared distance in single precision exceeds whose true one does not exceed another: (d + m)^2, and 2 d is at most
    /// 1 + d^2.
    #[inline]
    fn widened(&self, distance_sq: f64) -> f32 {
        let m = self.margin_m;
        (distance_sq + m * (1.0 + distance_sq + m)) as f32
    }
}

/// The cells of a row along x that come within reach of a triangle.
#[derive(Clone, Copy)]
struct Stretch {
    triangle: u32,
    first: u8,
    last: u8,
}

/// Which triangles come within reach of which cells.
struct Stretches {
    /// Those of row `z * TILE + y` are `all[starts[row]..starts[row + 1]]`, by rising triangle.
    starts: Vec<usize>,
    all: Vec<Stretch>,
}

impl Stretches {
    /// Leaves those of the triangles that come within reach of a cell and can be seen.
    fn of(
        site: &TileSite,
        triangles: &mut Vec<TileTriangle>,
        surface: &CitySurface,
        exposure: &FacetVisibility,
    ) -> Stretches {
        let mut found: Vec<(u16, Stretch)> = Vec::new();
        let mut kept = 0;
        triangles.retain(|t| {
            let before = found.len();
            site.each_row(t, &surface.corners(t.triangle), |row, first, last| {
                found.push((row as u16, Stretch { triangle: kept, first, last }));
            });
            let counts = found.len() > before && exposure.of(t.triangle, surface);
            if counts {
                kept += 1;
            } else {
                found.truncate(before);
            }
            counts
        });
        triangles.shrink_to_fit();
        let mut starts = vec![0; TILE * TILE + 1];
        found.iter().for_each(|(row, _)| starts[usize::from(*row) + 1] += 1);
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut all = vec![Stretch { triangle: 0, first: 0, last: 0 }; found.len()];
        let mut next = starts.clone();
        for (row, stretch) in found {
            let place = &mut next[usize::from(row)];
            all[*place] = stretch;
            *place += 1;
        }
        Stretches { starts, all }
    }

    /// Where the list of each cell begins, and the lists, each once for cells beside each other.
    fn lists(&self, classes: &[u32]) -> (Box<[u32; CELLS]>, Vec<u32>) {
        let mut cells = Box::new([0u32; CELLS]);
        let mut lists = vec![Run::head(0, 0)];
        for row in 0..TILE * TILE {
            let (y, z) = (row % TILE, row / TILE);
            let stretches = &self.all[self.starts[row]..self.starts[row + 1]];
            // Where a stretch begins or has ended.
            let turns = stretches.iter().fold(0u32, |turns, s| turns | 1 << s.first | 2 << s.last);
            for x in 0..TILE {
                let here = index_of([x, y, z]);
                if turns >> x & 1 == 0 {
                    cells[here] = if x > 0 { cells[index_of([x - 1, y, z])] } else { 0 };
                    continue;
                }
                let begin = lists.len();
                append_list(&mut lists, stretches, x as u8, classes);
                let before = [(y > 0).then(|| [x, y - 1, z]), (z > 0).then(|| [x, y, z - 1])].into_iter().flatten();
                let before = std::iter::once(0).chain(before.map(|cell| cells[index_of(cell)] as usize));
                let same = before
                    .into_iter()
                    .find(|&at| lists[begin..] == lists[at..][..(lists.len() - begin).min(begin - at)]);
                cells[here] = same.unwrap_or(begin) as u32;
                if same.is_some() {
                    lists.truncate(begin);
                }
            }
        }
        lists.shrink_to_fit();
        (cells, lists)
    }
}

fn index_of(cell: [usize; 3]) -> usize {
    usize::from(Cell::at(cell).0)
}

/// Appends the list of cell `x` of a row.
fn append_list(lists: &mut Vec<u32>, stretches: &[Stretch], x: u8, classes: &[u32]) {
    let (mut head, mut class) = (lists.len(), u32::MAX);
    for stretch in stretches.iter().filter(|s| s.first <= x && x <= s.last) {
        let own = classes[stretch.triangle as usize];
        if own != class {
            (head, class) = (lists.len(), own);
            lists.push(Run::head(class, 0));
        }
        lists[head] += 1;
        lists.push(stretch.triangle);
    }
    lists.push(Run::head(0, 0));
}

impl TileSite {
    /// Calls `visit` with every row of cells that hold a place within reach of the triangle (and a few more at its corners): the row, the
    /// first and the last of them.
    fn each_row(&self, t: &TileTriangle, [a, b, c]: &[Point3<f64>; 3], mut visit: impl FnMut(usize, u8, u8)) {
        let reach = Vector3::repeat(self.reach_m);
        let (first, last) = (a.inf(b).inf(c) - reach - self.low.coords, a.sup(b).sup(c) + reach - self.low.coords);
        let mut range = [(0usize, 0usize); 3];
        for k in 0..3 {
            let (first, last) = ((first[k] / self.cell_m).floor(), (last[k] / self.cell_m).floor());
            if last < 0.0 || first >= TILE as f64 {
                return;
            }
            range[k] = (first.max(0.0) as usize, (last as usize).min(TILE - 1));
        }
        // The middles of the cells that lie near are a stretch of each row: what bounds them rises or falls evenly along it.
        let near_m = (self.reach_m + self.cell_m * 0.5 * 3f64.sqrt()) * (1.0 + CELL_ROUNDING);
        let middle = self.low + Vector3::repeat(0.5 * self.cell_m);
        let [a, b, c] = t.edges;
        let bounds = [(t.normal, t.offset), (-t.normal, -t.offset), a, b, c];
        let bounds =
            bounds.map(|(out, offset)| Bound::new(near_m - out.dot(&middle.coords) - offset, out * self.cell_m));
        for z in range[2].0..=range[2].1 {
            for y in range[1].0..=range[1].1 {
                let (mut first, mut last) = (range[0].0 as f64, range[0].1 as f64);
                for bound in &bounds {
                    bound.cut(y as f64, z as f64, &mut first, &mut last);
                }
                let (first, last) = (first.ceil(), last.floor());
                if first <= last {
                    visit(z * TILE + y, first as u8, last as u8);
                }
            }
        }
    }
}

/// What must not exceed a reach at the middle of a cell: `x + y_per_x y + z_per_x z <= most` along its rows, or the other way round; where
/// it does not change along rows, `y_per_x y + z_per_x z <= most`.
struct Bound {
    side: Side,
    y_per_x: f64,
    z_per_x: f64,
    most: f64,
}

enum Side {
    Last,
    First,
    All,
}

impl Bound {
    /// `left_m` at the middle of the first cell, of which every step along the axes takes as much as `step_m` says.
    fn new(left_m: f64, step_m: Vector3<f64>) -> Bound {
        let (side, per) = match step_m.x.recip() {
            per if !per.is_finite() => (Side::All, 1.0),
            per if per > 0.0 => (Side::Last, per),
            per => (Side::First, per),
        };
        Bound { side, y_per_x: step_m.y * per, z_per_x: step_m.z * per, most: left_m * per }
    }

    /// Cuts the stretch of a row.
    #[inline]
    fn cut(&self, y: f64, z: f64, first: &mut f64, last: &mut f64) {
        let most = self.most - self.y_per_x * y - self.z_per_x * z;
        match self.side {
            Side::Last => *last = last.min(most + CELL_ROUNDING),
            Side::First => *first = first.max(most - CELL_ROUNDING),
            Side::All if most < -CELL_ROUNDING => *last = f64::NEG_INFINITY,
            Side::All => (),
        }
    }
}

#[cfg(test)]
mod tests;
