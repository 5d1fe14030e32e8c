//! Primitives to triangles, brought to the scene's frame.

use gltf::Document;
use gltf::mesh::Mode;
use gltf::mesh::util::ReadIndices;
use nalgebra::Vector3;

use super::buffers::Buffers;
use super::nodes::{Placed, missing};
use super::{GltfError, GltfFile, GltfPart, GltfProblem, check};

/// Metres; the same reach as an OBJ file has.
const COORDINATE_LIMIT: f64 = 1e9;

/// Vertices and indices together, over all nodes. A few bytes of JSON can show one mesh a million times; memory for
/// this many is what a large machine has.
const ELEMENT_LIMIT: usize = 1 << 26;

/// Reads meshes, and counts how much it has read.
pub(super) struct MeshReader<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    elements: usize,
}

impl<'a> MeshReader<'a> {
    pub fn new(document: &'a Document, buffers: Buffers<'a>) -> MeshReader<'a> {
        MeshReader { document, buffers, elements: 0 }
    }

    /// Adds one mesh where it stands.
    pub fn read(&mut self, placed: &Placed, file: &mut GltfFile) -> Result<(), GltfError> {
        let count = self.document.as_json().meshes.len();
        let mesh = self.document.meshes().nth(placed.mesh);
        let mesh = mesh.ok_or_else(|| GltfError::at(&placed.place, missing("mesh", placed.mesh, count)))?;
        let (positions, triangles) = (Vec::new(), Vec::new());
        let mut part = GltfPart { name: placed.name.clone(), positions, triangles, spacing_m: 0.0 };
        for primitive in mesh.primitives() {
            let place = format!("meshes[{}].primitives[{}]", placed.mesh, primitive.index());
            if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
                file.without_surface += 1;
                file.first_without_surface.get_or_insert_with(|| placed.name.clone());
                continue;
            }
            self.read_primitive(&primitive, &place, placed, &mut part)?;
        }
        if !part.triangles.is_empty() {
            file.parts.push(part);
        }
        Ok(())
    }

    fn read_primitive(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        place: &str,
        placed: &Placed,
        part: &mut GltfPart,
    ) -> Result<(), GltfError> {
        let root = self.document.as_json();
        let Some(positions) = primitive.get(&gltf::Semantic::Positions) else {
            let what = "primitive has no POSITION".to_owned();
            return Err(GltfError::at(place, GltfProblem::Invalid { what }));
        };
        check::positions(root, positions.index(), &mut self.buffers)?;
        if let Some(indices) = primitive.indices() {
            check::indices(root, indices.index(), &mut self.buffers)?;
        }
        let corners = primitive.indices().map_or(positions.count(), |indices| indices.count());
        self.elements = self.elements.saturating_add(positions.count()).saturating_add(corners);
        if self.elements > ELEMENT_LIMIT {
            return Err(GltfError::at(place, GltfProblem::TooLarge { limit: ELEMENT_LIMIT }));
        }
        let reader = primitive.reader(|buffer| self.buffers.bytes(buffer.index()));
        let Some(positions) = reader.read_positions() else {
            let what = "POSITION cannot be read".to_owned();
            return Err(GltfError::at(place, GltfProblem::Invalid { what }));
        };
        let first = part.positions.len();
        let shown = place_vertices(positions, placed, part).map_err(|problem| GltfError::at(place, problem))?;
        let indices = match reader.read_indices() {
            Some(ReadIndices::U8(indices)) => indices.map(u32::from).collect(),
            Some(ReadIndices::U16(indices)) => indices.map(u32::from).collect(),
            Some(ReadIndices::U32(indices)) => indices.collect(),
            None => (0..shown as u32).collect::<Vec<u32>>(),
        };
        if let Some(&index) = indices.iter().find(|&&index| index as usize >= shown) {
            return Err(GltfError::at(place, GltfProblem::IndexOutOfRange { index, vertices: shown }));
        }
        let is_mirrored = placed.linear.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        let moved = |triangle: [u32; 3]| turned(triangle.map(|index| index + first as u32));
        part.triangles.extend(triangles_of(primitive.mode(), &indices).map(moved));
        Ok(())
    }
}

/// Adds the vertices in the scene's frame; returns how many they are.
fn place_vertices(
    positions: impl Iterator<Item = [f32; 3]>,
    placed: &Placed,
    part: &mut GltfPart,
) -> Result<usize, GltfProblem> {
    let first = part.positions.len();
    let mut largest: f32 = 0.0;
    for position in positions {
        largest = position.iter().fold(largest, |largest, value| largest.max(value.abs()));
        let in_scene = placed.linear * Vector3::from(position.map(f64::from)) + placed.shift;
        if !in_scene.iter().all(|value| value.abs() <= COORDINATE_LIMIT) {
            let vertex = part.positions.len() - first;
            return Err(GltfProblem::OutOfReach { vertex, limit: COORDINATE_LIMIT });
        }
        part.positions.push(in_scene.into());
    }
    let stretch = placed.linear.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let spacing = f64::from(largest) * f64::from(f32::EPSILON) * stretch;
    part.spacing_m = part.spacing_m.max(spacing);
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
