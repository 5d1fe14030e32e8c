//! `scene.glb`: the city, the points in it and the cameras that saw them, for any viewer.
//!
//! glTF is y up: city (x, y, z) is written as (x, z, -y). Vertices are single precision, so they are relative to the
//! city's local origin, which stands in `asset.extras` in full precision. Faces carry no normals: the specification has
//! viewers shade them flat then, which is what a polyhedral city wants.

use std::io::Write;
use std::path::Path;

use gltf_json::mesh::Mode;
use gltf_json::{Index, Node};
use serde_json::json;

use super::file::{ExportError, write_file};
use super::glb::{Geometry, Glb, SeenFrom};
use super::gltf_city::{city_node, facets_by_object, triangles_of};
pub use super::gltf_photographs::Placed;
use super::gltf_photographs::{FRUSTUM_LIMITS_M, POINT_COLOR, cameras_node, frustum_depth, points_node};
use super::scene_extent::{Extent, linear, turned};
use crate::city::CityModel;
use crate::geometry::Point3;

/// What a scene shows.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Name of the root node: a viewer shows it first, so it says whether the pose is to be relied on.
    pub title: &'a str,
    /// `None` where the scene stands in the frame of a reconstruction, which knows neither metres nor up.
    pub city: Option<&'a CityModel>,
    /// `None` where no pose was found: the scene shows the city alone.
    pub placed: Option<Placed<'a>>,
}

/// Writes a scene as GLB.
pub fn write_scene(path: &Path, scene: &Scene<'_>) -> Result<(), ExportError> {
    let mut glb = Glb::default();
    let nothing = CityModel::default();
    let city = scene.city.unwrap_or(&nothing);
    // The frame of all that follows: relative to the city's origin, z up.
    let placed = scene.placed.map(|p| Placed { city_from_sfm: p.city_from_sfm.relative_to(&city.origin), ..p });
    let extent = placed.as_ref().and_then(|p| Extent::of_points(&in_city(p)));
    let (city_node, written) = city_node(&mut glb, city, extent.as_ref());
    let mut children = Vec::from_iter(city_node);
    if let (Some(placed), Some(extent)) = (&placed, &extent) {
        children.extend(points_node(&mut glb, placed));
        children.extend(cameras_node(&mut glb, placed, frustum_depth(extent, scene.city.map(|_| FRUSTUM_LIMITS_M))));
    }
    let children = (!children.is_empty()).then_some(children);
    let root = glb.node(scene.title, Node { children, ..Default::default() });
    let extras = json!({
        "origin": city.origin.as_slice(),
        "frame": match scene.city {
            Some(_) => "x = city x, y = city z (up), z = -city y, metres, relative to origin (city frame: x, y, z)",
            None => "x = x, y = z, z = -y of the reconstruction's own frame and unit; its up is not known",
        },
        "city_triangles": { "in_model": city.triangles.len(), "written": written },
    });
    write_glb(path, glb, root, &extras)
}

/// Writes a city with a colour (sRGB) for every facet.
pub fn write_colored_city(path: &Path, title: &str, city: &CityModel, colors: &[[u8; 3]]) -> Result<(), ExportError> {
    let mut glb = Glb::default();
    let material = glb.material("planes", [1.0; 3], SeenFrom::BothSides);
    let mut children = Vec::new();
    for (object, facets) in facets_by_object(city, None) {
        // Facets of one object may share vertices but not colours: every facet has its own.
        let (mut positions, mut vertex_colors) = (Vec::new(), Vec::new());
        for (index, facet) in facets {
            let color = linear(colors.get(index).copied().unwrap_or(POINT_COLOR));
            for corner in triangles_of(city, facet).iter().flatten() {
                positions.push(turned(&city.vertices[*corner as usize]));
                vertex_colors.push(color);
            }
        }
        let geometry =
            Geometry { positions: &positions, colors: &vertex_colors, indices: &[], mode: Mode::Triangles, material };
        let name = city.objects.get(object).map_or("", String::as_str);
        if let Some(mesh) = glb.mesh(name, &geometry) {
            children.push(glb.node(name, Node { mesh: Some(mesh), ..Default::default() }));
        }
    }
    let children = (!children.is_empty()).then_some(children);
    let root = glb.node(title, Node { children, ..Default::default() });
    write_glb(path, glb, root, &json!({ "origin": city.origin.as_slice() }))
}

/// The points, city frame.
fn in_city(placed: &Placed<'_>) -> Vec<Point3<f64>> {
    placed.reconstruction.points.iter().map(|p| placed.city_from_sfm.apply(p)).collect()
}

fn write_glb(path: &Path, glb: Glb, root: Index<Node>, extras: &serde_json::Value) -> Result<(), ExportError> {
    let bytes = glb.into_bytes(root, extras).map_err(|source| ExportError::Json { path: path.into(), source })?;
    write_file(path, |out| out.write_all(&bytes))
}

#[cfg(test)]
mod tests;
