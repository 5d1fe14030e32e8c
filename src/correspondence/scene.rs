//! Everything that a search works on: the cloud as votes, the city, and what is known of the pose beforehand.

use std::sync::Arc;

use super::prior::{Prior, Reach};
use super::votes::Votes;
use crate::geometry::{Similarity, Start};
use crate::limits::Limits;
use crate::planes::{FacetGrid, Hit, Patches, PreparedCity, Probe, Upright};
use crate::robust::Motion;

/// A cloud in a city.
pub struct Scene<'a> {
    pub city: &'a PreparedCity,
    pub limits: &'a Limits,
    pub votes: Votes,
    pub prior: Prior,
    /// The part of the city that the cloud can come to lie in. What lies beyond is met by stray points alone, of which a handful would count
    /// as much as a facade: a plane's own error bounds what its points say.
    pub reach: Reach,
    /// Of the city, for the gates of refinement and for those of the search: the shorter a grid reaches, the fewer facets it looks at.
    narrow_grid: Arc<FacetGrid>,
    wide_grid: Arc<FacetGrid>,
    /// What "near" means to all gates, metres of the start.
    pub unit_m: f64,
}

impl<'a> Scene<'a> {
    /// `start` maps to the city's local frame; with a rigid motion its scale is the given one.
    pub fn new(
        city: &'a PreparedCity,
        patches: &Patches,
        start: &Start,
        motion: Motion,
        upright: &Upright,
        limits: &'a Limits,
    ) -> Scene<'a> {
        let votes = Votes::new(patches, start.city_from_sfm(), upright, limits);
        let prior = Prior::new(start, votes.center_in_city, motion, upright.known, city.model.bounds(), limits);
        let unit_m = limits.model_unit_m + limits.noise_sigmas * votes.noise_m;
        // A pose may be as much larger than the start as the scale allows, and its gates with it.
        let grid = |gate_units: f64| city.grid(gate_units * unit_m * prior.most_scale());
        let (narrow_grid, wide_grid) = (grid(limits.walk.basin_gates_units[0]), grid(limits.search.gate_units));
        let reach = prior.reach(&votes.extent());
        Scene { city, limits, votes, prior, reach, narrow_grid, wide_grid, unit_m }
    }

    /// The facet that a point lies on.
    #[inline]
    pub fn nearest(&self, probe: &Probe, gate_m: f64) -> Option<Hit> {
        if !self.reach.contains(&probe.position) {
            return None;
        }
        let grid = if gate_m <= self.narrow_grid.reach_m() { &self.narrow_grid } else { &self.wide_grid };
        grid.nearest(probe, gate_m, self.city)
    }

    /// To the city's local frame.
    pub fn city_from_sfm(&self, city_from_level: &Similarity) -> Similarity {
        *city_from_level * self.votes.level_from_sfm
    }
}
