//! `scene.glb`: the city, the points in it and the cameras that saw them, for any viewer.
//!
//! glTF is y up: city (x, y, z) is written as (x, z, -y). Vertices are single precision, so they are relative to the
//! city's local origin, which stands in `asset.extras` in full precision. Faces carry no normals: the specification has
//! viewers shade them flat then, which is what a polyhedral city wants.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use gltf_json::mesh::Mode;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Index, Material, Mesh, Node};
use serde_json::json;

use super::file::{ExportError, write_file};
use super::glb::{Geometry, Glb};
use crate::city::{CityModel, Facet};
use crate::geometry::{Matrix3, Point3, Rotation3, Similarity, Vector3};
use crate::reconstruction::{Image, Reconstruction};

/// Viewers in a browser stay fluent up to about this many triangles; of a larger city only the part near the scene is
/// written.
const CITY_TRIANGLES: usize = 500_000;
/// How far around the scene a large city is written, metres.
const CITY_MARGIN_M: f64 = 300.0;
/// Of a larger cloud every n-th point is written; `points.ply` has all.
const POINTS: usize = 10_000_000;
/// Length of a camera's frustum as a share of the scene's diagonal, and its limits in metres, where there are metres.
const FRUSTUM_SHARE: f64 = 1.0 / 60.0;
const FRUSTUM_LIMITS_M: (f64, f64) = (0.3, 8.0);
/// Share of the points left out at each end of an axis when the extent of the scene is taken: outliers lie far away.
const OUTLIER_SHARE: f64 = 0.02;

const CITY_COLOR: [f32; 3] = [0.62, 0.62, 0.60];
const CAMERA_COLOR: [f32; 3] = [0.85, 0.20, 0.05];
/// Of points without colour, sRGB: stands out against the grey city.
const POINT_COLOR: [u8; 3] = [230, 110, 20];

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

/// A reconstruction and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    pub reconstruction: &'a Reconstruction,
    /// sRGB, one a point, or empty.
    pub point_colors: &'a [[u8; 3]],
    /// Absolute city coordinates.
    pub city_from_sfm: Similarity,
}

/// Writes a scene as GLB.
pub fn write_scene(path: &Path, scene: &Scene<'_>) -> Result<(), ExportError> {
    let mut glb = Glb::default();
    let nothing = CityModel::default();
    let city = scene.city.unwrap_or(&nothing);
    // The frame of all that follows: relative to the city's origin, z up.
    let placed = scene.placed.map(|p| Placed { city_from_sfm: p.city_from_sfm.relative_to(&city.origin), ..p });
    let extent = placed.as_ref().and_then(Extent::of_points);
    let (city_node, written) = city_node(&mut glb, city, extent.as_ref());
    let mut children = Vec::from_iter(city_node);
    if let (Some(placed), Some(extent)) = (&placed, &extent) {
        children.extend(points_node(&mut glb, placed));
        children.extend(cameras_node(&mut glb, placed, frustum_depth(extent, scene.city.is_some())));
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
    let material = glb.material("planes", [1.0; 3], true);
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

fn write_glb(path: &Path, glb: Glb, root: Index<Node>, extras: &serde_json::Value) -> Result<(), ExportError> {
    let bytes = glb.into_bytes(root, extras).map_err(|source| ExportError::Json { path: path.into(), source })?;
    write_file(path, |out| out.write_all(&bytes))
}

/// A node with one child an object, so that a viewer tells which building one clicks on; and the number of triangles.
fn city_node(glb: &mut Glb, city: &CityModel, extent: Option<&Extent>) -> (Option<Index<Node>>, usize) {
    let near = extent.filter(|_| city.triangles.len() > CITY_TRIANGLES);
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
        let open = !is_closed(&indices);
        let name = if open { "city, open surfaces" } else { "city" };
        let material = *materials[usize::from(open)].get_or_insert_with(|| glb.material(name, CITY_COLOR, open));
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
fn facets_by_object<'a>(city: &'a CityModel, near: Option<&Extent>) -> BTreeMap<usize, Vec<(usize, &'a Facet)>> {
    let mut objects: BTreeMap<usize, Vec<(usize, &Facet)>> = BTreeMap::new();
    for (index, facet) in city.facets.iter().enumerate() {
        let corners = facet.outline.iter().map(|corner| &city.vertices[*corner as usize]);
        if near.is_none_or(|extent| extent.is_near(corners)) {
            objects.entry(facet.object.0 as usize).or_default().push((index, facet));
        }
    }
    objects
}

fn triangles_of<'a>(city: &'a CityModel, facet: &Facet) -> &'a [[u32; 3]] {
    &city.triangles[facet.triangles.start as usize..facet.triangles.end as usize]
}

