//! The tree of nodes, with transforms in f64.

use std::borrow::Cow;
use std::fmt;

use gltf::json;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};

use super::instancing::Instancing;
use super::{GltfError, GltfProblem};

/// A rotation shorter than this has no direction; the standard asks for length one.
const SHORTEST_QUATERNION: f64 = 1e-6;

/// The parts of the JSON whose numbers the `gltf` crate would change: it rounds transforms to f32, and cuts indices
/// beyond 32 bits down to some that may exist. These here are refused by their type. Only the tree is kept.
#[derive(Deserialize)]
pub(super) struct Tree {
    #[serde(default)]
    nodes: Vec<Slot>,
    scene: Option<u32>,
    #[serde(default)]
    scenes: Vec<Scene>,
    #[serde(default, rename = "meshes")]
    _meshes: Vec<CheckedMesh>,
    #[serde(default, rename = "accessors")]
    _accessors: Vec<CheckedReference>,
    #[serde(default, rename = "bufferViews")]
    _buffer_views: Vec<CheckedReference>,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Box<[u32]>,
}

/// A node, or nothing where it has neither mesh nor children: `{}` takes three bytes of the file, and no more than eight here.
#[derive(Deserialize)]
#[serde(from = "Node")]
struct Slot(Option<Box<Node>>);

impl From<Node> for Slot {
    fn from(node: Node) -> Slot {
        let shows_nothing = node.mesh.is_none() && node.children.is_empty();
        Slot((!shows_nothing).then(|| Box::new(node)))
    }
}

#[derive(Deserialize)]
struct Node {
    name: Option<Box<str>>,
    matrix: Option<Box<[f64; 16]>>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    mesh: Option<u32>,
    #[serde(default)]
    children: Box<[u32]>,
    extensions: Option<Box<OfNode>>,
}

#[derive(Deserialize)]
struct OfNode {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    instancing: Option<Instancing>,
}

/// An index of at most 32 bits, looked at and not kept.
struct CheckedIndex;

impl<'de> Deserialize<'de> for CheckedIndex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<CheckedIndex, D::Error> {
        u32::deserialize(deserializer).map(|_| CheckedIndex)
    }
}

/// Indices by name, looked at and not kept.
#[derive(Default)]
struct CheckedIndices;

impl<'de> Deserialize<'de> for CheckedIndices {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<CheckedIndices, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = CheckedIndices;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("indices by name")
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<CheckedIndices, M::Error> {
                while map.next_entry::<IgnoredAny, CheckedIndex>()?.is_some() {}
                Ok(CheckedIndices)
            }
        }
        deserializer.deserialize_map(Entries)
    }
}

#[derive(Deserialize)]
struct CheckedMesh {
    #[serde(default, rename = "primitives")]
    _primitives: Vec<CheckedPrimitive>,
}

#[derive(Deserialize)]
struct CheckedPrimitive {
    #[serde(default, rename = "attributes")]
    _attributes: CheckedIndices,
    #[serde(rename = "indices")]
    _indices: Option<CheckedIndex>,
}

#[derive(Deserialize)]
struct CheckedReference {
    #[serde(rename = "bufferView")]
    _buffer_view: Option<CheckedIndex>,
    #[serde(rename = "buffer")]
    _buffer: Option<CheckedIndex>,
}

/// A mesh and where it stands: `x_in_scene = linear * x_in_mesh + shift`. Names are borrowed: a long one may be shown by
/// many nodes.
pub(super) struct Placed<'a> {
    name: Option<&'a str>,
    shown_by: ShownBy,
    pub mesh: usize,
    pub linear: Matrix3<f64>,
    pub shift: Vector3<f64>,
    /// Where the mesh stands many times; then `linear` and `shift` are the node's.
    pub instancing: Option<&'a Instancing>,
    /// Which of many instances it is, from 0.
    instance: Option<usize>,
}

impl<'a> Placed<'a> {
    /// One instance of many, placed in the node's frame.
    pub fn instance(&self, number: usize, place: &Affine) -> Placed<'a> {
        let Affine { linear, shift } = place.after(&Affine { linear: self.linear, shift: self.shift });
        Placed { linear, shift, instancing: None, instance: Some(number), ..*self }
    }
}

/// What shows a mesh, by its number.
#[derive(Clone, Copy)]
enum ShownBy {
    Node(u32),
    /// In a file without nodes.
    Itself,
}

impl Placed<'_> {
    /// The node's name, else the mesh's, else a number; and which instance it is.
    pub fn name(&self) -> String {
        let name = match (self.name, &self.shown_by) {
            (Some(name), _) => name.to_owned(),
            (None, ShownBy::Node(node)) => format!("node {node}"),
            (None, ShownBy::Itself) => format!("mesh {}", self.mesh),
        };
        self.instance.map_or(name.clone(), |instance| format!("{name} instance {instance}"))
    }

    /// Bytes of the name.
    pub fn name_bytes(&self) -> usize {
        self.name.map_or(0, str::len)
    }

    /// Place in the JSON.
    pub fn place(&self) -> String {
        match self.shown_by {
            ShownBy::Node(node) => format!("nodes[{node}]"),
            ShownBy::Itself => format!("meshes[{}]", self.mesh),
        }
    }
}

/// `x -> linear * x + shift`
#[derive(Clone, Copy)]
pub(super) struct Affine {
    pub linear: Matrix3<f64>,
    pub shift: Vector3<f64>,
}

const IDENTITY: Affine =
    Affine { linear: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), shift: Vector3::new(0.0, 0.0, 0.0) };

