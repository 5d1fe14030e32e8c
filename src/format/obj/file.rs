//! An OBJ file as objects with faces.

use std::ops::Range;

use rayon::prelude::*;

use super::join::Joined;
use super::piece::{pieces, read_piece};

/// What an OBJ file holds that is a mesh. Materials, texture coordinates and normals are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    /// Finite but for those that `oddities` counts as lost.
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
    /// Vertices that are not finite, or out of reach; they stand as NaN.
    pub lost_vertices: LineTally,
    /// Lines that begin with a word OBJ does not know.
    pub unknown_lines: LineTally,
    /// Free-form curves and surfaces (`curv`, `surf`), which have no polygons.
    pub free_forms: LineTally,
}

impl ObjOddities {
    /// Takes in what follows after `lines_before` lines.
    pub(super) fn append(&mut self, later: &ObjOddities, lines_before: u32) {
        self.short_faces.append(later.short_faces, lines_before);
        self.lost_vertices.append(later.lost_vertices, lines_before);
        self.unknown_lines.append(later.unknown_lines, lines_before);
        self.free_forms.append(later.free_forms, lines_before);
    }
}

/// How many lines, and the first of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineTally {
    pub count: u64,
    /// Counted from 1; 0 where the count is 0.
    pub first_line: u32,
}

impl LineTally {
    pub(super) fn add(&mut self, line: u32) {
        self.first_line = if self.count == 0 { line } else { self.first_line };
        self.count += 1;
    }

    /// Takes in the tally of what follows after `lines_before` lines.
    pub(super) fn append(&mut self, later: LineTally, lines_before: u32) {
        if self.count == 0 && later.count > 0 {
            self.first_line = later.first_line.saturating_add(lines_before);
        }
        self.count += later.count;
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
    #[error("the file is cut off in the middle of its last line, `{line}`; get it again")]
    CutOff { line: String },
    #[error("face index {index} points outside the file, which has {vertices} vertices; indices count from 1")]
    IndexOutOfRange { index: u64, vertices: usize },
    #[error("a negative face index counts back past the first vertex of the file")]
    BeforeFirst,
    #[error("face index 0 means nothing, indices count from 1 (or from -1 backwards)")]
    ZeroIndex,
    #[error("face corner `{token}` is not an index, expected `f v/vt/vn ...` with whole numbers")]
    NotAnIndex { token: String },
    #[error("more than 4 billion vertices, face corners or lines; split the file")]
    TooMany,
    #[error("the OBJ reader stopped: {message}")]
    Reader { message: String },
}

/// Reads OBJ text that is wholly in memory.
///
/// Takes a byte order mark, Latin-1 names, any of the three line ends, continued lines, negative indices and trailing
/// comments. Indices may point forward, as long as the vertex comes at all. Pieces are read in parallel; where they are
/// cut depends on the text alone.
pub fn read_obj(text: &[u8]) -> Result<ObjFile, ObjError> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    // Old Macintosh files end lines with a carriage return alone.
    let line_end = if memchr::memchr(b'\n', text).is_some() { b'\n' } else { b'\r' };
    let pieces: Vec<_> = pieces(text, line_end).into_par_iter().map(|piece| read_piece(piece, line_end)).collect();
    let mut joined = Joined::new();
    for piece in pieces {
        joined.add(piece)?;
    }
    joined.finish()
}
