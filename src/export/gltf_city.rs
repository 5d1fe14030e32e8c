//! The city in glTF: one node an object, in one colour or with a colour for every facet.

use std::collections::{BTreeMap, HashMap};

use gltf_json::mesh::Mode;
use gltf_json::{Index, Node};

use super::glb::{Geometry, Glb, SeenFrom};
use super::scene_extent::{Extent, turned};
use crate::city::{CityModel, Facet};

/// Viewers in a browser stay fluent up to about this many triangles; of a larger city only the part near the scene is
/// written.
const CITY_TRIANGLES: usize = 500_000;
const CITY_COLOR: [f32; 3] = [0.62, 0.62, 0.60];

/// A node with one child an object, so that a viewer tells which building one clicks on; and the number of triangles.
pub(super) fn city_node(glb: &mut Glb, city: &CityModel, extent: Option<&Extent>) -> (Option<Index<Node>>, usize) {
    let near = extent.filter(|_| city.whole_size().triangles > CITY_TRIANGLES);
    // Of closed and of open objects; made when first needed, since an unused one draws a remark of the validator.
    let mut materials = [None; 2];
    let mut written = 0;
    let mut children = Vec::new();
    for (object, facets) in facets_by_object(city, near) {
        let triangles = facets.iter().flat_map(|(_, facet)| triangles_of(city, facet));
        let (positions, indices) = shared_vertices(city, triangles);
        if indices.is_empty() {
            continue;
        }
        written += indices.len() / 3;
        let (at, name, seen_from) = match is_closed(&indices) {
            true => (0, "city", SeenFrom::Outside),
            false => (1, "city, open surfaces", SeenFrom::BothSides),
        };
        let material = *materials[at].get_or_insert_with(|| glb.material(name, CITY_COLOR, seen_from));
        let geometry =
            Geometry { positions: &positions, colors: &[], indices: &indices, mode: Mode::Triangles, material };
        let name = city.objects.get(object).map_or("", String::as_str);
        if let Some(mesh) = glb.mesh(name, &geometry) {
            children.push(glb.node(name, Node { mesh: Some(mesh), ..Default::default() }));
        }
    }
    if children.is_empty() {
        return (None, written);
    }
    (Some(glb.node("city", Node { children: Some(children), ..Default::default() })), written)
}

/// Facets with their indices, grouped by the index of their object, in order; those near `near` where that is given.
pub(super) fn facets_by_object<'a>(
    city: &'a CityModel,
    near: Option<&Extent>,
) -> BTreeMap<usize, Vec<(usize, &'a Facet)>> {
    let mut objects: BTreeMap<usize, Vec<(usize, &Facet)>> = BTreeMap::new();
    for (index, facet) in city.facets.iter().enumerate() {
        let corners = facet.outline.iter().map(|corner| &city.vertices[*corner as usize]);
        if near.is_none_or(|extent| extent.is_near(corners)) {
            objects.entry(facet.object.0 as usize).or_default().push((index, facet));
        }
    }
    objects
}

pub(super) fn triangles_of<'a>(city: &'a CityModel, facet: &Facet) -> &'a [[u32; 3]] {
    &city.triangles[facet.triangles.start as usize..facet.triangles.end as usize]
}

/// The vertices that triangles use, each once, and the triangles over them.
fn shared_vertices<'a>(city: &CityModel, triangles: impl Iterator<Item = &'a [u32; 3]>) -> (Vec<[f32; 3]>, Vec<u32>) {
    let mut number_of = HashMap::new();
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for corner in triangles.flatten() {
        let next = positions.len() as u32;
        let number = *number_of.entry(*corner).or_insert(next);
        if number == next {
            positions.push(turned(&city.vertices[*corner as usize]));
        }
        indices.push(number);
    }
    (positions, indices)
}

/// True where every edge is met as often in one direction as in the other: then nobody sees a face from behind.
pub(super) fn is_closed(indices: &[u32]) -> bool {
    let mut balance: Vec<(u32, u32, i32)> = indices
        .chunks_exact(3)
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .map(|(a, b)| if a < b { (a, b, 1) } else { (b, a, -1) })
        .collect();
    balance.sort_unstable();
    balance.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).all(|edge| edge.iter().map(|e| e.2).sum::<i32>() == 0)
}

#[cfg(test)]
mod tests;
