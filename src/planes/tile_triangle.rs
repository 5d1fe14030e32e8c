//! A triangle of a tile, in double precision and as a cache line in single precision.

use super::city_planes::PlaneId;
use super::hit::{Hit, OrientedPoint};
use super::surface::CitySurface;
use crate::city::FacetId;
use crate::geometry::{Point3, Vector3};

/// Triangles smaller than this have no direction to speak of.
const SMALLEST_TRIANGLE_M2: f64 = 1e-6;

/// A triangle prepared for distance queries.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileTriangle {
    /// Of the facet's plane, outward.
    pub normal: Vector3<f64>,
    pub offset: f64,
    /// For each edge the in-plane unit normal that points out of the triangle, and its offset.
    pub edges: [(Vector3<f64>, f64); 3],
    pub plane: PlaneId,
    /// In the model.
    pub triangle: u32,
}

/// The same in single precision about the middle of the tile, as a cache line: its plane, then its edges.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Outline {
    pub x: [f32; 4],
    pub y: [f32; 4],
    pub z: [f32; 4],
    pub offset: [f32; 4],
}

impl TileTriangle {
    pub fn new(
        triangle: u32,
        corners: &[Point3<f64>; 3],
        surface: &CitySurface,
        facet: FacetId,
    ) -> Option<TileTriangle> {
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
    pub fn hit(&self, sample_point: &OrientedPoint) -> Option<Hit> {
        let cos = self.normal.dot(&sample_point.normal);
        if (if sample_point.sided { cos } else { cos.abs() }) < sample_point.min_cos {
            return None;
        }
        let across_m = self.normal.dot(&sample_point.position.coords) + self.offset;
        Some(Hit { plane: self.plane, normal: self.normal, across_m, outside_m: self.outside(&sample_point.position) })
    }

    /// How far a point's foot lies outside: exact beside an edge, a little too small beyond a sharp corner.
    #[inline]
    pub fn outside(&self, p: &Point3<f64>) -> f64 {
        let [a, b, c] = &self.edges;
        let (a, b, c) = (a.0.dot(&p.coords) + a.1, b.0.dot(&p.coords) + b.1, c.0.dot(&p.coords) + c.1);
        a.max(b).max(c).max(0.0)
    }
}

impl Outline {
    pub fn new(t: &TileTriangle, middle: &Point3<f64>, width_m: f64) -> Outline {
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
    pub fn distance_sq(&self, p: &Vector3<f32>) -> f32 {
        let off = |k: usize| self.x[k] * p.x + self.y[k] * p.y + self.z[k] * p.z + self.offset[k];
        // `f32::max` takes care of NaN, which there is none of here.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let (across, outside) = (off(0), larger(larger(off(1), off(2)), larger(off(3), 0.0)));
        across * across + outside * outside
    }

    #[inline]
    pub fn cos(&self, normal: &Vector3<f32>) -> f32 {
        self.x[0] * normal.x + self.y[0] * normal.y + self.z[0] * normal.z
    }
}
