//! Primitives to triangles, brought to the scene's frame.

use gltf::mesh::Mode;
use gltf::mesh::util::ReadIndices;
use gltf::{Accessor, Document, Primitive, Semantic};
use nalgebra::Vector3;

use super::accessor::{Values, largest};
use super::buffers::Buffers;
use super::nodes::{Placed, missing};
use super::{GltfError, GltfFile, GltfPart, GltfProblem, check};

/// Metres; the same reach as an OBJ file has.
const COORDINATE_LIMIT: f64 = 1e9;

/// Vertices and indices together, over all nodes: memory for this many is what a large machine has.
const ELEMENT_LIMIT: usize = 1 << 26;

/// A file may come to this many vertices and indices for each of its bytes. Written out, a vertex has twelve bytes and an index
/// at least one; but a node of some sixty bytes shows a whole mesh once more, and a sparse accessor may claim any number of
/// zeros. Chosen: a lamp of 4,000 of them may be at every corner.
const ELEMENTS_PER_BYTE: usize = 64;

/// Vertices and indices that are allowed in any case; they take a few megabytes.
const ELEMENTS_OF_ANY_FILE: usize = 1 << 16;

/// As many elements stand for what is kept of a node with a mesh, and of a primitive, besides.
const ELEMENTS_OF_A_PART: usize = 8;

/// Bytes of a name that take as much memory as an element.
const NAME_BYTES_OF_AN_ELEMENT: usize = 16;

/// Reads meshes that were checked.
pub(super) struct MeshReader<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    /// Vertices and indices of each mesh that was checked.
    sizes: Vec<Option<usize>>,
    elements: usize,
    file_bytes: usize,
}

impl<'a> MeshReader<'a> {
    /// `file_bytes`: of the file without the buffers beside it.
    pub fn new(document: &'a Document, buffers: Buffers<'a>, file_bytes: usize) -> MeshReader<'a> {
        let sizes = vec![None; document.as_json().meshes.len()];
        MeshReader { document, buffers, sizes, elements: 0, file_bytes }
    }

    /// Checks the mesh, and that there is room for it once more. To be called for every node before any is read.
    pub fn check(&mut self, placed: &Placed<'_>) -> Result<(), GltfError> {
        let size = match self.sizes.get(placed.mesh) {
            Some(Some(size)) => *size,
            _ => self.check_mesh(placed)?,
        };
        let besides = ELEMENTS_OF_A_PART + placed.name_bytes() / NAME_BYTES_OF_AN_ELEMENT;
        self.elements = self.elements.saturating_add(size).saturating_add(besides);
        self.check_room(self.elements, placed)
    }

    /// A mesh that stands many times becomes as many that stand once; to be called before the check.
    pub fn instances<'p>(&mut self, placed: Placed<'p>) -> Result<Vec<Placed<'p>>, GltfError> {
        let Some(instancing) = placed.instancing else { return Ok(vec![placed]) };
        let root = self.document.as_json();
        let count = instancing.check(root, &mut self.buffers)?;
        self.check_room(count.saturating_mul(ELEMENTS_OF_A_PART), &placed)?;
        let places = instancing.places(root, &self.buffers, count)?;
        Ok(places.iter().enumerate().map(|(number, place)| placed.instance(number, place)).collect())
    }

    /// Refuses more elements than the bytes that are there can stand for.
    fn check_room(&self, elements: usize, placed: &Placed<'_>) -> Result<(), GltfError> {
        let bytes = self.file_bytes.saturating_add(self.buffers.bytes_beside());
        let limit = bytes.saturating_mul(ELEMENTS_PER_BYTE).clamp(ELEMENTS_OF_ANY_FILE, ELEMENT_LIMIT);
        if elements > limit {
            return Err(GltfError::at(placed.place(), GltfProblem::TooLarge { limit, bytes }));
        }
        Ok(())
    }

    fn check_mesh(&mut self, placed: &Placed<'_>) -> Result<usize, GltfError> {
        let root = self.document.as_json();
        let missing_mesh = || GltfError::at(placed.place(), missing("mesh", placed.mesh, root.meshes.len()));
        let mesh = self.document.meshes().nth(placed.mesh).ok_or_else(missing_mesh)?;
        let mut size: usize = 0;
        for primitive in mesh.primitives() {
            size = size.saturating_add(ELEMENTS_OF_A_PART);
            if !has_surface(&primitive) {
                continue;
            }
            let place = format!("meshes[{}].primitives[{}]", placed.mesh, primitive.index());
            let invalid = |what: &str| GltfError::at(&place, GltfProblem::Invalid { what: what.to_owned() });
            let positions = primitive.get(&Semantic::Positions).ok_or_else(|| invalid("primitive has no POSITION"))?;
            check::positions(root, positions.index(), &mut self.buffers)?;
            size = size.saturating_add(positions.count());
            if let Some(features) = features_of(&primitive) {
                let found = check::features(root, features.index(), &mut self.buffers)?;
                if found != positions.count() {
                    return Err(invalid("one number of a feature is needed for every vertex"));
                }
                size = size.saturating_add(found);
            }
            if let Some(indices) = primitive.indices() {
                check::indices(root, indices.index(), &mut self.buffers)?;
                size = size.saturating_add(indices.count());
            }
            // Here too: many primitives may share one accessor, which is looked through for each.
            self.check_room(size, placed)?;
        }
        self.sizes[placed.mesh] = Some(size);
        Ok(size)
    }

    /// Adds one mesh where it stands.
    pub fn read(&self, placed: &Placed<'_>, file: &mut GltfFile) -> Result<(), GltfError> {
        let Some(mesh) = self.document.meshes().nth(placed.mesh) else { return Ok(()) };
        let mut part = GltfPart { name: placed.name(), ..GltfPart::default() };
        for primitive in mesh.primitives() {
            if has_surface(&primitive) {
                let place = || format!("meshes[{}].primitives[{}]", placed.mesh, primitive.index());
                self.read_primitive(&primitive, placed, &mut part).map_err(|error| match error.place.as_str() {
                    "" => GltfError { place: place(), ..error },
                    _ => error,
                })?;
            } else {
                file.without_surface += 1;
                file.first_without_surface.get_or_insert_with(|| placed.name());
            }
        }
        if !part.features.is_empty() {
            part.features.resize(part.positions.len(), NO_FEATURE);
        }
        file.parts.extend((!part.triangles.is_empty()).then_some(part));
        Ok(())
    }

    fn read_primitive(
        &self,
        primitive: &Primitive<'_>,
        placed: &Placed<'_>,
        part: &mut GltfPart,
    ) -> Result<(), GltfError> {
        let here = |problem| GltfError::at("", problem);
        let accessor = primitive.get(&Semantic::Positions);
        let accessor =
            accessor.ok_or_else(|| here(GltfProblem::Invalid { what: "primitive has no POSITION".to_owned() }))?;
        let root = self.document.as_json();
        let positions = Values::of(root, accessor.index(), &self.buffers)?;
        let first = part.positions.len();
        let vertices = place_vertices(positions, step_of(&accessor), placed, part).map_err(here)?;
        if let Some(accessor) = features_of(primitive) {
            part.features.resize(first, NO_FEATURE);
            let features = Values::<1>::of(root, accessor.index(), &self.buffers)?;
            part.features.extend(features.map(|[feature]| feature as u32));
        }
        let reader = primitive.reader(|buffer| self.buffers.bytes(buffer.index()));
        let indices: Vec<u32> = match reader.read_indices() {
            Some(ReadIndices::U8(indices)) => indices.map(u32::from).collect(),
            Some(ReadIndices::U16(indices)) => indices.map(u32::from).collect(),
            Some(ReadIndices::U32(indices)) => indices.collect(),
            None => (0..vertices as u32).collect(),
        };
        if let Some(&index) = indices.iter().find(|&&index| index as usize >= vertices) {
            return Err(here(GltfProblem::IndexOutOfRange { index, vertices }));
        }
        let is_mirrored = placed.linear.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        let moved = |triangle: [u32; 3]| turned(triangle.map(|index| index + first as u32));
        part.triangles.extend(triangles_of(primitive.mode(), &indices).map(moved));
        Ok(())
    }
}

