//! One file's polygons, brought to z up but not yet shifted, joined or judged.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::warning::{CityDefect, CityPlace, CityWarning};
use super::{CityContents, CityError, CityRole, CityUp, SurfaceKind};
use crate::format::gltf::GltfFile;
use crate::format::obj::{ObjFile, ObjObject, ObjOddities};
use crate::geometry::{Point3, Vector3};

/// Vertices looked at to find the precision; more would tell nothing new.
const PRECISION_SAMPLES: usize = 10_000;

/// Decimals down to which steps may be rounding: a model on a grid of metres or decimetres is of that shape.
const COARSEST_DECIMALS: i32 = 2;

/// Decimals beyond which nobody measures: micrometres.
const FINEST_DECIMALS: i32 = 6;

/// How far a scaled coordinate may be from a whole number: f64 holds ten-metre-thousand kilometres to 1e-9 m, which at
/// micrometres is a thousandth of a digit.
const MULTIPLE_TOLERANCE: f64 = 1e-2;

/// Numbers held no finer than this share of a digit would all look like multiples of it.
const TELLING_SPACING: f64 = 0.2;

/// Share of coordinates with more digits than the rest (computed ones) that does not make a file finer.
const ODD_SHARE: f64 = 0.01;

/// Step of 32-bit positions from which on it is told, metres: no survey is coarser by itself.
const COARSE_STEP_M: f64 = 0.01;

/// Metres; the same reach as an OBJ file has.
const COORDINATE_LIMIT: f64 = 1e9;

/// Polygons of one file: file coordinates, metres, z up.
pub(super) struct Source {
    pub path: PathBuf,
    pub role: CityRole,
    pub positions: Vec<Point3<f64>>,
    /// Position indices of all faces, one face after the other, in each the outline and then its holes.
    pub corners: Vec<u32>,
    /// End of each face in `corners`.
    pub face_ends: Vec<u32>,
    /// Face and first corner of every hole, ascending; most files have none.
    pub holes: Vec<(u32, u32)>,
    /// Line of each face; empty where the format has no lines.
    pub face_lines: Vec<u32>,
    /// What each face is; empty where the format does not say.
    pub face_kinds: Vec<Option<SurfaceKind>>,
    /// Index into `objects` of each face.
    pub face_objects: Vec<u32>,
    pub objects: Vec<String>,
    pub contents: CityContents,
    /// Whether faces of this format share vertices, so that two at one place are a defect.
    pub shares_vertices: bool,
    /// How finely coordinates are written, metres.
    pub precision_m: f64,
    /// What the reader of the format passed over.
    pub warnings: Vec<CityWarning>,
}

impl Source {
    pub fn face_count(&self) -> usize {
        self.face_ends.len()
    }

    /// The corners of a face's outline, then of each of its holes.
    pub fn rings_of(&self, face: usize) -> impl Iterator<Item = &[u32]> {
        let start = if face == 0 { 0 } else { self.face_ends[face - 1] };
        let first = self.holes.partition_point(|hole| (hole.0 as usize) < face);
        let count = self.holes[first..].iter().take_while(|hole| hole.0 as usize == face).count();
        let own = &self.holes[first..first + count];
        let starts = std::iter::once(start).chain(own.iter().map(|hole| hole.1));
        let ends = own.iter().map(|hole| hole.1).chain([self.face_ends[face]]);
        starts.zip(ends).map(|(start, end)| &self.corners[start as usize..end as usize])
    }

    /// All corners of a face, of its outline and its holes.
    pub fn corners_of(&self, face: usize) -> &[u32] {
        let start = if face == 0 { 0 } else { self.face_ends[face - 1] };
        &self.corners[start as usize..self.face_ends[face] as usize]
    }

    /// The face that holds the corner at this index.
    pub fn face_of_corner(&self, at: usize) -> usize {
        self.face_ends.partition_point(|&end| end as usize <= at)
    }

    /// Turns the axis that is up in the file to z.
    pub fn turn(&mut self, up: CityUp) {
        if up == CityUp::Y {
            self.positions.iter_mut().for_each(|position| *position = Point3::new(position.x, -position.z, position.y));
        }
    }

    /// To metres, then to where the model stood before somebody shifted it.
    pub fn scale_and_shift(&mut self, metres: f64, origin: [f64; 3]) {
        let shift = Vector3::from(origin);
        if metres != 1.0 || shift != Vector3::zeros() {
            self.positions.iter_mut().for_each(|position| *position = *position * metres + shift);
            self.precision_m *= metres;
        }
    }

