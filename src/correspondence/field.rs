//! The facets near any place of the scene, with their extents and outward sides, in time independent of the city's size.
//!
//! Question     which facet does a point with this normal lie on, and how far off is it?
//! Method       a grid whose cells list the triangles that come within `reach_m` of them; a triangle counts only where the
//!              point's normal agrees with its outward one
//! Why a grid   the search asks some ten million times for the nearest facet *of the same side and direction*; a tree of boxes
//!              knows no normals and would walk through all of a street to find that nothing matches

use crate::city::{CityModel, FacetId};
use crate::geometry::{Point3, Vector3};

/// Where a point meets the city.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index into [`FacetField::triangles`].
    pub triangle: u32,
    /// Signed distance from the facet's plane, metres.
    pub across_m: f64,
    /// How far the foot of the perpendicular lies outside the triangle, metres; 0 inside.
    pub outside_m: f64,
}

impl Hit {
    pub fn distance_sq(&self) -> f64 {
        self.across_m * self.across_m + self.outside_m * self.outside_m
    }
}

/// A triangle prepared for distance queries.
#[derive(Clone, Copy, Debug)]
pub struct FieldTriangle {
    /// Of the facet's plane, outward.
    pub normal: Vector3<f64>,
    pub offset: f64,
    /// For each edge the in-plane unit normal that points out of the triangle, and its offset.
    edges: [(Vector3<f64>, f64); 3],
    pub facet: FacetId,
}

/// Triangles of the city near the scene, and for each grid cell those within reach.
pub struct FacetField {
    pub triangles: Vec<FieldTriangle>,
    low: Point3<f64>,
    cells: [usize; 3],
    cell_m: f64,
    starts: Vec<u32>,
    entries: Vec<u32>,
}

/// A point as the field sees it.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    pub position: Point3<f64>,
    /// Of the patch; for a loose point the direction to the cameras that saw it.
    pub normal: Vector3<f64>,
    /// False where it is not known from which side the point was seen: both signs of the normal count.
    pub sided: bool,
    /// Cosine of the largest angle between `normal` and the outward normal of a facet that the point may lie on.
    pub min_cos: f64,
}

/// Triangles smaller than this have no direction to speak of.
const SMALLEST_TRIANGLE_M2: f64 = 1e-6;
/// A field never has more cells than this (4 bytes each); larger scenes get larger cells.
const MOST_CELLS: f64 = 16e6;

impl FacetField {
    /// The field of the facets for which `take` holds, inside the box `low..high`.
    pub fn new(
        city: &CityModel,
        low: &Point3<f64>,
        high: &Point3<f64>,
        reach_m: f64,
        take: impl Fn(u32) -> bool,
    ) -> FacetField {
        let extent = high - low;
        let volume = extent.x * extent.y * extent.z;
        let cell_m = reach_m.max((volume / MOST_CELLS).cbrt());
        let cells = [0, 1, 2].map(|k| (extent[k] / cell_m).ceil().max(1.0) as usize);
        let triangles = near_triangles(city, low, high, take);
        let mut field =
            FacetField { triangles: Vec::new(), low: *low, cells, cell_m, starts: Vec::new(), entries: Vec::new() };
        field.fill(&triangles, reach_m);
        field.triangles = triangles.into_iter().map(|(t, _)| t).collect();
        field
    }

