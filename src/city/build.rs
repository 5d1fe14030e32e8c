//! Polygons of all files to one model: shifted, joined, shaped, with the oddities counted.

use rayon::prelude::*;

use super::facet::{Face, Shaper};
use super::join::join_vertices;
use super::orientation::{FileSense, ToldArea, turn_outward};
use super::origin::common_origin;
use super::source::Source;
use super::validate::{check_extents, validate};
use super::warning::{CityDefect, Warnings};
use super::{CityError, CityModel, CitySource, Facet, ObjectId};
use crate::geometry::{Point3, Vector3};

/// Fixed, so that results do not depend on the number of threads; large enough to be worth a thread's while.
const FACES_PER_CHUNK: usize = 2048;

/// Builds the model; the first source decides where the common origin lies.
pub(super) fn build(sources: Vec<Source>) -> Result<CityModel, CityError> {
    let mut model = CityModel::default();
    let Some(city) = sources.first() else { return Ok(model) };
    model.origin = common_origin(city);
    let mut warnings = Warnings::default();
    let vertex_of = join_vertices(&mut model, &mut warnings, &sources)
        .ok_or_else(|| CityError::TooLarge { path: city.path.clone() })?;
    for (source, vertex_of) in sources.iter().zip(&vertex_of) {
        add_source(&mut model, &mut warnings, source, vertex_of, FileSense::Ask)?;
    }
    check_extents(&model, &mut warnings);
    model.warnings = warnings.into_list();
    Ok(model)
}

/// A part of a file, built by itself.
pub(super) struct BuiltPart {
    pub model: CityModel,
    /// The face of the source that each facet was made of.
    pub facet_faces: Vec<u32>,
    /// The vertex of the model that each position of the source became, where a face uses it.
    pub vertex_of: Vec<u32>,
    pub told: ToldArea,
}

/// Builds a part of a file about the origin of the whole; `None` where nothing in it has an area.
pub(super) fn build_part(
    source: &Source,
    origin: Vector3<f64>,
    sense: FileSense,
) -> Result<Option<BuiltPart>, CityError> {
    let mut model = CityModel { origin, ..CityModel::default() };
    let mut warnings = Warnings::default();
    let vertex_of = join_vertices(&mut model, &mut warnings, std::slice::from_ref(source));
    let vertex_of = vertex_of.and_then(|mut all| all.pop());
    let vertex_of = vertex_of.ok_or_else(|| CityError::TooLarge { path: source.path.clone() })?;
    let (facet_faces, told) = match add_source(&mut model, &mut warnings, source, &vertex_of, sense) {
        Err(CityError::NoFaces { .. }) => return Ok(None),
        added => added?,
    };
    model.warnings = warnings.into_list();
    Ok(Some(BuiltPart { model, facet_faces, vertex_of, told }))
}

fn add_source(
    model: &mut CityModel,
    warnings: &mut Warnings,
    source: &Source,
    vertex_of: &[u32],
    sense: FileSense,
) -> Result<(Vec<u32>, ToldArea), CityError> {
    for warning in &source.warnings {
        warnings.add(warning.defect.clone(), warning.count, || warning.example.clone());
    }
    let chunks: Vec<Chunk> = (0..source.face_count().div_ceil(FACES_PER_CHUNK))
        .into_par_iter()
        .map(|chunk| shape_chunk(source, chunk, vertex_of, model))
        .collect();
    reserve(model, &chunks).ok_or_else(|| CityError::TooLarge { path: source.path.clone() })?;
    let (first_new, first_facet) = (model.vertices.len() as u32, model.facets.len() as u32);
    let mut facet_faces = Vec::with_capacity(model.facets.capacity() - model.facets.len());
    for chunk in chunks {
        facet_faces.extend_from_slice(&chunk.facet_faces);
        for (face, defect) in &chunk.defects {
            warnings.add(defect.clone(), 1, || source.place_of(*face as usize));
        }
        add_chunk(model, chunk, first_new);
    }
    let facets = first_facet..model.facets.len() as u32;
    if facets.is_empty() {
        return Err(CityError::NoFaces { path: source.path.clone(), found: found(source) });
    }
    let first_object = model.objects.len() as u32;
    model.objects.extend(source.objects.iter().cloned());
    let objects = first_object..model.objects.len() as u32;
    let place_of = |facet: u32| source.place_of(facet_faces[(facet - facets.start) as usize] as usize);
    let (path, role, precision_m) = (source.path.clone(), source.role, source.precision_m);
    let contents = source.contents.clone();
    let of_file = CitySource { path, role, facets: facets.clone(), objects, precision_m, contents };
    // `validate` must see the turned model.
    let told = turn_outward(model, &of_file, warnings, sense, place_of);
    validate(model, &of_file, warnings, place_of);
    model.sources.push(of_file);
    Ok((facet_faces, told))
}