    /// Refuses corners that a unit or an origin took too far for coordinates to mean anything.
    pub fn check_reach(&self) -> Result<(), CityError> {
        let is_near = |position: &Point3<f64>| position.iter().all(|value| value.abs() <= COORDINATE_LIMIT);
        let corners = self.corners.iter().map(|&vertex| vertex as usize);
        match corners.into_iter().find(|&vertex| !is_near(&self.positions[vertex])) {
            None => Ok(()),
            Some(vertex) => Err(CityError::OutOfReach {
                path: self.path.clone(),
                vertex,
                position: self.positions[vertex].into(),
                limit: COORDINATE_LIMIT,
            }),
        }
    }

    /// What a file without a face holds instead.
    pub fn nothing_found(&self) -> String {
        let vertices = format!("{} vertices and no polygons", self.positions.len());
        match self.warnings.first() {
            None => vertices,
            Some(warning) => format!("{vertices}; {warning}"),
        }
    }

    pub fn place_of(&self, face: usize) -> CityPlace {
        CityPlace {
            path: self.path.clone(),
            line: self.face_lines.get(face).copied(),
            object: self.objects[self.face_objects[face] as usize].clone(),
        }
    }

    pub fn from_obj(path: &Path, role: CityRole, file: ObjFile) -> Source {
        let (objects, face_objects) = objects_of(path, &file.objects, file.face_ends.len());
        let positions: Vec<Point3<f64>> = file.positions.into_iter().map(Point3::from).collect();
        let mut source = Source {
            path: path.to_owned(),
            role,
            contents: CityContents::plain("OBJ", objects.len(), file.face_ends.len()),
            precision_m: written_precision(&positions, 0.0),
            positions,
            corners: file.corners,
            face_ends: file.face_ends,
            holes: Vec::new(),
            face_lines: file.face_lines,
            face_kinds: Vec::new(),
            face_objects,
            objects,
            shares_vertices: true,
            warnings: obj_warnings(path, &file.oddities),
        };
        if file.oddities.lost_vertices.count > 0 {
            source.drop_lost_faces();
        }
        source
    }

    /// Leaves out faces with a corner at a vertex that is nowhere.
    fn drop_lost_faces(&mut self) {
        let is_lost = |source: &Source, face: usize| {
            source
                .rings_of(face)
                .flatten()
                .any(|&vertex| !source.positions[vertex as usize].iter().all(|v| v.is_finite()))
        };
        let (lost, kept): (Vec<usize>, Vec<usize>) = (0..self.face_count()).partition(|&face| is_lost(self, face));
        let Some(&first) = lost.first() else { return };
        let (defect, example) = (CityDefect::LostCorner, self.place_of(first));
        self.warnings.push(CityWarning { defect, count: lost.len() as u64, example });
        let (mut corners, mut face_ends) = (Vec::with_capacity(self.corners.len()), Vec::with_capacity(kept.len()));
        for &face in &kept {
            corners.extend(self.rings_of(face).flatten());
            face_ends.push(corners.len() as u32);
        }
        self.face_lines = kept.iter().map(|&face| self.face_lines[face]).collect();
        self.face_objects = kept.iter().map(|&face| self.face_objects[face]).collect();
        (self.corners, self.face_ends) = (corners, face_ends);
    }
}

