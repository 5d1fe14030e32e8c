//! A city model made ready for alignments, once for all of them.
//!
//! Planes and the tree for lines of sight are made when they are first asked for; what can be seen, and which facet is
//! nearest, is found out tile by tile, where somebody asks. So a small reconstruction in a large city pays for its own streets only,
//! and the next one there for nothing.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rayon::prelude::*;

use super::city_planes::{CityPlanes, PlaneId, city_planes};
use super::exposure::Exposure;
use super::facet_grid::FacetGrid;
use crate::city::{CityModel, FacetId};
use crate::geometry::{Point3, RayCaster};
use crate::limits::{ExposureLimits, Limits};

/// A city model with all that alignments ask of it.
pub struct PreparedCity {
    pub model: CityModel,
    facet_of_triangle: Vec<FacetId>,
    planes: OnceLock<CityPlanes>,
    rays: OnceLock<RayCaster>,
    exposure: Exposure,
    /// One for each reach that was asked for.
    grids: Mutex<Vec<Arc<FacetGrid>>>,
}

/// Grids are made for reaches in this ratio: a grid that reaches farther than asked lists more facets in each cell.
const REACH_RATIO: f64 = 1.19;

impl PreparedCity {
    /// A city whose exposure is judged as [`Limits::default`] says.
    pub fn new(model: CityModel) -> PreparedCity {
        PreparedCity::with_limits(model, &Limits::default().exposure)
    }

    pub fn with_limits(model: CityModel, limits: &ExposureLimits) -> PreparedCity {
        // A model whose facets were taken away by hand may hold triangles of none.
        let of_facets: usize = model.facets.iter().map(|facet| facet.triangles.len()).sum();
        let model = if of_facets == model.triangles.len() { model } else { model.subset(|_| true) };
        let mut facet_of_triangle = vec![FacetId(0); model.triangles.len()];
        for (id, facet) in model.facets_with_ids() {
            facet_of_triangle[facet.triangles.start as usize..facet.triangles.end as usize].fill(id);
        }
        PreparedCity {
            exposure: Exposure::new(model.triangles.len(), limits),
            model,
            facet_of_triangle,
            planes: OnceLock::new(),
            rays: OnceLock::new(),
            grids: Mutex::new(Vec::new()),
        }
    }

    /// Facets of one object in one plane.
    pub fn planes(&self) -> &CityPlanes {
        self.planes.get_or_init(|| city_planes(&self.model))
    }

    /// All triangles as obstacles; the caster numbers them as the model does.
    pub fn rays(&self) -> &RayCaster {
        self.rays.get_or_init(|| RayCaster::new((0..self.model.triangles.len() as u32).map(|t| self.corners(t))))
    }

    pub fn corners(&self, triangle: u32) -> [Point3<f64>; 3] {
        self.model.triangles[triangle as usize].map(|v| self.model.vertices[v as usize])
    }

    pub fn facet_of(&self, triangle: u32) -> FacetId {
        self.facet_of_triangle[triangle as usize]
    }

    /// Whether somebody could have seen a triangle from the open.
    pub fn is_exposed(&self, triangle: u32) -> bool {
        self.exposure.of(triangle, self)
    }

    /// For each plane whether any of it within a box can be seen.
    pub fn planes_in_sight(&self, low: &Point3<f64>, high: &Point3<f64>) -> Vec<PlaneId> {
        let meets = |a: &Point3<f64>, b: &Point3<f64>| (0..3).all(|k| a[k] <= high[k] && b[k] >= low[k]);
        let triangle_in_sight = |t: u32| {
            let [a, b, c] = self.corners(t);
            meets(&a.inf(&b).inf(&c), &a.sup(&b).sup(&c)) && self.is_exposed(t)
        };
        let facet_in_sight = |f: &FacetId| self.model.facets[f.0 as usize].triangles.clone().any(triangle_in_sight);
        let planes = &self.planes().planes;
        let in_sight = |i: &u32| {
            let plane = &planes[*i as usize];
            meets(&plane.low, &plane.high) && plane.facets.iter().any(facet_in_sight)
        };
        (0..planes.len() as u32).into_par_iter().filter(in_sight).map(PlaneId).collect()
    }

    /// The grid of facets that answers within `reach_m`.
    pub fn grid(&self, reach_m: f64) -> Arc<FacetGrid> {
        // A step of a geometric series, so that parts whose noise differs a little share a grid.
        let step = (reach_m.ln() / REACH_RATIO.ln()).ceil();
        let reach_m = REACH_RATIO.powf(step);
        let mut grids = self.grids.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(grid) = grids.iter().find(|grid| grid.reach_m() == reach_m) {
            return Arc::clone(grid);
        }
        let grid = Arc::new(FacetGrid::new(&self.model, reach_m));
        grids.push(Arc::clone(&grid));
        grid
    }
}
