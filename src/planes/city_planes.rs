//! Facets of one object that lie in one plane become one [`CityPlane`]: one surface; in refinement it shares one error. (The last
//! estimate groups surfaces into building planes and cells, the evidence the cloud into planes.)

use std::collections::HashMap;

use crate::city::{CityModel, FacetId, ObjectId};
use crate::geometry::{Plane, Point3, Vector3};

/// Index into [`CityPlanes::planes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PlaneId(pub u32);

/// Facets whose normals differ by no more than this are candidates for one plane.
const NORMAL_TOLERANCE_DEG: f64 = 1.5;
/// Facets of one normal are one plane if every corner lies within this distance of the plane of the largest of them. City models are drawn to
/// centimetres; walls that step by a brick (0.1 m) are different planes.
const OFFSET_TOLERANCE_M: f64 = 0.03;

/// Facets of one object in one plane.
#[derive(Clone, Debug)]
pub struct CityPlane {
    /// Plane of the largest facet, outward.
    pub plane: Plane,
    pub facets: Vec<FacetId>,
    pub area_m2: f64,
    /// Of the corners.
    pub low: Point3<f64>,
    pub high: Point3<f64>,
    pub object: ObjectId,
}

/// All planes of a city model, and the plane of each facet.
#[derive(Clone, Debug, Default)]
pub struct CityPlanes {
    pub planes: Vec<CityPlane>,
    pub plane_of_facet: Vec<PlaneId>,
}

impl CityPlanes {
    pub fn of_facet(&self, facet: FacetId) -> PlaneId {
        self.plane_of_facet[facet.0 as usize]
    }
}

/// Merges the facets of each object by normal and offset, the largest first, so that slivers join a wall and never lead it.
pub fn city_planes(city: &CityModel) -> CityPlanes {
    let mut order: Vec<u32> = (0..city.facets.len() as u32).collect();
    order.sort_by(|&a, &b| {
        let (fa, fb) = (&city.facets[a as usize], &city.facets[b as usize]);
        fa.object.cmp(&fb.object).then(fb.area.total_cmp(&fa.area)).then(a.cmp(&b))
    });
    let mut merger = Merger::new(city);
    for facet in order {
        merger.place(FacetId(facet));
    }
    merger.found
}

struct Merger<'a> {
    city: &'a CityModel,
    found: CityPlanes,
    /// Planes of the object at hand, by rounded normal and offset.
    buckets: HashMap<[i32; 4], Vec<PlaneId>>,
    object: Option<ObjectId>,
    /// Offsets are taken about a point of the object, so that a small turn of the normal does not move them far.
    pivot: Vector3<f64>,
}

/// Steps of the buckets: a little more than the tolerances reach.
const NORMAL_STEP: f64 = 1.0 / 16.0;
const OFFSET_STEP_M: f64 = 1.0;

impl<'a> Merger<'a> {
    fn new(city: &'a CityModel) -> Self {
        let found = CityPlanes { planes: Vec::new(), plane_of_facet: vec![PlaneId(0); city.facets.len()] };
        Merger { city, found, buckets: HashMap::new(), object: None, pivot: Vector3::zeros() }
    }

    fn place(&mut self, id: FacetId) {
        let facet = &self.city.facets[id.0 as usize];
        let Some(&first) = facet.outline.first() else { return };
        if self.object != Some(facet.object) {
            self.object = Some(facet.object);
            self.buckets.clear();
            self.pivot = self.city.vertices[first as usize].coords;
        }
        let key = self.key(&facet.plane);
        let plane = self.matching(id, key).unwrap_or_else(|| self.open(id, key));
        self.join(id, plane);
    }

    fn key(&self, plane: &Plane) -> [i32; 4] {
        let offset = plane.offset + plane.normal.dot(&self.pivot);
        let n = plane.normal.map(|c| (c / NORMAL_STEP).round() as i32);
        [n.x, n.y, n.z, (offset / OFFSET_STEP_M).round() as i32]
    }

    /// The oldest (hence largest) plane that the facet lies in.
    fn matching(&self, id: FacetId, key: [i32; 4]) -> Option<PlaneId> {
        let normal = &self.city.facets[id.0 as usize].plane.normal;
        // Normals within the tolerance differ by no more than its chord in each component.
        let chord = NORMAL_TOLERANCE_DEG.to_radians();
        let steps = |k: usize| {
            let step = |c: f64| (c / NORMAL_STEP).round() as i32;
            step(normal[k] - chord)..=step(normal[k] + chord)
        };
        let mut best: Option<PlaneId> = None;
        for (x, y, z) in steps(0).flat_map(|x| steps(1).flat_map(move |y| steps(2).map(move |z| (x, y, z)))) {
            for offset in key[3] - 1..=key[3] + 1 {
                let Some(planes) = self.buckets.get(&[x, y, z, offset]) else { continue };
                let found =
                    planes.iter().copied().filter(|&p| best.is_none_or(|b| p < b)).find(|&p| self.lies_in(id, p));
                best = found.or(best);
            }
        }
        best
    }

    fn lies_in(&self, id: FacetId, plane: PlaneId) -> bool {
        let facet = &self.city.facets[id.0 as usize];
        let plane = &self.found.planes[plane.0 as usize].plane;
        // A sliver's own normal means nothing; its corners decide.
        facet.plane.normal.dot(&plane.normal) > NORMAL_TOLERANCE_DEG.to_radians().cos()
            && facet
                .outline
                .iter()
                .all(|&v| plane.signed_distance(&self.city.vertices[v as usize]).abs() < OFFSET_TOLERANCE_M)
    }

    fn open(&mut self, id: FacetId, key: [i32; 4]) -> PlaneId {
        let facet = &self.city.facets[id.0 as usize];
        let plane = PlaneId(self.found.planes.len() as u32);
        self.found.planes.push(CityPlane {
            plane: facet.plane,
            facets: Vec::new(),
            area_m2: 0.0,
            low: Point3::from(Vector3::repeat(f64::INFINITY)),
            high: Point3::from(Vector3::repeat(f64::NEG_INFINITY)),
            object: facet.object,
        });
        self.buckets.entry(key).or_default().push(plane);
        plane
    }

    fn join(&mut self, id: FacetId, plane: PlaneId) {
        let facet = &self.city.facets[id.0 as usize];
        self.found.plane_of_facet[id.0 as usize] = plane;
        let plane = &mut self.found.planes[plane.0 as usize];
        plane.facets.push(id);
        plane.area_m2 += facet.area;
        for &v in &facet.outline {
            let corner = &self.city.vertices[v as usize];
            plane.low = plane.low.inf(corner);
            plane.high = plane.high.sup(corner);
        }
    }
}

#[cfg(test)]
mod tests;
