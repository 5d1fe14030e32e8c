//! The facets near any place of the city, with their extents and outward sides, in time independent of the city's size.
//!
//! Question     which facet does a point with this normal lie on, and how far off is it?
//! Method       a grid whose cells list the triangles that come within a reach of them and that somebody could have seen; a triangle
//!              counts only where the point's normal agrees with its outward one. Cells are filled tile by tile when a point first falls into
//!              one ([`Tile`])
//! Why a grid   the search asks some ten million times for the nearest facet *of the same side and direction*; a tree of boxes
//!              knows no normals and would walk through all of a street to find that nothing matches

use std::sync::OnceLock;

use super::directions::{Directions, Facing};
use super::facet_tile::{Cell, List, TILE, Tile, TileSite};
use super::facet_visibility::FacetVisibility;
use super::hit::{Hit, OrientedPoint};
use super::surface::CitySurface;
use crate::city::CityModel;
use crate::geometry::{Point3, Vector3};

/// A grid over a whole city.
pub struct FacetGrid {
    reach_m: f64,
    low: Point3<f64>,
    cell_m: f64,
    cells_per_m: f64,
    /// Tiles along each axis.
    tiles: [usize; 3],
    /// For each tile the triangles that come within reach of it: those of tile `i` are `near[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    near: Vec<u32>,
    filled: Vec<OnceLock<Tile>>,
    directions: Directions,
}

/// Cells as wide as this share of the reach: half as wide lists are half as long, and filling them takes four times as long.
const CELL_OF_REACH: f64 = 0.5;
/// A grid has no more tiles than so many for each triangle of the city, and lists no triangle in more tiles than that on average: its memory
/// goes by the model and not by its extent. Chosen: a triangle of a house lies in two to six.
const TILES_OF_TRIANGLE: f64 = 16.0;
/// Normals of patches agree with those of their facets within less than this.
const SAME_DIRECTION_RAD: f64 = 0.45;
/// Of small cities it has as many as of one of so many triangles.
const LEAST_TRIANGLES: usize = 4096;

/// How many places triangles would take in the lists of tiles.
fn listed(city: &CityModel, reach_m: f64, tile_m: f64) -> f64 {
    let tiles = |triangle: &[u32; 3]| -> f64 {
        let [a, b, c] = triangle.map(|v| city.vertices[v as usize]);
        let extent = a.sup(&b).sup(&c) - a.inf(&b).inf(&c);
        extent.iter().map(|e| (e + 2.0 * reach_m) / tile_m + 1.0).product()
    };
    city.triangles.iter().map(tiles).sum()
}

/// A cell of a grid, to be looked into in steps: who looks into many takes each step for all of them, so that memory answers several at
/// once.
#[derive(Clone, Copy)]
pub struct Look<'g> {
    reach_m: f64,
    tile: &'g Tile,
    cell: Cell,
    list: List,
}

impl Look<'_> {
    /// The first step: which facets are listed.
    #[inline]
    pub fn find_list(&mut self) {
        self.list = self.tile.list(self.cell);
    }

    /// The second: begins to fetch the list.
    #[inline]
    pub fn fetch_list(&self) {
        self.tile.fetch_list(self.list);
    }

    /// Whether none is listed.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The third: begins to fetch the first triangles of the list.
    #[inline]
    pub fn fetch_triangles(&self) {
        self.tile.fetch_triangles(self.list);
    }

    /// The last: the nearest triangle within `gate_m` whose outward normal agrees with the sample point's, of which `facing` is told by the grid; of
    /// equals the first of the model. A gate wider than the grid's reach is cut to it.
    #[inline]
    pub fn nearest(&self, sample_point: &OrientedPoint, facing: &Facing, gate_m: f64) -> Option<Hit> {
        self.tile.nearest(self.list, sample_point, facing, gate_m.min(self.reach_m))
    }
}

