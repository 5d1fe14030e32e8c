//! Points and photographs in glTF: a cloud, and a small frustum where each camera stood.

use gltf_json::mesh::Mode;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Index, Material, Mesh, Node};

use super::glb::{Geometry, Glb, SeenFrom};
use super::scene_extent::{Extent, linear, turned};
use crate::geometry::{Matrix3, Point3, Rotation3, Similarity};
use crate::reconstruction::{Image, Reconstruction};

/// Of a larger cloud every n-th point is written; `points.ply` has all.
const POINTS: usize = 10_000_000;
/// Length of a camera's frustum as a share of the scene's diagonal, and its limits in metres, where there are metres.
const FRUSTUM_SHARE: f64 = 1.0 / 60.0;
pub(super) const FRUSTUM_LIMITS_M: (f64, f64) = (0.3, 8.0);

const CAMERA_COLOR: [f32; 3] = [0.85, 0.20, 0.05];
/// Of points without colour, sRGB: stands out against the grey city.
pub(super) const POINT_COLOR: [u8; 3] = [230, 110, 20];

/// A reconstruction and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    pub reconstruction: &'a Reconstruction,
    /// sRGB, one a point, or empty.
    pub point_colors: &'a [[u8; 3]],
    /// Absolute city coordinates.
    pub city_from_sfm: Similarity,
}

pub(super) fn points_node(glb: &mut Glb, placed: &Placed<'_>) -> Option<Index<Node>> {
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
    let material = glb.material("points", [1.0; 3], SeenFrom::Outside);
    let geometry = Geometry { positions: &positions, colors: &colors, indices: &[], mode: Mode::Points, material };
    let mesh = glb.mesh("points", &geometry)?;
    Some(glb.node("points", Node { mesh: Some(mesh), ..Default::default() }))
}

/// One node a photograph, named as it is, so that a viewer tells which one a frustum belongs to.
pub(super) fn cameras_node(glb: &mut Glb, placed: &Placed<'_>, depth: f64) -> Option<Index<Node>> {
    // Beyond single precision a frustum has no corners.
    if placed.reconstruction.images.is_empty() || !(depth as f32).is_finite() {
        return None;
    }
    let material = glb.material("cameras", CAMERA_COLOR, SeenFrom::Outside);
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

/// `limits`: where lengths are metres.
pub(super) fn frustum_depth(extent: &Extent, limits: Option<(f64, f64)>) -> f64 {
    let depth = FRUSTUM_SHARE * extent.diagonal();
    limits.map_or(depth, |(least, most)| depth.clamp(least, most))
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

#[cfg(test)]
mod tests;
