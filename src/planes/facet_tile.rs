//! One tile of a grid of facets: the triangles that come within reach of its cells.
//!
//! Question     which triangle of a cell lies nearest to a point and faces its way?
//! Method       Triangles that face another way are passed over class by class; of the others, one cache line each tells in single precision
//!              how far the point is, to within a margin that is known; what may be the nearest is looked at in double precision, so
//!              that the answer is that of double precision throughout.
//!              Neighbouring cells mostly have the same triangles, and share their list.

use super::city_planes::PlaneId;
use super::directions::{Directions, Facing};
use super::facet_visibility::FacetVisibility;
use super::hit::{Hit, OrientedPoint};
use super::surface::CitySurface;
use crate::city::FacetId;
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

/// A triangle prepared for distance queries.
#[derive(Clone, Copy, Debug)]
struct TileTriangle {
    /// Of the facet's plane, outward.
    normal: Vector3<f64>,
    offset: f64,
    /// For each edge the in-plane unit normal that points out of the triangle, and its offset.
    edges: [(Vector3<f64>, f64); 3],
    plane: PlaneId,
    /// In the model.
    triangle: u32,
}

/// The same in single precision about the middle of the tile, as a cache line: its plane, then its edges.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Outline {
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
    offset: [f32; 4],
}

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

/// Triangles smaller than this have no direction to speak of.
const SMALLEST_TRIANGLE_M2: f64 = 1e-6;
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

impl TileTriangle {
    fn new(triangle: u32, corners: &[Point3<f64>; 3], surface: &CitySurface, facet: FacetId) -> Option<TileTriangle> {
        let [a, b, c] = corners;
        let across = (b - a).cross(&(c - a));
        if across.norm() < 2.0 * SMALLEST_TRIANGLE_M2 {
            return None;
        }
        let plane = &surface.model.facets[facet.0 as usize].plane;
        // The triangulation may wind against the facet; edges point out of the triangle all the same.
        let winding = if across.dot(&plane.normal) < 0.0 { -1.0 } else { 1.0 };
        let edge = |from: &Point3<f64>, to: &Point3<f64>| {
            let out = (to - from).cross(&plane.normal).normalize() * winding;
            (out, -out.dot(&from.coords))
        };
        Some(TileTriangle {
            normal: plane.normal,
            offset: plane.offset,
            edges: [edge(a, b), edge(b, c), edge(c, a)],
            plane: surface.planes().of_facet(facet),
            triangle,
        })
    }

    /// Where a sample point meets the triangle; `None` where it faces another way.
    #[inline]
    fn hit(&self, sample_point: &OrientedPoint) -> Option<Hit> {
        let cos = self.normal.dot(&sample_point.normal);
        if (if sample_point.sided { cos } else { cos.abs() }) < sample_point.min_cos {
            return None;
        }
        let across_m = self.normal.dot(&sample_point.position.coords) + self.offset;
        Some(Hit { plane: self.plane, normal: self.normal, across_m, outside_m: self.outside(&sample_point.position) })
    }

    /// How far a point's foot lies outside: exact beside an edge, a little too small beyond a sharp corner.
    #[inline]
    fn outside(&self, p: &Point3<f64>) -> f64 {
        let [a, b, c] = &self.edges;
        let (a, b, c) = (a.0.dot(&p.coords) + a.1, b.0.dot(&p.coords) + b.1, c.0.dot(&p.coords) + c.1);
        a.max(b).max(c).max(0.0)
    }
}

impl Outline {
    fn new(t: &TileTriangle, middle: &Point3<f64>, width_m: f64) -> Outline {
        let [a, b, c] = t.edges;
        let rows = [(t.normal, t.offset), a, b, c];
        let offset = |k: usize| {
            let offset = rows[k].0.dot(&middle.coords) + rows[k].1;
            // An edge beyond the tile bounds nothing in it, wherever it is.
            (if k > 0 { offset.max(-2.0 * width_m) } else { offset }) as f32
        };
        Outline {
            x: rows.map(|(out, _)| out.x as f32),
            y: rows.map(|(out, _)| out.y as f32),
            z: rows.map(|(out, _)| out.z as f32),
            offset: std::array::from_fn(offset),
        }
    }