    fn fill(&mut self, triangles: &[(FieldTriangle, [Point3<f64>; 3])], reach_m: f64) {
        let mut counts = vec![0u32; self.cells.iter().product::<usize>() + 1];
        for (t, corners) in triangles {
            self.each_cell(t, corners, reach_m, |cell| counts[cell + 1] += 1);
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut entries = vec![0u32; counts[counts.len() - 1] as usize];
        let mut next = counts.clone();
        for (i, (t, corners)) in triangles.iter().enumerate() {
            self.each_cell(t, corners, reach_m, |cell| {
                entries[next[cell] as usize] = i as u32;
                next[cell] += 1;
            });
        }
        self.starts = counts;
        self.entries = entries;
    }

    /// Calls `visit` with every cell that holds a place within `reach_m` of the triangle (and a few more at its corners).
    fn each_cell(&self, t: &FieldTriangle, corners: &[Point3<f64>; 3], reach_m: f64, mut visit: impl FnMut(usize)) {
        let low = corners[0].inf(&corners[1]).inf(&corners[2]) - Vector3::repeat(reach_m);
        let high = corners[0].sup(&corners[1]).sup(&corners[2]) + Vector3::repeat(reach_m);
        let index = |v: f64, k: usize| ((v - self.low[k]) / self.cell_m).floor();
        let mut range = [(0usize, 0usize); 3];
        for k in 0..3 {
            let (first, last) = (index(low[k], k), index(high[k], k));
            if last < 0.0 || first >= self.cells[k] as f64 {
                return;
            }
            range[k] = (first.max(0.0) as usize, (last as usize).min(self.cells[k] - 1));
        }
        let near = reach_m + self.cell_m * 0.5 * 3f64.sqrt();
        for z in range[2].0..=range[2].1 {
            for y in range[1].0..=range[1].1 {
                for x in range[0].0..=range[0].1 {
                    let center = self.low + self.cell_m * Vector3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5);
                    let across = t.normal.dot(&center.coords) + t.offset;
                    if across.abs() <= near && t.outside(&center) <= near {
                        visit((z * self.cells[1] + y) * self.cells[0] + x);
                    }
                }
            }
        }
    }

    /// The nearest triangle within `gate_m` whose outward normal agrees with the probe's. `gate_m` may not exceed the reach
    /// that the field was made with.
    #[inline]
    pub fn nearest(&self, probe: &Probe, gate_m: f64) -> Option<Hit> {
        let p = &probe.position;
        let d = (p - self.low) / self.cell_m;
        if !(d.x >= 0.0 && d.y >= 0.0 && d.z >= 0.0) {
            return None;
        }
        let (x, y, z) = (d.x as usize, d.y as usize, d.z as usize);
        if x >= self.cells[0] || y >= self.cells[1] || z >= self.cells[2] {
            return None;
        }
        let cell = (z * self.cells[1] + y) * self.cells[0] + x;
        let list = &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        let mut best: Option<Hit> = None;
        let mut best_sq = gate_m * gate_m;
        for &i in list {
            let t = &self.triangles[i as usize];
            let cos = t.normal.dot(&probe.normal);
            if (if probe.sided { cos } else { cos.abs() }) < probe.min_cos {
                continue;
            }
            let across_m = t.normal.dot(&p.coords) + t.offset;
            if across_m * across_m >= best_sq {
                continue;
            }
            let outside_m = t.outside(p);
            let hit = Hit { triangle: i, across_m, outside_m };
            if hit.distance_sq() < best_sq {
                best_sq = hit.distance_sq();
                best = Some(hit);
            }
        }
        best
    }
}

impl FieldTriangle {
    fn new(corners: &[Point3<f64>; 3], city: &CityModel, facet: FacetId) -> Option<FieldTriangle> {
        let [a, b, c] = corners;
        let across = (b - a).cross(&(c - a));
        if across.norm() < 2.0 * SMALLEST_TRIANGLE_M2 {
            return None;
        }
        let plane = &city.facets[facet.0 as usize].plane;
        // The triangulation may wind against the facet; edges point out of the triangle all the same.
        let winding = if across.dot(&plane.normal) < 0.0 { -1.0 } else { 1.0 };
        let edge = |from: &Point3<f64>, to: &Point3<f64>| {
            let out = (to - from).cross(&plane.normal).normalize() * winding;
            (out, -out.dot(&from.coords))
        };
        Some(FieldTriangle {
            normal: plane.normal,
            offset: plane.offset,
            edges: [edge(a, b), edge(b, c), edge(c, a)],
            facet,
        })
    }

    /// How far a point's foot lies outside: exact beside an edge, a little too small beyond a sharp corner.
    #[inline]
    fn outside(&self, p: &Point3<f64>) -> f64 {
        let [a, b, c] = &self.edges;
        let (a, b, c) = (a.0.dot(&p.coords) + a.1, b.0.dot(&p.coords) + b.1, c.0.dot(&p.coords) + c.1);
        a.max(b).max(c).max(0.0)
    }
}

