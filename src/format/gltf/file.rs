//! A glTF or GLB file as parts with triangles.

use std::path::Path;

use super::buffers::Buffers;
use super::container::{self, is_glb};
use super::extensions::Extensions;
use super::mesh::MeshReader;
use super::{check, nodes};
use crate::format::escaped;

/// Triangles of the scene in its own frame: metres, y up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GltfFile {
    /// In the order in which the scene's nodes are walked, children after their parents; instances of a node one after the other.
    pub parts: Vec<GltfPart>,
    /// CESIUM_RTC, which is in all positions already.
    pub center: Option<[f64; 3]>,
    /// Primitives of points or lines, which have no surface.
    pub without_surface: u64,
    /// Node that holds the first of them.
    pub first_without_surface: Option<String>,
}

/// A mesh where one node puts it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GltfPart {
    /// The node's name, else the mesh's, else the node's number.
    pub name: String,
    pub positions: Vec<[f64; 3]>,
    /// Counter-clockwise seen from outside, also where the node mirrors the mesh.
    pub triangles: Vec<[u32; 3]>,
    /// Number of the feature that each vertex is part of (`_BATCHID`, `_FEATURE_ID_0`), [`u32::MAX`] for none; empty where the
    /// file tells no features apart.
    pub features: Vec<u32>,
    /// Distance of neighbouring f32 numbers at the largest coordinate, or the step of whole numbers: no finer than this can the
    /// part be known, metres.
    pub spacing_m: f64,
}

/// Why bytes are no glTF scene, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct GltfError {
    /// Byte of the file, place in its JSON, or nothing where the whole is meant.
    pub place: String,
    /// Name of the node or mesh it concerns.
    pub object: Option<String>,
    pub problem: GltfProblem,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GltfProblem {
    #[error("the file is cut off: {what} says {claimed} bytes, {found} are there")]
    Truncated { what: &'static str, claimed: u64, found: u64 },
    #[error("glTF version {}, expected 2; convert the file", escaped(found))]
    Version { found: String },
    #[error("expected a chunk of type {expected}, found {found}")]
    Chunk { expected: &'static str, found: String },
    #[error("the JSON is broken: {}", escaped(message))]
    Json { message: String },
    #[error("the file needs the extension {}, which is not read; {remedy}", escaped(name))]
    Extension { name: String, remedy: &'static str },
    #[error("{what} {index} does not exist, there are {count}")]
    Missing { what: &'static str, index: u64, count: usize },
    #[error("{what}")]
    Invalid { what: String },
    #[error("accessor is {found}, expected {expected}")]
    AccessorType { found: String, expected: &'static str },
    #[error("{what} reaches to byte {end}, but there are {available}")]
    BeyondEnd { what: &'static str, end: u128, available: u64 },
    #[error("index {index} points outside the primitive's {vertices} vertices")]
    IndexOutOfRange { index: u32, vertices: usize },
    #[error("vertex {vertex} is not finite or farther than {limit:e} m from zero")]
    OutOfReach { vertex: usize, limit: f64 },
    #[error(
        "more than {limit} vertices and indices when every node has its mesh, too many for {bytes} bytes; split the file, \
         or write every mesh where it stands"
    )]
    TooLarge { limit: usize, bytes: usize },
    #[error("buffer `{}` cannot be read: {reason}", escaped(uri))]
    Buffer { uri: String, reason: String },
}

impl GltfError {
    pub(super) fn at(place: impl Into<String>, problem: GltfProblem) -> GltfError {
        GltfError { place: place.into(), object: None, problem }
    }

    /// Names the object where none is named yet.
    fn of(self, object: &str) -> GltfError {
        GltfError { object: self.object.or_else(|| Some(object.to_owned())), ..self }
    }
}

/// Reads glTF JSON or GLB. Further buffers are looked for in `folder`, and nowhere else.
pub fn read_gltf(bytes: &[u8], folder: &Path) -> Result<GltfFile, GltfError> {
    let (json, blob) = if is_glb(bytes) { container::split(bytes)? } else { (bytes, None) };
    check::version(json)?;
    let extensions = Extensions::of(json)?;
    let tree = nodes::read(json)?;
    let document = check::document(json, &extensions)?;
    let placed = nodes::place(&tree, &document.as_json().meshes, extensions.center)?;
    let mut reader = MeshReader::new(&document, Buffers::new(blob, folder, &extensions), bytes.len());
    let mut instances = Vec::new();
    for place in placed {
        let name = place.name();
        for instance in reader.instances(place).map_err(|error| error.of(&name))? {
            reader.check(&instance).map_err(|error| error.of(&instance.name()))?;
            instances.push(instance);
        }
    }
    let mut file = GltfFile { center: extensions.center, ..GltfFile::default() };
    for instance in &instances {
        reader.read(instance, &mut file).map_err(|error| error.of(&instance.name()))?;
    }
    Ok(file)
}