impl FacetGrid {
    pub(super) fn new(city: &CityModel, reach_m: f64) -> FacetGrid {
        let (low, high) = city.own_bounds().unwrap_or((Point3::origin(), Point3::origin()));
        let (low, high) = (low - Vector3::repeat(reach_m), high + Vector3::repeat(reach_m));
        let extent = high - low;
        let mut tile_m = CELL_OF_REACH * reach_m * TILE as f64;
        let tiles_of = |tile_m: f64| [0, 1, 2].map(|k| (extent[k] / tile_m).ceil().max(1.0));
        // Wider tiles until both they and the places that triangles take in them are few enough for the city.
        let most = TILES_OF_TRIANGLE * city.triangles.len().max(LEAST_TRIANGLES) as f64;
        while tiles_of(tile_m).iter().product::<f64>() > most || listed(city, reach_m, tile_m) > most {
            tile_m *= 2.0;
        }
        let tiles = tiles_of(tile_m).map(|count| count as usize);
        let mut grid = FacetGrid {
            reach_m,
            low,
            cell_m: tile_m / TILE as f64,
            cells_per_m: TILE as f64 / tile_m,
            tiles,
            starts: Vec::new(),
            near: Vec::new(),
            filled: (0..tiles.iter().product()).map(|_| OnceLock::new()).collect(),
            directions: Directions::within(SAME_DIRECTION_RAD),
        };
        grid.sort_into_tiles(city, tile_m);
        grid
    }

    pub fn reach_m(&self) -> f64 {
        self.reach_m
    }

    fn sort_into_tiles(&mut self, city: &CityModel, tile_m: f64) {
        let ranges = |triangle: &[u32; 3]| -> [(usize, usize); 3] {
            let [a, b, c] = triangle.map(|v| city.vertices[v as usize]);
            let reach = Vector3::repeat(self.reach_m);
            let (low, high) = (a.inf(&b).inf(&c) - reach - self.low, a.sup(&b).sup(&c) + reach - self.low);
            [0, 1, 2].map(|k| ((low[k] / tile_m) as usize, ((high[k] / tile_m) as usize).min(self.tiles[k] - 1)))
        };
        let each_tile = |triangle: &[u32; 3], visit: &mut dyn FnMut(usize)| {
            let [x, y, z] = ranges(triangle);
            for z in z.0..=z.1 {
                for y in y.0..=y.1 {
                    (x.0..=x.1).for_each(|x| visit((z * self.tiles[1] + y) * self.tiles[0] + x));
                }
            }
        };
        let mut starts = vec![0u32; self.filled.len() + 1];
        city.triangles.iter().for_each(|t| each_tile(t, &mut |tile| starts[tile + 1] += 1));
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut near = vec![0u32; starts[starts.len() - 1] as usize];
        let mut next = starts.clone();
        for (i, triangle) in city.triangles.iter().enumerate() {
            each_tile(triangle, &mut |tile| {
                near[next[tile] as usize] = i as u32;
                next[tile] += 1;
            });
        }
        (self.starts, self.near) = (starts, near);
    }

    /// Where to look near a place.
    #[inline]
    pub(super) fn look(
        &self,
        place: &Point3<f64>,
        surface: &CitySurface,
        exposure: &FacetVisibility,
    ) -> Option<Look<'_>> {
        let d = (place - self.low) * self.cells_per_m;
        if !(d.x >= 0.0 && d.y >= 0.0 && d.z >= 0.0) {
            return None;
        }
        let (x, y, z) = (d.x as usize, d.y as usize, d.z as usize);
        let (tx, ty, tz) = (x / TILE, y / TILE, z / TILE);
        if tx >= self.tiles[0] || ty >= self.tiles[1] || tz >= self.tiles[2] {
            return None;
        }
        let at = (tz * self.tiles[1] + ty) * self.tiles[0] + tx;
        let tile = self.filled[at].get_or_init(|| self.fill(at, surface, exposure));
        let cell = Cell::at([x % TILE, y % TILE, z % TILE]);
        Some(Look { reach_m: self.reach_m, tile, cell, list: List::default() })
    }

    /// Which facets a point may lie on by their direction.
    #[inline]
    pub fn facing(&self, point: &OrientedPoint) -> Facing {
        self.directions.facing(point)
    }

    fn fill(&self, at: usize, surface: &CitySurface, exposure: &FacetVisibility) -> Tile {
        let [x, y, z] = [at % self.tiles[0], at / self.tiles[0] % self.tiles[1], at / self.tiles[0] / self.tiles[1]];
        let low = self.low + Vector3::new(x as f64, y as f64, z as f64) * (self.cell_m * TILE as f64);
        let near = &self.near[self.starts[at] as usize..self.starts[at + 1] as usize];
        Tile::new(&TileSite { low, cell_m: self.cell_m, reach_m: self.reach_m }, near, surface, exposure)
    }
}

#[cfg(test)]
mod tests;
