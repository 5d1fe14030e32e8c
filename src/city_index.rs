//! Writes the index of a city: its blocks, what can be seen of each, and the walls that this makes.
//!
//! Question     what of a city can be found out once, for all reconstructions that are sought in it?
//! Method       the model in blocks (`city::IndexDraft`); then, a few blocks at a time together with what stands within sight of them, which
//!              triangles are exposed, and the walls in plan that they are. Lines of sight end after 40 m, so that the answer is that of the whole
//!              city, and memory that of a square kilometre
//! Assumptions  limits are the usual ones: another program's index has another version

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::city::{CityError, CityOptions, IndexDraft, ObjectId, PlanBox, Surroundings};
use crate::format::city_index::{BlockSight, WallRecord};
use crate::limits::Limits;
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::place_search::{CityWall, walls_of_planes};
use crate::planes::PreparedCity;

/// Blocks along the side of a square that is looked at together. Chosen: a square kilometre, some 3,000 houses.
const BLOCKS_TOGETHER: f64 = 4.0;

/// Beyond what a line of sight reaches, metres.
const SLACK_M: f64 = 1.0;

/// Why an index was not written.
#[derive(Debug, thiserror::Error)]
pub enum CityIndexError {
    #[error(transparent)]
    City(#[from] CityError),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Reads a city and writes its index to a file.
pub fn write_city_index(
    city: &[PathBuf],
    terrain: &[PathBuf],
    options: &CityOptions,
    path: &Path,
    observer: &dyn Observer,
) -> Result<(), CityIndexError> {
    observer.progress(Stage::City, 0, 0);
    let mut draft = IndexDraft::of_city(city, terrain, options, path)?;
    let boxes = draft.boxes();
    let limits = Limits::default();
    let sight = &limits.facet_visibility;
    let reach_m = sight.open_m + sight.start_m + sight.joint_m + SLACK_M;
    let mut done = 0;
    for blocks in together(&boxes, BLOCKS_TOGETHER * draft.block_m()) {
        check_cancelled(observer)?;
        observer.progress(Stage::Index, done, boxes.len());
        let surroundings = draft.around(&blocks, reach_m)?;
        for (block, sight) in sights(surroundings, &blocks, draft.block_m(), &limits) {
            draft.add_sight(block, &sight)?;
        }
        done += blocks.len();
    }
    Ok(draft.finish()?)
}

/// Blocks by the squares that their middles lie in.
fn together(boxes: &[PlanBox], side_m: f64) -> Vec<Vec<usize>> {
    let mut squares: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (block, own) in boxes.iter().enumerate() {
        let square = [0, 1].map(|k| ((own.low[k] + own.high[k]) / 2.0 / side_m).floor() as i64);
        squares.entry(square).or_default().push(block);
    }
    squares.into_values().collect()
}

/// What can be seen of each block.
fn sights(surroundings: Surroundings, asked: &[usize], block_m: f64, limits: &Limits) -> Vec<(usize, BlockSight)> {
    let Surroundings { city: assembled, blocks } = surroundings;
    let owners = Owners::new(&assembled.object_of, assembled.model.objects.len());
    let city = PreparedCity::with_limits(assembled.model, &limits.facet_visibility);
    let is_asked = |at: usize| asked.contains(&blocks[at]);
    let mut sights: BTreeMap<usize, BlockSight> = BTreeMap::new();
    for (at, facets) in assembled.facet_of.iter().enumerate().filter(|(at, _)| is_asked(*at)) {
        let triangles = facets.iter().flat_map(|&facet| city.model.facets[facet as usize].triangles.clone());
        let triangles: Vec<u32> = triangles.collect();
        let exposed = triangles.par_iter().map(|&triangle| city.is_exposed(triangle)).collect();
        sights.insert(at, BlockSight { exposed, walls: Vec::new() });
    }
    let is_of_asked = |object: ObjectId| owners.blocks_of(object).iter().any(|&at| is_asked(at as usize));
    let planes = &city.planes().planes;
    for (id, walls) in walls_of_planes(&city, |plane| is_of_asked(plane.object), limits) {
        let blocks = owners.blocks_of(planes[id.0 as usize].object);
        for wall in walls {
            // A wall of an object that several blocks share goes where its middle is.
            let near = |at: &u32| {
                let facets = &assembled.facet_of[*at as usize];
                let first = facets.first().map(|&facet| &city.model.facets[facet as usize]);
                let corner = first.and_then(|facet| facet.outline.first()).map(|&v| city.model.vertices[v as usize]);
                corner.is_some_and(|corner| cell([corner.x, corner.y], block_m) == cell(middle(&wall), block_m))
            };
            let own = if let [only] = blocks { Some(only) } else { blocks.iter().find(|at| near(at)) };
            if let Some(sight) = own.and_then(|at| sights.get_mut(&(*at as usize))) {
                sight.walls.push(record(&wall));
            }
        }
    }
    sights.into_iter().map(|(at, sight)| (blocks[at], sight)).collect()
}

/// The blocks that each object is in.
struct Owners(Vec<Vec<u32>>);

impl Owners {
    fn new(object_of: &[Vec<u32>], objects: usize) -> Owners {
        let mut owners = vec![Vec::new(); objects];
        for (at, of_block) in (0..).zip(object_of) {
            of_block.iter().for_each(|&object| owners[object as usize].push(at));
        }
        Owners(owners)
    }

    fn blocks_of(&self, object: ObjectId) -> &[u32] {
        &self.0[object.0 as usize]
    }
}

fn cell(place: [f64; 2], block_m: f64) -> [i64; 2] {
    place.map(|value| (value / block_m).floor() as i64)
}

fn middle(wall: &CityWall) -> [f64; 2] {
    [0, 1].map(|k| (wall.from[k] + wall.to[k]) / 2.0)
}

fn record(wall: &CityWall) -> WallRecord {
    let CityWall { from, to, normal, foot_m, top_m } = *wall;
    WallRecord {
        from: from.map(Into::into),
        to: to.map(Into::into),
        normal: normal.map(Into::into),
        foot_m: foot_m.into(),
        top_m: top_m.into(),
    }
}

#[cfg(test)]
mod tests;
