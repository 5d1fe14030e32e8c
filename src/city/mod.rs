//! The city model: polygons with their objects, in metres, z up, about a local origin.

use std::ops::Range;

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
}

/// One polygon of the model, or one triangle where the file has only triangles.
#[derive(Clone, Debug)]
pub struct Facet {
    /// Outline as vertex indices, counter-clockwise seen from outside; holes are bridged or triangulated away.
    pub outline: Vec<u32>,
    /// Newell plane through the outline's centroid; the normal is the outward side by winding.
    pub plane: Plane,
    /// Square metres, of the triangulation.
    pub area: f64,
    pub object: ObjectId,
    /// Range in [`CityModel::triangles`].
    pub triangles: Range<u32>,
}