    /// Squared distance of a place, metres.
    #[inline]
    fn distance_sq(&self, p: &Vector3<f32>) -> f32 {
        let off = |k: usize| self.x[k] * p.x + self.y[k] * p.y + self.z[k] * p.z + self.offset[k];
        // `f32::max` takes care of NaN, which there is none of here.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let (across, outside) = (off(0), larger(larger(off(1), off(2)), larger(off(3), 0.0)));
        across * across + outside * outside
    }

    #[inline]
    fn cos(&self, normal: &Vector3<f32>) -> f32 {
        self.x[0] * normal.x + self.y[0] * normal.y + self.z[0] * normal.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planes::PreparedCity;
    use crate::robust::Random;
    use crate::synthetic::Block;

    /// The same by looking at every triangle of the city whose box comes as near as the gate or, where `is_beyond`, does not.
    fn slowly(city: &PreparedCity, sample_point: &OrientedPoint, gate_m: f64, is_beyond: bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for t in (0..city.model.triangles.len() as u32).filter(|t| city.is_exposed(*t)) {
            let corners = city.corners(t);
            let [a, b, c] = &corners;
            let (low, high, p) = (a.inf(b).inf(c), a.sup(b).sup(c), &sample_point.position);
            if (0..3).all(|k| p[k] > low[k] - gate_m && p[k] < high[k] + gate_m) == is_beyond {
                continue;
            }
            let triangle = TileTriangle::new(t, &corners, city, city.facet_of(t)).unwrap();
            let Some(hit) = triangle.hit(sample_point) else { continue };
            if hit.distance_sq() < best.as_ref().map_or(gate_m * gate_m, Hit::distance_sq) {
                best = Some(hit);
            }
        }
        best
    }

    #[test]
    fn agrees_to_the_bit_with_looking_at_every_triangle() {
        let city = PreparedCity::new(Block::town(2, 2, 5).with_ground(true).city().unwrap());
        let (low, high) = city.model.bounds().unwrap();
        let mut random = Random::stream(5, 0);
        let normals: Vec<Vector3<f64>> = city.model.facets.iter().map(|facet| facet.plane.normal).collect();
        let (mut found, mut beyond) = (0, 0);
        for reach_m in [0.3, 1.5, 6.0] {
            let grid = city.grid(reach_m);
            for _ in 0..3000 {
                let position = low + (high - low).map(|extent| extent * (1.4 * random.unit() - 0.2));
                let off = Vector3::from_fn(|_, _| random.unit() - 0.5);
                let normal = (normals[random.below(normals.len())] + 0.6 * off).normalize();
                let (sided, min_cos) = (random.unit() < 0.5, [0.95, 0.9063, 0.12][random.below(3)]);
                let sample_point = OrientedPoint { position, normal, sided, min_cos };
                let gate_m = reach_m * random.unit();
                let told = |hit: &Option<Hit>| {
                    hit.map(|h| (h.distance_sq().to_bits(), h.plane, h.across_m.to_bits(), h.outside_m.to_bits()))
                };
                let fast = city.nearest(&grid, &sample_point, gate_m);
                // Beyond a sharp corner a triangle seems nearer than it is.
                let is_seeming = told(&fast) != told(&slowly(&city, &sample_point, gate_m, false));
                if is_seeming {
                    assert_eq!(
                        told(&fast),
                        told(&slowly(&city, &sample_point, gate_m, true)),
                        "{sample_point:?} {gate_m}"
                    );
                }
                beyond += usize::from(is_seeming);
                found += usize::from(fast.is_some());
            }
        }
        assert!(found > 200 && beyond < found / 15, "{found} {beyond}");
    }
}
