//! What must hold before the `gltf` crate may read.

use gltf::json;
use gltf::json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf::json::validation::{Checked, Error, Validate};

use serde::Deserialize;

use super::buffers::Buffers;
use super::extensions::Extensions;
use super::nodes::{json_error, missing};
use super::{GltfError, GltfProblem};

/// Parts of a glTF file that a reader of triangles must trust; the tree of nodes is read elsewhere.
const GEOMETRY: [&str; 4] = ["accessors", "bufferViews", "buffers", "meshes"];

/// Those parts, parsed. The others (materials, animations, ...) are passed over: a few bytes of JSON can make much of them.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Geometry {
    asset: json::Asset,
    #[serde(default)]
    accessors: Vec<json::Accessor>,
    #[serde(default)]
    buffer_views: Vec<json::buffer::View>,
    #[serde(default)]
    buffers: Vec<json::Buffer>,
    #[serde(default)]
    meshes: Vec<json::Mesh>,
}

/// Parses the JSON and checks what all geometry hangs on.
pub(super) fn document(json: &[u8], extensions: &Extensions) -> Result<gltf::Document, GltfError> {
    let Geometry { asset, accessors, buffer_views, buffers, meshes } =
        serde_json::from_slice(json).map_err(|error| json_error(&error))?;
    let root = json::Root { asset, accessors, buffer_views, buffers, meshes, ..json::Root::default() };
    check_primitives(&root)?;
    let mut first = None;
    root.validate(&root, json::Path::new, &mut |path, error| {
        let path = path();
        let part = path.as_str().split(['.', '[']).next().unwrap_or_default();
        if first.is_none() && GEOMETRY.contains(&part) && is_grave(path.as_str(), error) {
            let invalid = || GltfError::at(path.as_str(), GltfProblem::Invalid { what: explained(error).to_owned() });
            let is_without_bytes = part == "accessors" && path.as_str().ends_with("bufferView");
            let packed = if is_without_bytes { extensions.check_accessor(path.as_str()) } else { Ok(()) };
            first = Some(packed.err().unwrap_or_else(invalid));
        }
    });
    match first {
        Some(error) => Err(error),
        None => Ok(gltf::Document::from_json_without_validation(root)),
    }
}

/// The version stands before everything else: the parts of glTF 1 have the same names and other types.
pub(super) fn version(json: &[u8]) -> Result<(), GltfError> {
    #[derive(Deserialize)]
    struct Versioned {
        asset: Asset,
    }
    #[derive(Deserialize)]
    struct Asset {
        version: String,
    }
    let Versioned { asset } = serde_json::from_slice(json).map_err(|error| json_error(&error))?;
    if !asset.version.starts_with("2.") {
        return Err(GltfError::at("asset.version", GltfProblem::Version { found: asset.version }));
    }
    Ok(())
}

/// Bounds are not read, materials neither, and attributes of odd names are passed over.
fn is_grave(path: &str, error: Error) -> bool {
    let is_bound = path.ends_with(".min") || path.ends_with(".max");
    let is_looks = path.contains(".material") || path.contains(".extensions") || path.contains(".targets");
    let is_odd_name = path.contains(".attributes") && error == Error::Invalid;
    !(is_bound || is_looks || is_odd_name)
}

fn explained(error: Error) -> &'static str {
    match error {
        Error::IndexOutOfBounds => "index of something that does not exist",
        Error::Invalid => "value is invalid",
        Error::Missing => "value is missing",
        Error::Oversize => "number is too large",
        _ => "value is not supported",
    }
}

/// The crate's own validation looks accessors up before it has checked their index.
fn check_primitives(root: &json::Root) -> Result<(), GltfError> {
    for (mesh_at, mesh) in root.meshes.iter().enumerate() {
        for (at, primitive) in mesh.primitives.iter().enumerate() {
            let used = primitive.attributes.values().chain(&primitive.indices);
            if let Some(accessor) = used.map(|accessor| accessor.value()).find(|&index| index >= root.accessors.len()) {
                let place = format!("meshes[{mesh_at}].primitives[{at}]");
                let error = GltfError::at(place, missing("accessor", accessor, root.accessors.len()));
                return Err(GltfError { object: mesh.name.clone(), ..error });
            }
        }
    }
    Ok(())
}

/// What an accessor must be for its use.
#[derive(Debug)]
pub(super) struct Expected {
    pub kind: Type,
    pub components: &'static [ComponentType],
    pub words: &'static str,
}

const POSITIONS: Expected =
    Expected { kind: Type::Vec3, components: &[ComponentType::F32], words: "three 32-bit floats (VEC3, FLOAT)" };

