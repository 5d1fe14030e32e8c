//! The plan of a city, ready to be searched by any number of reconstructions.
//!
//! What costs most in it is which facets can be seen from outside; with a disc it is asked for those alone that stand within.

use super::city_walls::{CityWall, city_walls};
use super::prior::Disc;
use super::raster::Raster;
use super::wall_index::WallIndex;
use crate::limits::Limits;
use crate::planes::PreparedCity;

/// Walls in plan, their raster and their index.
pub struct CityPlan<'c> {
    pub city: &'c PreparedCity,
    pub raster: Raster,
    pub index: WallIndex,
}

impl CityPlan<'_> {
    /// Of the whole city, or of what stands within a disc.
    pub fn new<'c>(city: &'c PreparedCity, within: Option<&Disc>, limits: &Limits) -> CityPlan<'c> {
        let walls = city_walls(city, within, limits);
        let raster = Raster::new(&walls, &limits.place_search);
        CityPlan { city, raster, index: WallIndex::new(walls, limits.place_search.gates_m[0]) }
    }

    pub fn walls(&self) -> &[CityWall] {
        &self.index.walls
    }
}
