//! The tree of nodes, with transforms in f64.

use std::collections::BTreeMap;

use gltf::json;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;

use super::{GltfError, GltfProblem};

/// A rotation shorter than this has no direction; the standard asks for length one.
const SHORTEST_QUATERNION: f64 = 1e-6;

/// The parts of the JSON whose numbers the `gltf` crate would change: it rounds transforms to f32, and cuts indices
/// beyond 32 bits down to some that may exist. These here are refused by their type.
#[derive(Deserialize)]
struct RawRoot {
    #[serde(default)]
    nodes: Vec<RawNode>,
    #[serde(default, rename = "meshes")]
    _meshes: Vec<RawMesh>,
    #[serde(default, rename = "accessors")]
    _accessors: Vec<RawReference>,
    #[serde(default, rename = "bufferViews")]
    _buffer_views: Vec<RawReference>,
}

#[derive(Clone, Default, Deserialize)]
pub(super) struct RawNode {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    #[serde(rename = "mesh")]
    _mesh: Option<u32>,
    #[serde(rename = "children")]
    _children: Option<Vec<u32>>,
}

#[derive(Deserialize)]
struct RawMesh {
    #[serde(default, rename = "primitives")]
    _primitives: Vec<RawPrimitive>,
}

#[derive(Deserialize)]
struct RawPrimitive {
    #[serde(default, rename = "attributes")]
    _attributes: BTreeMap<String, u32>,
    #[serde(rename = "indices")]
    _indices: Option<u32>,
}

#[derive(Deserialize)]
struct RawReference {
    #[serde(rename = "bufferView")]
    _buffer_view: Option<u32>,
    #[serde(rename = "buffer")]
    _buffer: Option<u32>,
}

/// A mesh and where it stands: `x_in_scene = linear * x_in_mesh + shift`.
pub(super) struct Placed {
    pub name: String,
    /// Place in the JSON.
    pub place: String,
    pub mesh: usize,
    pub linear: Matrix3<f64>,
    pub shift: Vector3<f64>,
}

#[derive(Clone, Copy)]
struct Affine {
    linear: Matrix3<f64>,
    shift: Vector3<f64>,
}

const IDENTITY: Affine =
    Affine { linear: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), shift: Vector3::new(0.0, 0.0, 0.0) };

pub(super) fn read(json: &[u8]) -> Result<Vec<RawNode>, GltfError> {
    let root: RawRoot = serde_json::from_slice(json).map_err(|error| json_error(&error))?;
    Ok(root.nodes)
}

pub(super) fn json_error(error: &serde_json::Error) -> GltfError {
    // The message carries the place, and would say it twice.
    let message = error.to_string();
    let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message).to_owned();
    let place = format!("JSON line {} column {}", error.line(), error.column());
    GltfError::at(place, GltfProblem::Json { message })
}

/// All meshes of the scene that is shown, walked from the roots down in file order.
pub(super) fn place(nodes: &[RawNode], root: &json::Root) -> Result<Vec<Placed>, GltfError> {
    if root.nodes.is_empty() {
        return Ok(lone_meshes(root));
    }
    let mut placed = Vec::new();
    let mut is_seen = vec![false; root.nodes.len()];
    let mut open: Vec<(usize, Affine)> = roots(root).into_iter().rev().map(|node| (node, IDENTITY)).collect();
    while let Some((index, parent)) = open.pop() {
        let at = |problem| GltfError::at(format!("nodes[{index}]"), problem);
        let (Some(node), Some(raw)) = (root.nodes.get(index), nodes.get(index)) else {
            return Err(at(missing("node", index, root.nodes.len())));
        };
        if std::mem::replace(&mut is_seen[index], true) {
            let what = "node has two parents, or is its own ancestor; nodes must form a tree".to_owned();
            return Err(at(GltfProblem::Invalid { what }));
        }
        let here = raw.affine().map_err(at)?.after(&parent);
        if let Some(mesh) = node.mesh {
            let mesh_name = root.meshes.get(mesh.value()).and_then(|mesh| mesh.name.clone());
            let name = node.name.clone().or(mesh_name).unwrap_or_else(|| format!("node {index}"));
            let place = format!("nodes[{index}]");
            placed.push(Placed { name, place, mesh: mesh.value(), linear: here.linear, shift: here.shift });
        }
        open.extend(node.children.iter().flatten().rev().map(|child| (child.value(), here)));
    }
    Ok(placed)
}

/// The shown scene's nodes; without a scene, the nodes that are nobody's child.
fn roots(root: &json::Root) -> Vec<usize> {
    let shown = root.scene.map_or(0, |scene| scene.value());
    if let Some(scene) = root.scenes.get(shown) {
        return scene.nodes.iter().map(|node| node.value()).collect();
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
            *is_child = true;
        }
    }
    (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
}

/// A file that has meshes and no nodes shows nothing by the standard; whoever gives it as a city means the meshes.
fn lone_meshes(root: &json::Root) -> Vec<Placed> {
    let place = |(index, mesh): (usize, &json::Mesh)| Placed {
        name: mesh.name.clone().unwrap_or_else(|| format!("mesh {index}")),
        place: format!("meshes[{index}]"),
        mesh: index,
        linear: IDENTITY.linear,
        shift: IDENTITY.shift,
    };
    root.meshes.iter().enumerate().map(place).collect()
}

pub(super) fn missing(what: &'static str, index: usize, count: usize) -> GltfProblem {
    GltfProblem::Missing { what, index: index as u64, count }
}

impl RawNode {
    fn affine(&self) -> Result<Affine, GltfProblem> {
        if let Some(m) = &self.matrix {
            if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
                let what = "node matrix is not affine: its last row must be 0, 0, 0, 1".to_owned();
                return Err(GltfProblem::Invalid { what });
            }
            let linear = Matrix3::new(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
            return Ok(Affine { linear, shift: Vector3::new(m[12], m[13], m[14]) });
        }
        let [x, y, z, w] = self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let turned = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), SHORTEST_QUATERNION)
            .ok_or_else(|| GltfProblem::Invalid { what: "node rotation is a quaternion of length zero".to_owned() })?;
        let scale = Matrix3::from_diagonal(&Vector3::from(self.scale.unwrap_or([1.0; 3])));
        let linear = turned.to_rotation_matrix().into_inner() * scale;
        Ok(Affine { linear, shift: Vector3::from(self.translation.unwrap_or_default()) })
    }
}

impl Affine {
    /// This transform, then the parent's.
    fn after(&self, parent: &Affine) -> Affine {
        Affine { linear: parent.linear * self.linear, shift: parent.linear * self.shift + parent.shift }
    }
}