/// The vertices that triangles use, each once, and the triangles over them.
fn shared_vertices<'a>(city: &CityModel, triangles: impl Iterator<Item = &'a [u32; 3]>) -> (Vec<[f32; 3]>, Vec<u32>) {
    let mut number_of = std::collections::HashMap::new();
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
fn is_closed(indices: &[u32]) -> bool {
    let mut balance: Vec<(u32, u32, i32)> = indices
        .chunks_exact(3)
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .map(|(a, b)| if a < b { (a, b, 1) } else { (b, a, -1) })
        .collect();
    balance.sort_unstable();
    balance.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).all(|edge| edge.iter().map(|e| e.2).sum::<i32>() == 0)
}

fn points_node(glb: &mut Glb, placed: &Placed<'_>) -> Option<Index<Node>> {
    let sfm = placed.reconstruction;
    let step = sfm.points.len().div_ceil(POINTS).max(1);
    let (mut positions, mut colors) = (Vec::new(), Vec::new());
    for (index, point) in sfm.points.iter().enumerate().step_by(step) {
        let position = turned(&placed.city_from_sfm.apply(point));
        // Beyond single precision no viewer could show it, and the file would be invalid.
        if position.iter().all(|v| v.is_finite()) {
            positions.push(position);
            colors.push(linear(placed.point_colors.get(index).copied().unwrap_or(POINT_COLOR)));
        }
    }
    if positions.is_empty() {
        return None;
    }
    let material = glb.material("points", [1.0; 3], false);
    let geometry = Geometry { positions: &positions, colors: &colors, indices: &[], mode: Mode::Points, material };
    let mesh = glb.mesh("points", &geometry)?;
    Some(glb.node("points", Node { mesh: Some(mesh), ..Default::default() }))
}

/// One node a photograph, named as it is, so that a viewer tells which one a frustum belongs to.
fn cameras_node(glb: &mut Glb, placed: &Placed<'_>, depth: f64) -> Option<Index<Node>> {
    // Beyond single precision a frustum has no corners.
    if placed.reconstruction.images.is_empty() || !(depth as f32).is_finite() {
        return None;
    }
    let material = glb.material("cameras", CAMERA_COLOR, false);
    let mesh = frustum_mesh(glb, depth, material)?;
    let mut children = Vec::new();
    for image in &placed.reconstruction.images {
        let (rotation, center) = camera_pose(image, &placed.city_from_sfm);
        let translation = turned(&center);
        if translation.iter().all(|v| v.is_finite()) {
            let node = Node {
                mesh: Some(mesh),
                translation: Some(translation),
                rotation: Some(rotation),
                ..Default::default()
            };
            children.push(glb.node(&image.name, node));
        }
    }
    (!children.is_empty()).then(|| glb.node("cameras", Node { children: Some(children), ..Default::default() }))
}

fn frustum_depth(extent: &Extent, is_metric: bool) -> f64 {
    let depth = FRUSTUM_SHARE * extent.diagonal();
    if is_metric { depth.clamp(FRUSTUM_LIMITS_M.0, FRUSTUM_LIMITS_M.1) } else { depth }
}

/// A small pyramid in the camera frame (x right, y down, z forward) with a notch on its upper side.
fn frustum_mesh(glb: &mut Glb, depth: f64, material: Index<Material>) -> Option<Index<Mesh>> {
    // The size stands for no field of view: a fisheye's could not be drawn.
    let (w, h, d) = (0.5 * depth as f32, 0.375 * depth as f32, depth as f32);
    let corners = [[-w, -h, d], [w, -h, d], [w, h, d], [-w, h, d]];
    let positions = [[0.0; 3], corners[0], corners[1], corners[2], corners[3], [0.0, -1.5 * h, d]];
    let indices = [0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 2, 3, 3, 4, 4, 1, 1, 5, 5, 2];
    let geometry = Geometry { positions: &positions, colors: &[], indices: &indices, mode: Mode::Lines, material };
    glb.mesh("camera", &geometry)
}