const QUANTIZED_POSITIONS: Expected = Expected {
    kind: Type::Vec3,
    components: &[ComponentType::F32, ComponentType::I8, ComponentType::U8, ComponentType::I16, ComponentType::U16],
    words: "three floats or whole numbers of 8 or 16 bits (VEC3)",
};

const INDICES: Expected = Expected {
    kind: Type::Scalar,
    components: &[ComponentType::U8, ComponentType::U16, ComponentType::U32],
    words: "unsigned whole numbers (SCALAR, UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT)",
};

const FEATURES: Expected = Expected {
    kind: Type::Scalar,
    components: &[
        ComponentType::F32,
        ComponentType::I8,
        ComponentType::U8,
        ComponentType::I16,
        ComponentType::U16,
        ComponentType::U32,
    ],
    words: "single numbers (SCALAR)",
};

/// An accessor of positions whose bytes are all there; returns how many.
pub(super) fn positions(root: &json::Root, index: usize, buffers: &mut Buffers<'_>) -> Result<usize, GltfError> {
    let expected = if buffers.extensions().is_quantized { &QUANTIZED_POSITIONS } else { &POSITIONS };
    accessor_of(root, index, expected, buffers)
}

/// An accessor of unsigned whole numbers whose bytes are all there; returns how many.
pub(super) fn indices(root: &json::Root, index: usize, buffers: &mut Buffers<'_>) -> Result<usize, GltfError> {
    accessor_of(root, index, &INDICES, buffers)
}

/// An accessor of numbers of features whose bytes are all there; returns how many.
pub(super) fn features(root: &json::Root, index: usize, buffers: &mut Buffers<'_>) -> Result<usize, GltfError> {
    accessor_of(root, index, &FEATURES, buffers)
}

/// Checks type and bytes of an accessor; returns how many elements it has.
pub(super) fn accessor_of(
    root: &json::Root,
    index: usize,
    expected: &Expected,
    buffers: &mut Buffers<'_>,
) -> Result<usize, GltfError> {
    let accessor = accessor(root, index)?;
    let is_component = match accessor.component_type {
        Checked::Valid(GenericComponentType(component)) => expected.components.contains(&component),
        Checked::Invalid => false,
    };
    if accessor.type_ != Checked::Valid(expected.kind) || !is_component {
        let problem = GltfProblem::AccessorType { found: described(accessor), expected: expected.words };
        return Err(at_accessor(index, problem));
    }
    check_bytes(root, index, accessor, buffers)?;
    // Elements with bytes were found to be there, others are bounded by `MeshReader`.
    Ok(usize::try_from(accessor.count.0).unwrap_or(usize::MAX))
}

fn accessor(root: &json::Root, index: usize) -> Result<&json::Accessor, GltfError> {
    let count = root.accessors.len();
    root.accessors.get(index).ok_or_else(|| at_accessor(index, missing("accessor", index, count)))
}

pub(super) fn at_accessor(index: usize, problem: GltfProblem) -> GltfError {
    GltfError::at(format!("accessors[{index}]"), problem)
}

fn described(accessor: &json::Accessor) -> String {
    let component = match accessor.component_type {
        Checked::Valid(GenericComponentType(kind)) => format!("{kind:?}"),
        Checked::Invalid => "of unknown components".to_owned(),
    };
    let dimensions = match accessor.type_ {
        Checked::Valid(kind) => format!("{kind:?}"),
        Checked::Invalid => "of unknown type".to_owned(),
    };
    format!("{dimensions} {component}")
}

fn check_bytes(
    root: &json::Root,
    index: usize,
    accessor: &json::Accessor,
    buffers: &mut Buffers<'_>,
) -> Result<(), GltfError> {
    let (Checked::Valid(kind), Checked::Valid(component)) = (accessor.type_, accessor.component_type) else {
        return Err(at_accessor(index, GltfProblem::Invalid { what: "accessor of unknown type".to_owned() }));
    };
    let item_bytes = (kind.multiplicity() * component.0.size()) as u64;
    let count = accessor.count.0;
    if count == 0 {
        return Err(at_accessor(index, GltfProblem::Invalid { what: "accessor has no elements".to_owned() }));
    }
    let items = |count, offset| Items { count, offset, item_bytes };
    match accessor.buffer_view {
        Some(view) => {
            let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
            items(count, offset).check(root, view.value(), buffers).map_err(|error| named(error, index))?;
        }
        None if accessor.sparse.is_none() => {
            let what = format!("accessor of {count} elements has no bufferView");
            return Err(at_accessor(index, GltfProblem::Invalid { what }));
        }
        // All zeros but for the sparse values: `MeshReader` bounds the count.
        None => {}
    }
    let Some(sparse) = &accessor.sparse else { return Ok(()) };
    let values = items(sparse.count.0, sparse.values.byte_offset.0);
    values.check(root, sparse.values.buffer_view.value(), buffers).map_err(|error| named(error, index))?;
    check_sparse_indices(root, sparse, count, buffers).map_err(|error| named(error, index))
}