pub(super) fn read(json: &[u8]) -> Result<Tree, GltfError> {
    serde_json::from_slice(json).map_err(|error| json_error(&error))
}

pub(super) fn json_error(error: &serde_json::Error) -> GltfError {
    // The message carries the place, and would say it twice.
    let message = error.to_string();
    let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message).to_owned();
    let place = format!("JSON line {} column {}", error.line(), error.column());
    GltfError::at(place, GltfProblem::Json { message })
}

/// All meshes of the scene that is shown, walked from the roots down in file order; the scene's origin stands at `center`.
pub(super) fn place<'a>(
    tree: &'a Tree,
    meshes: &'a [json::Mesh],
    center: Option<[f64; 3]>,
) -> Result<Vec<Placed<'a>>, GltfError> {
    let scene = Affine { shift: Vector3::from(center.unwrap_or_default()), ..IDENTITY };
    let nodes = &tree.nodes;
    if nodes.is_empty() {
        return Ok(lone_meshes(meshes, &scene));
    }
    /// Siblings not yet walked, and their parent's transform.
    struct Level<'n> {
        left: std::slice::Iter<'n, u32>,
        parent: Affine,
    }
    let roots = tree.roots()?;
    let mut placed = Vec::new();
    let mut is_seen = vec![false; nodes.len()];
    let mut open = vec![Level { left: roots.iter(), parent: scene }];
    while let Some(Level { left, parent }) = open.last_mut() {
        let Some(&number) = left.next() else {
            open.pop();
            continue;
        };
        let at = |problem| GltfError::at(format!("nodes[{number}]"), problem);
        let index = number as usize;
        let Slot(node) = nodes.get(index).ok_or_else(|| at(missing("node", index, nodes.len())))?;
        if std::mem::replace(&mut is_seen[index], true) {
            let what = "node has two parents, or is its own ancestor; nodes must form a tree".to_owned();
            return Err(at(GltfProblem::Invalid { what }));
        }
        let Some(node) = node else { continue };
        let Affine { linear, shift } = node.affine().map_err(at)?.after(parent);
        if let Some(mesh) = node.mesh {
            let mesh = mesh as usize;
            let name = node.name.as_deref().or_else(|| meshes.get(mesh)?.name.as_deref());
            let shown_by = ShownBy::Node(number);
            let instancing = node.extensions.as_ref().and_then(|extensions| extensions.instancing.as_ref());
            placed.push(Placed { name, shown_by, mesh, linear, shift, instancing, instance: None });
        }
        open.push(Level { left: node.children.iter(), parent: Affine { linear, shift } });
    }
    Ok(placed)
}

impl Tree {
    /// The shown scene's nodes; without a scene, the nodes that are nobody's child.
    fn roots(&self) -> Result<Cow<'_, [u32]>, GltfError> {
        let shown = self.scene.unwrap_or(0) as usize;
        if let Some(scene) = self.scenes.get(shown) {
            return Ok(Cow::Borrowed(&scene.nodes));
        }
        if self.scene.is_some() {
            return Err(GltfError::at("scene", missing("scene", shown, self.scenes.len())));
        }
        let mut is_child = vec![false; self.nodes.len()];
        for child in self.nodes.iter().flat_map(|Slot(node)| node).flat_map(|node| &node.children) {
            if let Some(is_child) = is_child.get_mut(*child as usize) {
                *is_child = true;
            }
        }
        Ok((0..self.nodes.len()).filter(|&node| !is_child[node]).map(|node| node as u32).collect())
    }
}

/// A file that has meshes and no nodes shows nothing by the standard; whoever gives it as a city means the meshes.
fn lone_meshes<'a>(meshes: &'a [json::Mesh], scene: &Affine) -> Vec<Placed<'a>> {
    let Affine { linear, shift } = *scene;
    let placed = meshes.iter().enumerate().map(|(mesh, shown)| Placed {
        name: shown.name.as_deref(),
        shown_by: ShownBy::Itself,
        mesh,
        linear,
        shift,
        instancing: None,
        instance: None,
    });
    placed.collect()
}

pub(super) fn missing(what: &'static str, index: usize, count: usize) -> GltfProblem {
    GltfProblem::Missing { what, index: index as u64, count }
}

impl Node {
    fn affine(&self) -> Result<Affine, GltfProblem> {
        if let Some(m) = &self.matrix {
            if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
                let what = "node matrix is not affine: its last row must be 0, 0, 0, 1".to_owned();
                return Err(GltfProblem::Invalid { what });
            }
            let linear = Matrix3::new(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
            return Ok(Affine { linear, shift: Vector3::new(m[12], m[13], m[14]) });
        }
        let rotation = self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        affine_of(self.translation.unwrap_or_default(), rotation, self.scale.unwrap_or([1.0; 3]))
    }
}

/// Scale, then rotation (a quaternion x y z w of any length but zero), then translation.
pub(super) fn affine_of(translation: [f64; 3], [x, y, z, w]: [f64; 4], scale: [f64; 3]) -> Result<Affine, GltfProblem> {
    let turned = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), SHORTEST_QUATERNION)
        .ok_or_else(|| GltfProblem::Invalid { what: "node rotation is a quaternion of length zero".to_owned() })?;
    let linear = turned.to_rotation_matrix().into_inner() * Matrix3::from_diagonal(&Vector3::from(scale));
    Ok(Affine { linear, shift: Vector3::from(translation) })
}

impl Affine {
    /// This transform, then the parent's.
    fn after(&self, parent: &Affine) -> Affine {
        Affine { linear: parent.linear * self.linear, shift: parent.linear * self.shift + parent.shift }
    }
}

#[cfg(test)]
mod tests;