/// Makes room for all runs; `None` where an index would not fit in 32 bits.
fn reserve(model: &mut CityModel, chunks: &[Chunk]) -> Option<()> {
    let facets: usize = chunks.iter().map(|chunk| chunk.facets.len()).sum();
    let triangles: usize = chunks.iter().map(|chunk| chunk.triangles.len()).sum();
    let vertices: usize = chunks.iter().map(|chunk| chunk.new_vertices.len()).sum();
    u32::try_from(model.triangles.len() + triangles).ok()?;
    u32::try_from(model.vertices.len() + vertices).ok()?;
    model.facets.reserve(facets);
    model.triangles.reserve(triangles);
    Some(())
}

/// What a file without a usable face holds instead.
fn found(source: &Source) -> String {
    match source.face_count() {
        0 => source.nothing_found(),
        1 => "one polygon, which has no area or crosses itself beyond repair".into(),
        faces => format!("{faces} polygons, all without an area or crossing themselves beyond repair"),
    }
}

/// What became of a run of faces.
struct Chunk {
    facets: Vec<Facet>,
    /// The face that each facet was made of.
    facet_faces: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    new_vertices: Vec<Point3<f64>>,
    defects: Vec<(u32, CityDefect)>,
}

fn shape_chunk(source: &Source, chunk: usize, vertex_of: &[u32], model: &CityModel) -> Chunk {
    let first_object = model.objects.len() as u32;
    let faces = chunk * FACES_PER_CHUNK..source.face_count().min((chunk + 1) * FACES_PER_CHUNK);
    let mut shaper = Shaper::new(&model.vertices, source.precision_m, faces.len());
    let mut facet_faces = Vec::with_capacity(faces.len());
    for face in faces {
        let mut rings = source.rings_of(face).map(|corners| ring_of(corners, vertex_of));
        shaper.shape(Face {
            number: face as u32,
            object: ObjectId(first_object + source.face_objects[face]),
            kind: source.face_kinds.get(face).copied().flatten(),
            outline: rings.next().unwrap_or_default(),
            holes: rings.collect(),
        });
        facet_faces.resize(shaper.facets.len(), face as u32);
    }
    let Shaper { facets, triangles, new_vertices, defects, .. } = shaper;
    Chunk { facets, facet_faces, triangles, new_vertices, defects }
}

/// The ring's vertices without immediate repetitions, also across the closing edge.
fn ring_of(corners: &[u32], vertex_of: &[u32]) -> Vec<u32> {
    let mut ring: Vec<u32> = corners.iter().map(|&corner| vertex_of[corner as usize]).collect();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

/// Moves a run's facets behind those that the model has.
fn add_chunk(model: &mut CityModel, mut chunk: Chunk, first_new: u32) {
    // Every run numbers its new vertices as if it were the first to add any.
    let moved_by = model.vertices.len() as u32 - first_new;
    if moved_by > 0 && !chunk.new_vertices.is_empty() {
        for corner in chunk.triangles.iter_mut().flatten().filter(|corner| **corner >= first_new) {
            *corner += moved_by;
        }
        for facet in chunk.facets.iter_mut() {
            let corners = facet.outline.iter_mut().chain(facet.holes.iter_mut().flatten());
            corners.filter(|corner| **corner >= first_new).for_each(|corner| *corner += moved_by);
        }
    }
    let first_triangle = model.triangles.len() as u32;
    for facet in &mut chunk.facets {
        facet.triangles = facet.triangles.start + first_triangle..facet.triangles.end + first_triangle;
    }
    model.vertices.append(&mut chunk.new_vertices);
    model.triangles.append(&mut chunk.triangles);
    model.facets.append(&mut chunk.facets);
}