fn near_triangles(
    city: &CityModel,
    low: &Point3<f64>,
    high: &Point3<f64>,
    take: impl Fn(u32) -> bool,
) -> Vec<(FieldTriangle, [Point3<f64>; 3])> {
    let mut found = Vec::new();
    for (f, facet) in city.facets.iter().enumerate() {
        for index in facet.triangles.clone() {
            let corners = city.triangles[index as usize].map(|v| city.vertices[v as usize]);
            let (tl, th) = (corners[0].inf(&corners[1]).inf(&corners[2]), corners[0].sup(&corners[1]).sup(&corners[2]));
            if (0..3).all(|k| tl[k] <= high[k] && th[k] >= low[k]) && take(index) {
                let id = FacetId(f as u32);
                found.extend(FieldTriangle::new(&corners, city, id).map(|t| (t, corners)));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{CityModel, Facet, ObjectId};
    use crate::geometry::Plane;

    /// Two walls, 0.4 m apart, back to back, 10 m wide and 6 m high: one looks to +x from x = 0.2, one to -x from x = -0.2.
    fn two_walls() -> CityModel {
        let mut city = CityModel { objects: vec!["walls".to_owned()], ..CityModel::default() };
        for (x, side) in [(0.2, 1.0), (-0.2, -1.0)] {
            let first = city.vertices.len() as u32;
            let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 6.0), (0.0, 6.0)];
            city.vertices.extend(corners.iter().map(|&(y, z)| Point3::new(x, y, z)));
            let start = city.triangles.len() as u32;
            city.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            city.facets.push(Facet {
                outline: (first..first + 4).collect(),
                plane: Plane::through(&Point3::new(x, 0.0, 0.0), &Vector3::new(side, 0.0, 0.0)).unwrap(),
                area: 60.0,
                object: ObjectId(0),
                triangles: start..start + 2,
            });
        }
        city
    }

    fn field() -> FacetField {
        FacetField::new(&two_walls(), &Point3::new(-5.0, -5.0, -5.0), &Point3::new(5.0, 15.0, 12.0), 1.5, |_| true)
    }

    fn probe(x: f64, y: f64, z: f64, side: f64) -> Probe {
        Probe { position: Point3::new(x, y, z), normal: Vector3::new(side, 0.0, 0.0), sided: true, min_cos: 0.9 }
    }

    #[test]
    fn finds_the_facet_that_faces_the_same_way_though_another_is_nearer() {
        let field = field();
        let hit = field.nearest(&probe(-0.3, 5.0, 3.0, 1.0), 1.0).unwrap();
        assert!((hit.across_m + 0.5).abs() < 1e-12 && hit.outside_m == 0.0);
        assert_eq!(field.triangles[hit.triangle as usize].facet, FacetId(0));
        let either = Probe { sided: false, ..probe(-0.3, 5.0, 3.0, 1.0) };
        assert_eq!(field.triangles[field.nearest(&either, 1.0).unwrap().triangle as usize].facet, FacetId(1));
    }

    #[test]
    fn measures_to_the_edge_and_ends_at_the_gate() {
        let field = field();
        let hit = field.nearest(&probe(0.2, 5.0, 6.7, 1.0), 1.0).unwrap();
        assert!(hit.across_m.abs() < 1e-12 && (hit.outside_m - 0.7).abs() < 1e-12);
        assert!(field.nearest(&probe(0.2, 5.0, 7.2, 1.0), 1.0).is_none());
        assert!(field.nearest(&probe(f64::NAN, 5.0, 3.0, 1.0), 1.0).is_none());
        assert!(field.nearest(&probe(1e9, 5.0, 3.0, 1.0), 1.0).is_none());
    }

    #[test]
    fn agrees_with_looking_at_every_triangle() {
        let field = field();
        for i in 0..500 {
            let part = |k: u64| ((i as u64 * 2_654_435_761 + k * 40_503) % 1000) as f64 / 1000.0;
            let p = probe(2.0 * part(1) - 1.0, 14.0 * part(2) - 2.0, 10.0 * part(3) - 2.0, 1.0);
            let slow = field
                .triangles
                .iter()
                .filter(|t| t.normal.x > 0.0)
                .map(|t| (t.normal.dot(&p.position.coords) + t.offset).hypot(t.outside(&p.position)))
                .fold(f64::INFINITY, f64::min);
            let fast = field.nearest(&p, 1.5).map(|h| h.distance_sq().sqrt());
            match fast {
                Some(d) => assert!((d - slow).abs() < 1e-12),
                None => assert!(slow >= 1.5),
            }
        }
    }
}