/// Attitude (glTF frame from camera frame) and centre (city frame) of a photograph.
fn camera_pose(image: &Image, city_from_sfm: &Similarity) -> (UnitQuaternion, Point3<f64>) {
    let sfm_from_cam = image.cam_from_sfm_rotation.inverse();
    let center_in_sfm = Point3::from(-(sfm_from_cam * image.cam_from_sfm_translation));
    let gltf_from_city = Rotation3::from_matrix_unchecked(Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0));
    let gltf_from_cam = gltf_from_city * city_from_sfm.rotation * sfm_from_cam;
    let q = crate::geometry::UnitQuaternion::from_rotation_matrix(&gltf_from_cam);
    (UnitQuaternion([q.i as f32, q.j as f32, q.k as f32, q.w as f32]), city_from_sfm.apply(&center_in_sfm))
}

/// Box that holds nearly all points.
struct Extent {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Extent {
    fn of_points(placed: &Placed<'_>) -> Option<Extent> {
        let points: Vec<_> = placed.reconstruction.points.iter().map(|p| placed.city_from_sfm.apply(p)).collect();
        let last = points.len().checked_sub(1)?;
        let (mut low, mut high) = (Vector3::zeros(), Vector3::zeros());
        for axis in 0..3 {
            let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
            let rank = (OUTLIER_SHARE * last as f64) as usize;
            low[axis] = *values.select_nth_unstable_by(rank, f64::total_cmp).1;
            high[axis] = *values.select_nth_unstable_by(last - rank, f64::total_cmp).1;
        }
        Some(Extent { low, high })
    }

