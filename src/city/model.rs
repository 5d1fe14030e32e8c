//! A city model in memory.

use std::ops::Range;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::warning::CityWarning;
use super::{CityContents, Crs};
use crate::format::surfaces::SurfaceKind;
use crate::geometry::{Plane, Point3, Vector3};

/// Index into [`CityModel::facets`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FacetId(pub u32);

/// Index into [`CityModel::objects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// A polyhedral city model. File coordinates are `local + origin`.
#[derive(Clone, Debug, Default)]
pub struct CityModel {
    /// Shift that was taken off every vertex, city frame, metres.
    pub origin: Vector3<f64>,
    /// Local coordinates, metres, z up.
    pub vertices: Vec<Point3<f64>>,
    pub facets: Vec<Facet>,
    /// Vertex indices of all triangles; a facet's own are `Facet::triangles`.
    pub triangles: Vec<[u32; 3]>,
    /// Names of buildings (groups, objects, nodes).
    pub objects: Vec<String>,
    /// One per file, in the order in which they were given: the city, then terrain.
    pub sources: Vec<CitySource>,
    /// The reference system of file coordinates, where one is known.
    pub crs: Option<Crs>,
    /// What the files had wrong and was tolerated, one entry a kind.
    pub warnings: Vec<CityWarning>,
    /// Of each triangle whether somebody could have seen it, where an index of the city knows; else empty.
    pub exposed: Vec<bool>,
    /// What the whole city has, where this is a part that was read out of an index.
    pub part_of: Option<WholeCity>,
}

/// What the whole has of which a model is a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WholeCity {
    pub size: CitySize,
    /// The smallest box around all vertices, local coordinates.
    pub low: Point3<f64>,
    pub high: Point3<f64>,
}

/// How much a model has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct CitySize {
    pub objects: usize,
    pub facets: usize,
    pub triangles: usize,
}

impl CitySize {
    pub fn of(model: &CityModel) -> CitySize {
        CitySize { objects: model.objects.len(), facets: model.facets.len(), triangles: model.triangles.len() }
    }
}

/// One polygon of the model, or one triangle where the file has only triangles.
#[derive(Clone, Debug)]
pub struct Facet {
    /// Outline as vertex indices, counter-clockwise seen from outside.
    pub outline: Vec<u32>,
    /// Holes in it, clockwise seen from outside.
    pub holes: Vec<Vec<u32>>,
    /// Newell plane through the outline's centroid; the normal is the outward side by winding.
    pub plane: Plane,
    /// Square metres, of the triangulation.
    pub area: f64,
    pub object: ObjectId,
    /// What it is of its object, where the file says.
    pub kind: Option<SurfaceKind>,
    /// Range in [`CityModel::triangles`].
    pub triangles: Range<u32>,
}

/// What one file gave to the model.
#[derive(Clone, Debug, PartialEq)]
pub struct CitySource {
    pub path: PathBuf,
    pub role: CityRole,
    /// Indices into [`CityModel::facets`].
    pub facets: Range<u32>,
    /// Indices into [`CityModel::objects`].
    pub objects: Range<u32>,
    /// How finely the file's coordinates are written, metres.
    pub precision_m: f64,
    /// What the file holds, before levels of detail were chosen.
    pub contents: CityContents,
}

/// What a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub enum CityRole {
    City,
    /// A surface that is open by its nature.
    Terrain,
}

impl Facet {
    /// The outline, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &[u32]> {
        std::iter::once(&self.outline).chain(&self.holes).map(Vec::as_slice)
    }
}

impl CityModel {
    /// The smallest box around all vertices, local coordinates; `None` without any. Of a part, that of the whole: what may be sought where
    /// is the same for both.
    pub fn bounds(&self) -> Option<(Point3<f64>, Point3<f64>)> {
        if let Some(whole) = &self.part_of {
            return Some((whole.low, whole.high));
        }
        self.own_bounds()
    }

    /// The same of what is there.
    pub fn own_bounds(&self) -> Option<(Point3<f64>, Point3<f64>)> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold((first, first), |(low, high), vertex| (low.inf(vertex), high.sup(vertex))))
    }

    /// How much the whole city has, of which this may be a part.
    pub fn whole_size(&self) -> CitySize {
        self.part_of.map_or_else(|| CitySize::of(self), |whole| whole.size)
    }

    /// Puts what concerns the city as a whole before what its files had wrong.
    pub(super) fn with_warnings_first(mut self, warnings: Vec<CityWarning>) -> CityModel {
        self.warnings.splice(0..0, warnings);
        self
    }

    /// The name of an object, or an empty text for an id of another model.
    pub fn object_name(&self, object: ObjectId) -> &str {
        self.objects.get(object.0 as usize).map_or("", String::as_str)
    }

    /// All facets with their ids, in order.
    pub fn facets_with_ids(&self) -> impl Iterator<Item = (FacetId, &Facet)> {
        (0..).map(FacetId).zip(&self.facets)
    }

    /// The corners of a facet's triangles.
    pub fn triangles_of<'a>(&'a self, facet: &Facet) -> impl Iterator<Item = [Point3<f64>; 3]> + 'a {
        let range = facet.triangles.start as usize..facet.triangles.end as usize;
        self.triangles[range].iter().map(|corners| corners.map(|corner| self.vertices[corner as usize]))
    }
}
