//! One block of a model to the records of an index.

use zerocopy::little_endian::{F64, U32, U64};

use super::plan::BlockPlan;
use crate::city::{CityModel, Facet, SurfaceKind};
use crate::format::city_index::{BlockEntry, BlockParts, FacetRecord, ObjectRecord, VertexRecord};
use crate::geometry::Point3;

/// The places of a model's parts among those of the whole city.
pub(super) struct Orders<'a> {
    pub facet: &'a dyn Fn(u32) -> u32,
    pub object: &'a dyn Fn(u32) -> u32,
    pub vertex: &'a dyn Fn(u32) -> u64,
}

/// The model is the whole city.
pub(super) const SAME: Orders<'static> =
    Orders { facet: &|facet| facet, object: &|object| object, vertex: &|vertex| vertex as u64 };

/// Codes of kinds in the file; 0 is none.
const KINDS: [SurfaceKind; 5] =
    [SurfaceKind::Ground, SurfaceKind::Roof, SurfaceKind::Wall, SurfaceKind::Closure, SurfaceKind::Other];

pub(super) fn kind_of_code(code: u8) -> Option<SurfaceKind> {
    KINDS.get(usize::from(code).checked_sub(1)?).copied()
}

fn code_of_kind(kind: Option<SurfaceKind>) -> u8 {
    let at = KINDS.iter().position(|known| Some(*known) == kind);
    at.map_or(0, |at| at as u8 + 1)
}

/// The records of a block, and what the directory says of it.
pub(super) fn packed(model: &CityModel, plan: &BlockPlan, orders: &Orders) -> (BlockParts, BlockEntry) {
    let mut parts = BlockParts::default();
    for &object in &plan.objects {
        let name = &model.objects[object as usize];
        let (order, name_length) = (U32::new((orders.object)(object)), U32::new(name.len() as u32));
        parts.objects.push(ObjectRecord { order, name_length });
        parts.names.push_str(name);
    }
    let facets = || plan.facets.iter().map(|&facet| (facet, &model.facets[facet as usize]));
    let mut vertices: Vec<u32> = facets().flat_map(|(_, facet)| vertices_of(model, facet)).collect();
    let (low, high) = box_of(vertices.iter().map(|&vertex| model.vertices[vertex as usize]));
    vertices.extend(&plan.strays);
    vertices.sort_unstable();
    vertices.dedup();
    for &vertex in &vertices {
        let position = model.vertices[vertex as usize];
        let position = [position.x, position.y, position.z].map(F64::new);
        parts.vertices.push(VertexRecord { order: U64::new((orders.vertex)(vertex)), position });
    }
    // Everything that is looked up was put in above.
    let local = |sorted: &[u32], number: u32| U32::new(sorted.partition_point(|&other| other < number) as u32);
    for (id, facet) in facets() {
        for ring in facet.rings() {
            parts.ring_lengths.push(U32::new(ring.len() as u32));
            parts.corners.extend(ring.iter().map(|&vertex| local(&vertices, vertex)));
        }
        let triangles = &model.triangles[facet.triangles.start as usize..facet.triangles.end as usize];
        parts.triangles.extend(triangles.iter().map(|triangle| triangle.map(|vertex| local(&vertices, vertex))));
        let normal = facet.plane.normal;
        parts.facets.push(FacetRecord {
            order: U32::new((orders.facet)(id)),
            object: local(&plan.objects, facet.object.0),
            rings: U32::new(1 + facet.holes.len() as u32),
            triangles: U32::new(facet.triangles.len() as u32),
            kind: code_of_kind(facet.kind),
            reserved: [0; 3],
            normal: [normal.x, normal.y, normal.z].map(F64::new),
            offset: F64::new(facet.plane.offset),
            area: F64::new(facet.area),
        });
    }
    let entry = BlockEntry {
        low: low.map(F64::new),
        high: high.map(F64::new),
        model: Default::default(),
        sight: Default::default(),
        facets: U32::new(parts.facets.len() as u32),
        triangles: U32::new(parts.triangles.len() as u32),
    };
    (parts, entry)
}

fn vertices_of<'a>(model: &'a CityModel, facet: &'a Facet) -> impl Iterator<Item = u32> + 'a {
    let triangles = &model.triangles[facet.triangles.start as usize..facet.triangles.end as usize];
    facet.rings().flatten().chain(triangles.iter().flatten()).copied()
}

fn box_of(mut corners: impl Iterator<Item = Point3<f64>>) -> ([f64; 3], [f64; 3]) {
    let first = corners.next().unwrap_or_default();
    let (low, high) = corners.fold((first, first), |(low, high), corner| (low.inf(&corner), high.sup(&corner)));
    (low.into(), high.into())
}