    fn diagonal(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// True where a polygon's box comes within the margin, seen from above: a large floor may have all corners far off.
    fn is_near<'a>(&self, corners: impl Iterator<Item = &'a Point3<f64>> + Clone) -> bool {
        (0..2).all(|axis| {
            let (low, high) = (self.low[axis] - CITY_MARGIN_M, self.high[axis] + CITY_MARGIN_M);
            corners.clone().any(|corner| corner[axis] <= high) && corners.clone().any(|corner| corner[axis] >= low)
        })
    }
}

/// City frame to glTF's, single precision.
fn turned(point: &Point3<f64>) -> [f32; 3] {
    [point.x as f32, point.z as f32, -point.y as f32]
}

/// glTF's vertex colours are linear (specification, 3.9.2), photographs are sRGB. 16 bits keep the dark tones.
fn linear(srgb: [u8; 3]) -> [u16; 4] {
    let [r, g, b] = srgb.map(|v| {
        let v = f64::from(v) / 255.0;
        let linear = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
        (linear * f64::from(u16::MAX)).round() as u16
    });
    [r, g, b, u16::MAX]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::ObjectId;
    use crate::geometry::Plane;

    /// A tetrahedron and a lone triangle.
    fn city() -> CityModel {
        let vertices = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 2.0], [9.0, 9.0, 1.0]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [1, 2, 4]];
        let facet = |index: usize, object| Facet {
            holes: Vec::new(),
            kind: None,
            outline: triangles[index].to_vec(),
            plane: Plane { normal: Vector3::z(), offset: 0.0 },
            area: 1.0,
            object: ObjectId(object),
            triangles: index as u32..index as u32 + 1,
        };
        CityModel {
            origin: Vector3::new(678_000.123_456_789, 5_403_400.0, 0.0),
            vertices: vertices.map(Point3::from).to_vec(),
            facets: (0..5).map(|i| facet(i, u32::from(i == 4))).collect(),
            triangles: triangles.clone(),
            objects: vec!["house".into(), "ground".into()],
            ..Default::default()
        }
    }

    fn reconstruction() -> Reconstruction {
        Reconstruction {
            images: vec![Image {
                name: "a/b.jpg".into(),
                cam_from_sfm_rotation: Rotation3::identity(),
                cam_from_sfm_translation: Vector3::new(0.0, 0.0, 5.0),
                ..Default::default()
            }],
            points: vec![Point3::new(1.0, 2.0, 3.0), Point3::new(1e300, 0.0, 0.0)],
            ..Default::default()
        }
    }

    fn written(scene: &Scene<'_>) -> (gltf::Gltf, Vec<u8>) {
        let file = tempfile::NamedTempFile::new().unwrap();
        write_scene(file.path(), scene).unwrap();
        let bytes = std::fs::read(file.path()).unwrap();
        (gltf::Gltf::from_slice(&bytes).unwrap(), bytes)
    }

    fn positions(gltf: &gltf::Gltf, mesh: &str) -> Vec<[f32; 3]> {
        let blob = gltf.blob.as_deref().unwrap();
        let mesh = gltf.meshes().find(|m| m.name() == Some(mesh)).unwrap();
        mesh.primitives().next().unwrap().reader(|_| Some(blob)).read_positions().unwrap().collect()
    }

    #[test]
    fn turns_z_up_into_y_up_relative_to_the_origin() {
        let (city, reconstruction) = (city(), reconstruction());
        let shift = Similarity { translation: city.origin, ..Similarity::identity() };
        let placed = Some(Placed {
            reconstruction: &reconstruction,
            point_colors: &reconstruction.colors,
            city_from_sfm: shift,
        });
        let (gltf, _) = written(&Scene { title: "t", city: Some(&city), placed });
        assert_eq!(positions(&gltf, "points"), [[1.0, 3.0, -2.0]]);
        assert_eq!(positions(&gltf, "ground")[2], [9.0, 1.0, -9.0]);
        let camera = gltf.nodes().find(|n| n.name() == Some("a/b.jpg")).unwrap();
        let (translation, [x, y, z, w], _) = camera.transform().decomposed();
        assert_eq!(translation, [0.0, -5.0, 0.0]);
        // The camera looks along city z, which is up: glTF +y.
        let q = crate::geometry::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
        assert!((q * nalgebra::Vector3::z() - nalgebra::Vector3::y()).norm() < 1e-6);
    }

    #[test]
    fn keeps_the_origin_in_full_precision() {
        let city = city();
        let (gltf, bytes) = written(&Scene { title: "t", city: Some(&city), placed: None });
        let extras = gltf.as_json().asset.extras.as_ref().unwrap();
        let extras: serde_json::Value = serde_json::from_str(extras.get()).unwrap();
        assert_eq!(extras["origin"][0].as_f64(), Some(city.origin.x));
        assert_eq!(bytes.len() % 4, 0);
    }

    #[test]
    fn shows_both_sides_only_of_open_surfaces() {
        let (gltf, _) = written(&Scene { title: "t", city: Some(&city()), placed: None });
        let double_sided = |name: &str| {
            let mesh = gltf.meshes().find(|m| m.name() == Some(name)).unwrap();
            mesh.primitives().next().unwrap().material().double_sided()
        };
        assert!(!double_sided("house") && double_sided("ground"));
    }

    #[test]
    fn leaves_out_of_a_large_city_what_is_far_from_the_scene() {
        let city = city();
        let objects_around = |x: f64| {
            let place = Vector3::new(x, 0.0, 0.0);
            let extent = Extent { low: place, high: place };
            facets_by_object(&city, Some(&extent)).keys().copied().collect::<Vec<_>>()
        };
        // The house reaches from 0 to 4 m, the ground from 0 to 9 m.
        assert_eq!(objects_around(0.0), [0, 1]);
        assert_eq!(objects_around(CITY_MARGIN_M + 5.0), [1]);
        assert!(objects_around(CITY_MARGIN_M + 10.0).is_empty());
    }

    #[test]
    fn writes_a_scene_without_anything_in_it() {
        let (gltf, _) = written(&Scene { title: "nothing", city: None, placed: None });
        assert_eq!(gltf.scenes().next().unwrap().nodes().next().unwrap().name(), Some("nothing"));
        assert!(gltf.blob.is_none());
    }

    #[test]
    fn turns_srgb_into_linear_light() {
        assert_eq!(linear([0, 255, 188]), [0, 65535, 32957, 65535]);
        assert_eq!(linear([10, 11, 0])[..2], [199, 219]);
    }
}