impl Source {
    /// The axes stay as the file has them: y up.
    pub fn from_gltf(path: &Path, role: CityRole, file: GltfFile) -> Source {
        let spacing_m = file.parts.iter().map(|part| part.spacing_m).fold(0.0, f64::max);
        let without_surface = CityWarning {
            defect: CityDefect::NoSurface,
            count: file.without_surface,
            example: CityPlace {
                path: path.to_owned(),
                line: None,
                object: file.first_without_surface.unwrap_or_default(),
            },
        };
        let triangles = file.parts.iter().map(|part| part.triangles.len()).sum();
        let mut source = Source {
            path: path.to_owned(),
            role,
            positions: Vec::new(),
            corners: Vec::with_capacity(3 * triangles),
            face_ends: (1..=triangles).map(|face| 3 * face as u32).collect(),
            holes: Vec::new(),
            face_lines: Vec::new(),
            face_kinds: Vec::new(),
            face_objects: Vec::with_capacity(triangles),
            objects: Vec::with_capacity(file.parts.len()),
            contents: CityContents::plain("glTF 2.0", file.parts.len(), triangles),
            shares_vertices: false,
            precision_m: 0.0,
            warnings: if file.without_surface > 0 { vec![without_surface] } else { Vec::new() },
        };
        for part in file.parts {
            let first = source.positions.len() as u32;
            source.face_objects.extend(std::iter::repeat_n(source.objects.len() as u32, part.triangles.len()));
            source.objects.push(part.name);
            source.corners.extend(part.triangles.iter().flatten().map(|index| first + index));
            source.positions.extend(part.positions.into_iter().map(Point3::from));
        }
        source.precision_m = written_precision(&source.positions, spacing_m);
        if spacing_m >= COARSE_STEP_M {
            let example = CityPlace { path: path.to_owned(), line: None, object: String::new() };
            let defect = CityDefect::CoarseFloats { step_m: spacing_m };
            source.warnings.push(CityWarning { defect, count: 1, example });
        }
        source
    }
}

fn obj_warnings(path: &Path, oddities: &ObjOddities) -> Vec<CityWarning> {
    let kinds = [
        (CityDefect::UnknownLines, oddities.unknown_lines),
        (CityDefect::FreeForms, oddities.free_forms),
        (CityDefect::TooFewCorners, oddities.short_faces),
        (CityDefect::LostVertices, oddities.lost_vertices),
    ];
    let met = kinds.into_iter().filter(|(_, tally)| tally.count > 0);
    met.map(|(defect, tally)| {
        let example = CityPlace { path: path.to_owned(), line: Some(tally.first_line), object: String::new() };
        CityWarning { defect, count: tally.count, example }
    })
    .collect()
}

/// The power of ten that nearly all coordinates are multiples of: what the writer rounded to. Numbers that the format
/// itself can only hold to `spacing_m` are no better known than that.
pub(super) fn written_precision(positions: &[Point3<f64>], spacing_m: f64) -> f64 {
    let step = positions.len().div_ceil(PRECISION_SAMPLES).max(1);
    let sample: Vec<f64> = positions.iter().step_by(step).flat_map(|position| position.iter().copied()).collect();
    let is_odd = |value: f64, per_metre: f64| {
        let scaled = value * per_metre;
        (scaled - scaled.round()).abs() > MULTIPLE_TOLERANCE.max(spacing_m * per_metre)
    };
    let powers = (COARSEST_DECIMALS..=FINEST_DECIMALS).map(|decimals| 10_f64.powi(decimals));
    let found = powers.take_while(|per_metre| spacing_m * per_metre < TELLING_SPACING).find(|&per_metre| {
        let odd = sample.iter().filter(|&&value| is_odd(value, per_metre)).count();
        odd as f64 <= ODD_SHARE * sample.len() as f64
    });
    found.map_or(spacing_m.max(10_f64.powi(-FINEST_DECIMALS)), f64::recip)
}

/// Which lines name buildings. With several `o` lines that have faces, each begins a building, and groups are its parts;
/// with at most one (a whole scene), groups are buildings, and a group that comes back under its name is the same.
/// What has no name is called after the file.
fn objects_of(path: &Path, objects: &[ObjObject], face_count: usize) -> (Vec<String>, Vec<u32>) {
    let nameless = path.file_stem().map_or_else(|| "city".into(), |stem| stem.to_string_lossy().into_owned());
    let mut names = Vec::new();
    let mut face_objects = vec![0; face_count];
    if let [only] = objects
        && only.groups.iter().any(|group| group.name != only.groups[0].name)
    {
        let mut ids = HashMap::new();
        for group in &only.groups {
            let name = group.name.as_ref().unwrap_or(&nameless);
            let id = *ids.entry(name).or_insert_with(|| {
                names.push(name.clone());
                names.len() as u32 - 1
            });
            face_objects[group.faces.clone()].fill(id);
        }
        return (names, face_objects);
    }
    for object in objects {
        for group in &object.groups {
            face_objects[group.faces.clone()].fill(names.len() as u32);
        }
        let lone_group = objects.len() == 1;
        let group_name = object.groups[0].name.as_ref().filter(|_| lone_group);
        names.push(object.name.as_ref().or(group_name).unwrap_or(&nameless).clone());
    }
    (names, face_objects)
}