/// Sparse indices must rise, or the crate would wait for one that has passed.
fn check_sparse_indices(
    root: &json::Root,
    sparse: &json::accessor::sparse::Sparse,
    count: u64,
    buffers: &mut Buffers<'_>,
) -> Result<(), GltfError> {
    let Checked::Valid(IndexComponentType(component)) = sparse.indices.component_type else {
        return Err(GltfError::at("", GltfProblem::Invalid { what: "sparse indices of unknown type".to_owned() }));
    };
    let item_bytes = component.size() as u64;
    let items = Items { count: sparse.count.0, offset: sparse.indices.byte_offset.0, item_bytes };
    let Range { bytes, stride } = items.check(root, sparse.indices.buffer_view.value(), buffers)?;
    let mut lowest = 0;
    for item in bytes.chunks(stride) {
        let mut word = [0; 8];
        word[..item_bytes as usize].copy_from_slice(&item[..item_bytes as usize]);
        let index = u64::from_le_bytes(word);
        if index < lowest || index >= count {
            let what = format!("sparse index {index} does not rise, or is not below {count}");
            return Err(GltfError::at("", GltfProblem::Invalid { what }));
        }
        lowest = index + 1;
    }
    Ok(())
}

fn named(error: GltfError, accessor: usize) -> GltfError {
    let place = match error.place.as_str() {
        "" => format!("accessors[{accessor}]"),
        inner => format!("accessors[{accessor}], {inner}"),
    };
    GltfError { place, ..error }
}

/// Elements in a buffer view.
pub(super) struct Items {
    pub count: u64,
    pub offset: u64,
    pub item_bytes: u64,
}

/// The bytes from the first element to the last.
pub(super) struct Range<'b> {
    pub bytes: &'b [u8],
    pub stride: usize,
}

impl Items {
    /// Makes sure that the buffer's bytes are there, and finds the elements in them.
    fn check<'b>(
        &self,
        root: &json::Root,
        view_index: usize,
        buffers: &'b mut Buffers<'_>,
    ) -> Result<Range<'b>, GltfError> {
        let buffer = root.buffer_views.get(view_index).map(|view| view.buffer.value());
        if let Some((index, buffer)) = buffer.and_then(|index| Some((index, root.buffers.get(index)?))) {
            buffers.load(index, buffer)?;
        }
        self.range(root, view_index, buffers)
    }

    /// Finds the elements in a buffer that was loaded, with figures that no file can make overflow.
    pub fn range<'b>(
        &self,
        root: &json::Root,
        view_index: usize,
        buffers: &'b Buffers<'_>,
    ) -> Result<Range<'b>, GltfError> {
        let at = |problem| GltfError::at(format!("bufferViews[{view_index}]"), problem);
        let view = root
            .buffer_views
            .get(view_index)
            .ok_or_else(|| at(missing("bufferView", view_index, root.buffer_views.len())))?;
        let stride = view.byte_stride.map_or(self.item_bytes, |stride| stride.0 as u64);
        if stride < self.item_bytes || self.count == 0 {
            let what = format!("byteStride {stride} is smaller than an element, or there are none");
            return Err(at(GltfProblem::Invalid { what }));
        }
        let bytes = u128::from(stride) * u128::from(self.count - 1) + u128::from(self.item_bytes);
        let (start, end) = (u128::from(self.offset), u128::from(self.offset) + bytes);
        let length = view.byte_length.0;
        if end > u128::from(length) {
            return Err(at(GltfProblem::BeyondEnd { what: "the accessor", end, available: length }));
        }
        let buffer_index = view.buffer.value();
        let count = root.buffers.len();
        if buffer_index >= count {
            return Err(at(missing("buffer", buffer_index, count)));
        }
        let available = buffers.bytes(buffer_index).unwrap_or_default();
        let view_start = u128::from(view.byte_offset.map_or(0, |offset| offset.0));
        if view_start + u128::from(length) > available.len() as u128 {
            let (end, available) = (view_start + u128::from(length), available.len() as u64);
            return Err(at(GltfProblem::BeyondEnd { what: "the bufferView", end, available }));
        }
        // Both sums lie within the buffer, so they fit in usize.
        let bytes = &available[(view_start + start) as usize..(view_start + end) as usize];
        Ok(Range { bytes, stride: stride as usize })
    }
}