fn has_surface(primitive: &Primitive<'_>) -> bool {
    !matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip)
}

/// The number of a vertex that says of no feature that it is part of it.
pub(super) const NO_FEATURE: u32 = u32::MAX;

/// Numbers of features, by vertex: 3D Tiles 1.0 has them under one name, EXT_mesh_features under the other.
fn features_of<'a>(primitive: &Primitive<'a>) -> Option<Accessor<'a>> {
    ["BATCHID", "FEATURE_ID_0"].iter().find_map(|name| primitive.get(&Semantic::Extras((*name).to_owned())))
}

/// How finely positions are told: by the size of the coordinate, or by the whole number one.
#[derive(Clone, Copy)]
enum Step {
    OfFloats,
    Fixed(f64),
}

fn step_of(accessor: &Accessor<'_>) -> Step {
    match (largest(accessor.data_type()), accessor.normalized()) {
        (Some(largest), true) => Step::Fixed(largest.recip()),
        (Some(_), false) => Step::Fixed(1.0),
        (None, _) => Step::OfFloats,
    }
}

/// Adds the vertices in the scene's frame; returns how many they are.
fn place_vertices(
    positions: impl Iterator<Item = [f64; 3]>,
    step: Step,
    placed: &Placed<'_>,
    part: &mut GltfPart,
) -> Result<usize, GltfProblem> {
    let first = part.positions.len();
    let mut largest: f64 = 0.0;
    for position in positions {
        largest = position.iter().fold(largest, |largest, value| largest.max(value.abs()));
        let in_scene = placed.linear * Vector3::from(position) + placed.shift;
        if !in_scene.iter().all(|value| value.abs() <= COORDINATE_LIMIT) {
            let vertex = part.positions.len() - first;
            return Err(GltfProblem::OutOfReach { vertex, limit: COORDINATE_LIMIT });
        }
        part.positions.push(in_scene.into());
    }
    let stretch = placed.linear.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let step = match step {
        Step::OfFloats => largest * f64::from(f32::EPSILON),
        Step::Fixed(step) => step,
    };
    part.spacing_m = part.spacing_m.max(step * stretch);
    Ok(part.positions.len() - first)
}

/// Triangles of a list, a strip or a fan, each counter-clockwise as the first is. Corners that are left over are no
/// triangle, nor are those of a strip that repeat a vertex: writers join strips that way.
fn triangles_of(mode: Mode, indices: &[u32]) -> Box<dyn Iterator<Item = [u32; 3]> + '_> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(at, corners): (usize, &[u32])| match at % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[1], corners[0], corners[2]],
            };
            let is_triangle = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
            Box::new(indices.windows(3).enumerate().map(turned).filter(is_triangle))
        }
        Mode::TriangleFan => {
            let hub = indices.first().copied().unwrap_or_default();
            Box::new(indices.windows(2).skip(1).map(move |rim| [hub, rim[0], rim[1]]))
        }
        _ => Box::new(indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]])),
    }
}
