//! The surface of a city model: which facet and plane a triangle belongs to, and the triangles as obstacles.

use std::sync::OnceLock;

use super::city_planes::{CityPlanes, city_planes};
use crate::city::{CityModel, FacetId};
use crate::geometry::{Point3, RayCaster, Vector3};

/// A city model, with what is made of it when first asked for.
pub struct CitySurface {
    pub model: CityModel,
    facet_of_triangle: Vec<FacetId>,
    planes: OnceLock<CityPlanes>,
    rays: OnceLock<RayCaster>,
}

impl CitySurface {
    pub(super) fn new(model: CityModel) -> CitySurface {
        // A model whose facets were taken away by hand may hold triangles of none.
        let of_facets: usize = model.facets.iter().map(|facet| facet.triangles.len()).sum();
        let model = if of_facets == model.triangles.len() { model } else { model.subset(|_| true) };
        let mut facet_of_triangle = vec![FacetId(0); model.triangles.len()];
        for (id, facet) in model.facets_with_ids() {
            facet_of_triangle[facet.triangles.start as usize..facet.triangles.end as usize].fill(id);
        }
        CitySurface { model, facet_of_triangle, planes: OnceLock::new(), rays: OnceLock::new() }
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

    /// Of the facet, outward.
    pub fn normal_of(&self, triangle: u32) -> Vector3<f64> {
        self.model.facets[self.facet_of(triangle).0 as usize].plane.normal
    }
}
