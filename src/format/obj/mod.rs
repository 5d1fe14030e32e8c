//! Wavefront OBJ: polygons with their objects and groups, positions in f64.
//!
//! The `obj` crate reads faces, objects and groups; it keeps positions in f32, loses faces on nameless groups and
//! accepts what is no mesh. So a [guard](guard) stands before it: it reads the lines, keeps the positions itself, hands
//! on only what the crate reads well, and remembers on which line everything stood.

mod guard;
mod write;

use std::ops::Range;

use guard::ObjGuard;
pub use write::write_obj;

/// What an OBJ file holds that is a mesh. Materials, texture coordinates and normals are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    pub positions: Vec<[f64; 3]>,
    /// What stands under each `o` line that has faces, in file order.
    pub objects: Vec<ObjObject>,
    /// Position indices of all faces, one face after the other.
    pub corners: Vec<u32>,
    /// End of each face in `corners`; a face starts where the one before it ends.
    pub face_ends: Vec<u32>,
    /// Line of each face, counted from 1.
    pub face_lines: Vec<u32>,
    pub oddities: ObjOddities,
}

/// The faces under one `o` line, or before the first.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjObject {
    /// `None` before the first `o` line, or where it has no name.
    pub name: Option<String>,
    /// In file order; the same name may come back.
    pub groups: Vec<ObjGroup>,
}

/// A run of faces under one `g` line, or before the first of the object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjGroup {
    /// `None` before the first `g` line, or where it has no name.
    pub name: Option<String>,
    /// Indices into `face_ends`.
    pub faces: Range<usize>,
}

/// What was passed over, and the line where each first happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjOddities {
    /// `f` lines with fewer than three corners.
    pub short_faces: LineTally,
    /// Lines that begin with a word OBJ does not know.
    pub unknown_lines: LineTally,
    /// Free-form curves and surfaces (`curv`, `surf`), which have no polygons.
    pub free_forms: LineTally,
}

/// How many lines, and the first of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineTally {
    pub count: u64,
    /// Counted from 1; 0 where the count is 0.
    pub first_line: u32,
}

impl LineTally {
    fn add(&mut self, line: u32) {
        self.first_line = if self.count == 0 { line } else { self.first_line };
        self.count += 1;
    }
}

/// Why a text is no OBJ mesh, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct ObjError {
    /// Counted from 1.
    pub line: u32,
    /// The last `o` or `g` name before the line.
    pub object: Option<String>,
    pub problem: ObjProblem,
}

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ObjProblem {
    #[error("a vertex has {found} coordinates, expected `v x y z`")]
    TooFewCoordinates { found: usize },
    #[error("vertex coordinate `{token}` is not a number, expected `v x y z` with decimal points")]
    NotANumber { token: String },
    #[error(
        "vertex coordinate `{token}` is not a finite number within {limit:e} m of zero; remove or repair the vertex"
    )]
    OutOfReach { token: String, limit: f64 },
    #[error("face index {index} points outside the file, which has {vertices} vertices; indices count from 1")]
    IndexOutOfRange { index: i64, vertices: usize },
    #[error("face index 0 means nothing, indices count from 1 (or from -1 backwards)")]
    ZeroIndex,
    #[error("face corner `{token}` is not an index, expected `f v/vt/vn ...` with whole numbers")]
    NotAnIndex { token: String },
    #[error("more than {limit} lines, vertices or face corners; split the file")]
    TooMany { limit: u32 },
    #[error("the OBJ reader stopped: {message}")]
    Reader { message: String },
}

/// Reads OBJ text that is wholly in memory.
///
/// Takes a byte order mark, Latin-1 names, any of the three line ends, continued lines, negative indices and trailing
/// comments. Indices may point forward, as long as the vertex comes at all.
pub fn read_obj(text: &[u8]) -> Result<ObjFile, ObjError> {
    let mut guard = ObjGuard::new(text);
    let parsed = obj::ObjData::load_buf_with_config(&mut guard, obj::LoadConfig { strict: false });
    if let Some(failure) = guard.failure.take() {
        return Err(failure);
    }
    let data = parsed.map_err(|error| guard.place(error))?;
    let mut file = ObjFile {
        positions: std::mem::take(&mut guard.positions),
        face_lines: std::mem::take(&mut guard.face_lines),
        oddities: guard.oddities,
        ..ObjFile::default()
    };
    take_faces(&mut file, data)?;
    check_indices(&file)?;
    Ok(file)
}

/// Flattens the crate's objects, groups and polygons; their order is the order of the lines.
fn take_faces(file: &mut ObjFile, data: obj::ObjData) -> Result<(), ObjError> {
    file.face_ends.reserve(file.face_lines.len());
    for object in data.objects {
        let mut groups = Vec::new();
        for group in object.groups {
            let first = file.face_ends.len();
            for polygon in group.polys {
                // An index beyond u32 is certainly out of range, and is found so by the check that follows.
                file.corners.extend(polygon.0.iter().map(|corner| u32::try_from(corner.0).unwrap_or(u32::MAX)));
                file.face_ends.push(u32::try_from(file.corners.len()).map_err(|_| too_many(file))?);
            }
            let faces = first..file.face_ends.len();
            if !faces.is_empty() {
                groups.push(ObjGroup { name: named(&group.name), faces });
            }
        }
        if !groups.is_empty() {
            file.objects.push(ObjObject { name: named(&object.name), groups });
        }
    }
    if file.face_ends.len() != file.face_lines.len() {
        let message = format!("{} of {} faces came back", file.face_ends.len(), file.face_lines.len());
        return Err(ObjError { line: 0, object: None, problem: ObjProblem::Reader { message } });
    }
    Ok(())
}

fn check_indices(file: &ObjFile) -> Result<(), ObjError> {
    let vertices = file.positions.len();
    let Some(at) = file.corners.iter().position(|&corner| corner as usize >= vertices) else {
        return Ok(());
    };
    let face = file.face_ends.partition_point(|&end| end as usize <= at);
    let object = file.objects.iter().find(|object| object.groups.iter().any(|group| group.faces.contains(&face)));
    let object = object.and_then(|object| object.name.clone());
    let problem = ObjProblem::IndexOutOfRange { index: i64::from(file.corners[at]) + 1, vertices };
    Err(ObjError { line: file.face_lines[face], object, problem })
}

fn too_many(file: &ObjFile) -> ObjError {
    let line = file.face_lines.last().copied().unwrap_or(0);
    ObjError { line, object: None, problem: ObjProblem::TooMany { limit: u32::MAX } }
}

/// The crate calls "default" what has no name, and the guard does so for it.
fn named(name: &str) -> Option<String> {
    (name != guard::NAMELESS).then(|| name.to_owned())
}
