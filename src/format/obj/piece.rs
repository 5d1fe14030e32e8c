//! A run of lines, read by itself.

use super::guard::{ObjGuard, is_free_text};
use super::{ObjError, ObjOddities, ObjProblem};

/// Large enough that joining is nothing beside reading, small enough to keep every thread busy.
const PIECE_BYTES: usize = 1 << 20;

/// What a run of lines holds. Line numbers count from 1 within the piece.
pub(super) struct Piece {
    pub lines: u32,
    pub positions: Vec<[f64; 3]>,
    pub runs: Vec<Run>,
    /// Position indices from 0; `RELATIVE` and more count from the piece's first vertex.
    pub corners: Vec<i64>,
    /// Number of corners of each face.
    pub face_sizes: Vec<u32>,
    pub face_lines: Vec<u32>,
    /// Names of `o` lines; the first stands for the object that the piece before ended in.
    pub objects: Vec<Option<String>>,
    /// Names of `g` lines, likewise.
    pub groups: Vec<Option<String>>,
    /// The object and group that the next piece begins in.
    pub last_object: usize,
    pub last_group: Option<usize>,
    pub oddities: ObjOddities,
}

/// Faces under one `o` and one `g` line of the piece.
pub(super) struct Run {
    /// Index into `Piece::objects`.
    pub object: usize,
    /// Index into `Piece::groups`; `None` after an `o` line without a `g` line.
    pub group: Option<usize>,
    pub faces: usize,
}

/// Cuts text where lines end, but not where a line goes on.
pub(super) fn pieces(text: &[u8], line_end: u8) -> Vec<&[u8]> {
    let mut pieces = Vec::with_capacity(text.len() / PIECE_BYTES + 1);
    let mut start = 0;
    while start < text.len() {
        let mut end = start + PIECE_BYTES;
        loop {
            end = match text.get(end..).and_then(|rest| memchr::memchr(line_end, rest)) {
                Some(at) => end + at + 1,
                None => text.len(),
            };
            if end == text.len() || !goes_on(&text[start..end - 1], line_end) {
                break;
            }
        }
        pieces.push(&text[start..end]);
        start = end;
    }
    pieces
}

/// Whether the last of these lines continues on the next.
fn goes_on(lines: &[u8], line_end: u8) -> bool {
    let lines = lines.strip_suffix(b"\r").unwrap_or(lines);
    let last = &lines[memchr::memrchr(line_end, lines).map_or(0, |at| at + 1)..];
    last.ends_with(b"\\") && !is_free_text(last)
}

pub(super) fn read_piece(piece: &[u8], line_end: u8) -> Result<Piece, ObjError> {
    let mut guard = ObjGuard::new(piece, line_end);
    let parsed = obj::ObjData::load_buf_with_config(&mut guard, obj::LoadConfig { strict: false });
    if let Some(failure) = guard.failure.take() {
        return Err(failure);
    }
    let data = parsed.map_err(|error| guard.place(error))?;
    let mut piece = Piece {
        lines: guard.lines,
        positions: guard.positions,
        runs: Vec::new(),
        corners: Vec::with_capacity(4 * guard.face_lines.len()),
        face_sizes: Vec::with_capacity(guard.face_lines.len()),
        face_lines: guard.face_lines,
        last_object: guard.objects.len() - 1,
        objects: guard.objects,
        groups: guard.groups,
        last_group: guard.last_group,
        oddities: guard.oddities,
    };
    take_faces(&mut piece, data)?;
    Ok(piece)
}

/// Flattens the crate's objects, groups and polygons, whose order is the order of the lines.
fn take_faces(piece: &mut Piece, data: obj::ObjData) -> Result<(), ObjError> {
    for object in data.objects {
        for group in object.groups {
            for polygon in &group.polys {
                piece.corners.extend(polygon.0.iter().map(|corner| corner.0 as i64));
                piece.face_sizes.push(polygon.0.len() as u32);
            }
            // The guard gives numbers for names; the crate says "default" where it made a group itself.
            let (object, group, faces) = (object.name.parse().unwrap_or(0), group.name.parse().ok(), group.polys.len());
            piece.runs.extend((faces > 0).then_some(Run { object, group, faces }));
        }
    }
    if piece.face_sizes.len() == piece.face_lines.len() {
        return Ok(());
    }
    let message = format!("{} of {} faces came back", piece.face_sizes.len(), piece.face_lines.len());
    Err(ObjError { line: piece.lines, object: None, problem: ObjProblem::Reader { message } })
}
