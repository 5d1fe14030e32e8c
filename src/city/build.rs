//! Polygons of all files to one model: shifted, joined, shaped, with the oddities counted.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use rayon::prelude::*;

use super::facet::{Draft, shape};
use super::origin::common_origin;
use super::source::Source;
use super::warning::{CityDefect, Warnings};
use super::{CityError, CityModel, CitySource, Facet, ObjectId};
use crate::geometry::Point3;

/// Fixed, so that results do not depend on the number of threads; large enough to be worth a thread's while.
const FACES_PER_CHUNK: usize = 2048;

/// Builds the model; the first source decides where the common origin lies.
pub(super) fn build(sources: Vec<Source>) -> Result<CityModel, CityError> {
    let mut model = CityModel::default();
    let Some(city) = sources.first() else { return Ok(model) };
    model.origin = common_origin(city);
    let mut joined = HashMap::new();
    let mut warnings = Warnings::default();
    for source in &sources {
        add_source(&mut model, &mut joined, &mut warnings, source)?;
    }
    model.warnings = warnings.into_list();
    Ok(model)
}

fn add_source(
    model: &mut CityModel,
    joined: &mut HashMap<[u64; 3], u32>,
    warnings: &mut Warnings,
    source: &Source,
) -> Result<(), CityError> {
    for warning in &source.warnings {
        warnings.add(warning.defect.clone(), warning.count, || warning.example.clone());
    }
    let first_object = model.objects.len() as u32;
    let first_facet = model.facets.len() as u32;
    let vertex_of = join_vertices(model, joined, warnings, source)?;
    let precision_m = source.precision_m;
    let chunks: Vec<Chunk> = (0..source.face_count().div_ceil(FACES_PER_CHUNK))
        .into_par_iter()
        .map(|chunk| shape_chunk(source, chunk, &vertex_of, &model.vertices, precision_m))
        .collect();
    let first_new = model.vertices.len() as u32;
    for chunk in chunks {
        for (face, defect) in &chunk.defects {
            warnings.add(defect.clone(), 1, || source.place_of(*face as usize));
        }
        add_chunk(model, chunk, first_new, first_object, source)?;
    }
    let facets = first_facet..model.facets.len() as u32;
    if facets.is_empty() {
        return Err(CityError::NoFaces { path: source.path.clone(), found: found(source) });
    }
    model.objects.extend(source.objects.iter().cloned());
    let objects = first_object..model.objects.len() as u32;
    model.sources.push(CitySource { path: source.path.clone(), role: source.role, facets, objects, precision_m });
    Ok(())
}

/// Shifts the vertices that faces use and joins those at exactly the same place, also across files.
fn join_vertices(
    model: &mut CityModel,
    joined: &mut HashMap<[u64; 3], u32>,
    warnings: &mut Warnings,
    source: &Source,
) -> Result<Vec<u32>, CityError> {
    const UNUSED: u32 = u32::MAX;
    let first_new = model.vertices.len() as u32;
    let mut vertex_of = vec![UNUSED; source.positions.len()];
    for (at, &corner) in source.corners.iter().enumerate() {
        if vertex_of[corner as usize] != UNUSED {
            continue;
        }
        let position = source.positions[corner as usize];
        // Adding zero turns a negative zero into the usual one, which has other bits.
        let key = [position.x + 0.0, position.y + 0.0, position.z + 0.0].map(f64::to_bits);
        vertex_of[corner as usize] = match joined.entry(key) {
            Entry::Occupied(entry) => {
                if *entry.get() >= first_new && source.shares_vertices {
                    warnings.add(CityDefect::DuplicateVertices, 1, || source.place_of(source.face_of_corner(at)));
                }
                *entry.get()
            }
            Entry::Vacant(entry) => {
                if model.vertices.len() >= UNUSED as usize {
                    return Err(CityError::TooLarge { path: source.path.clone() });
                }
                model.vertices.push(position - model.origin);
                *entry.insert(model.vertices.len() as u32 - 1)
            }
        };
    }
    Ok(vertex_of)
}

/// What a file without a usable face holds instead.
fn found(source: &Source) -> String {
    match source.face_count() {
        0 => format!("{} vertices and no polygons", source.positions.len()),
        faces => format!("{faces} polygons, none of which has an area"),
    }
}

/// What became of a run of faces.
struct Chunk {
    /// Each with its face.
    drafts: Vec<(u32, Draft)>,
    new_vertices: Vec<Point3<f64>>,
    /// Each with its face.
    defects: Vec<(u32, CityDefect)>,
}

fn shape_chunk(source: &Source, chunk: usize, vertex_of: &[u32], vertices: &[Point3<f64>], precision_m: f64) -> Chunk {
    let faces = chunk * FACES_PER_CHUNK..source.face_count().min((chunk + 1) * FACES_PER_CHUNK);
    let mut made = Chunk { drafts: Vec::with_capacity(faces.len()), new_vertices: Vec::new(), defects: Vec::new() };
    for face in faces {
        let ring = ring_of(source.corners_of(face), vertex_of);
        let shaped = shape(ring, vertices, precision_m, &mut made.new_vertices);
        made.drafts.extend(shaped.drafts.into_iter().map(|draft| (face as u32, draft)));
        made.defects.extend(shaped.defects.into_iter().map(|defect| (face as u32, defect)));
    }
    made
}

/// The face's vertices without immediate repetitions, also across the closing edge.
fn ring_of(corners: &[u32], vertex_of: &[u32]) -> Vec<u32> {
    let mut ring: Vec<u32> = corners.iter().map(|&corner| vertex_of[corner as usize]).collect();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

/// Gives the drafts their places in the model.
fn add_chunk(
    model: &mut CityModel,
    chunk: Chunk,
    first_new: u32,
    first_object: u32,
    source: &Source,
) -> Result<(), CityError> {
    let too_large = || CityError::TooLarge { path: source.path.clone() };
    // Chunks number their new vertices as if each were the first to add any.
    let moved_by = model.vertices.len() as u32 - first_new;
    let vertex = |index: u32| if index < first_new { index } else { index + moved_by };
    u32::try_from(model.vertices.len() + chunk.new_vertices.len()).map_err(|_| too_large())?;
    model.vertices.extend(chunk.new_vertices);
    for (face, draft) in chunk.drafts {
        let start = model.triangles.len() as u32;
        model.triangles.extend(draft.triangles.into_iter().map(|triangle| triangle.map(vertex)));
        let end = u32::try_from(model.triangles.len()).map_err(|_| too_large())?;
        let mut outline = draft.outline;
        outline.iter_mut().for_each(|corner| *corner = vertex(*corner));
        model.facets.push(Facet {
            outline,
            plane: draft.plane,
            area: draft.area,
            object: ObjectId(first_object + source.face_objects[face as usize]),
            triangles: start..end,
        });
    }
    Ok(())
}
