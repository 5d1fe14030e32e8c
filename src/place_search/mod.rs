//! Finds a reconstruction in a whole city when nothing is known of its scale, heading and position.
//!
//! Question     at which places of the city could this reconstruction stand?
//! Input        the patches of the cloud and their up; the prepared city; what is known beforehand ([`PlacePrior`])
//! Output       [`PlaceSearch`]: the places that may be right as starts, the best first; how many poses were looked at; or why none can be
//! Method       `search` is the page: walls in plan on both sides (`cloud_walls`, `city_walls`); a raster of the city's (`raster`, `blocks`);
//!              every pose that lays a strong wall of the cloud on a wall of the city is scored against chance (`scan`, `scales`, `weights`); the
//!              best are made sharp (`sharpen`), get a height (`heights`) and are asked for their lines of sight (`sight`; `judged`)
//! Assumptions  up is known; walls of two directions were seen; the city has the walls in their places to a few decimetres
//! Fails when   most of the walls that were seen are not in the model, or the place repeats elsewhere in the city: twins are all told
//! Source       derived here; nothing is drawn at random

mod blocks;
mod chance;
mod city_walls;
mod cloud_walls;
mod compared;
mod districts;
mod effort;
mod heights;
mod judged;
mod meeting;
mod outcome;
mod poses;
mod prior;
mod raster;
mod scales;
mod scan;
mod search;
mod sharpen;
mod sight;
mod wall_index;
mod views;
mod weights;

pub use city_walls::{CityWall, walls_of_planes};
pub use outcome::{PlaceCandidate, PlaceObstacle, PlaceSearch};
pub use prior::{Disc, HeadingPrior, PlacePrior};
pub use search::{PlaceTask, search_places, search_places_by_walls};
