//! Pieces to one file.

use super::guard::{CONTINUED, RELATIVE};
use super::piece::{Piece, Run};
use super::{ObjError, ObjFile, ObjGroup, ObjObject, ObjProblem};

/// The file as far as it is joined, and under which names its next faces stand.
pub(super) struct Joined {
    file: ObjFile,
    lines: u32,
    /// Names of all `o` lines so far; the first is what comes before any.
    objects: Vec<Option<String>>,
    groups: Vec<Option<String>>,
    open_object: usize,
    /// `None` after an `o` line without a `g` line.
    open_group: Option<usize>,
    last_run: Option<(usize, Option<usize>)>,
}

impl Joined {
    pub fn new() -> Joined {
        Joined {
            file: ObjFile::default(),
            lines: 0,
            objects: vec![None],
            groups: vec![None],
            open_object: 0,
            open_group: None,
            last_run: None,
        }
    }

    pub fn add(&mut self, piece: Result<Piece, ObjError>) -> Result<(), ObjError> {
        let mut piece = piece.map_err(|error| self.in_file(error))?;
        self.add_faces(&piece)?;
        self.add_runs(&mut piece);
        self.file.positions.append(&mut piece.positions);
        self.file.oddities.append(&piece.oddities, self.lines);
        self.lines = self.lines.checked_add(piece.lines).ok_or_else(|| self.too_many())?;
        Ok(())
    }

    /// The file, when every index has found its vertex.
    pub fn finish(self) -> Result<ObjFile, ObjError> {
        let vertices = self.file.positions.len();
        if u32::try_from(vertices).is_err() {
            return Err(self.too_many());
        }
        let Some(at) = self.file.corners.iter().position(|&corner| corner as usize >= vertices) else {
            return Ok(self.file);
        };
        let face = self.file.face_ends.partition_point(|&end| end as usize <= at);
        let mut objects = self.file.objects.iter();
        let object = objects.find(|object| object.groups.iter().any(|group| group.faces.contains(&face)));
        let problem = ObjProblem::IndexOutOfRange { index: u64::from(self.file.corners[at]) + 1, vertices };
        let object = object.and_then(|object| object.groups[0].name.clone().or(object.name.clone()));
        Err(ObjError { line: self.file.face_lines[face], object, problem })
    }

    fn add_faces(&mut self, piece: &Piece) -> Result<(), ObjError> {
        let vertices_above = self.file.positions.len() as i64;
        let mut indices = piece.corners.iter();
        for (&size, &line) in piece.face_sizes.iter().zip(&piece.face_lines) {
            for &index in indices.by_ref().take(size as usize) {
                // The middle, because a relative index may count back to before the piece.
                let index = if index < RELATIVE / 2 { index } else { index - RELATIVE + vertices_above };
                if index < 0 {
                    return Err(self.in_file(ObjError { line, object: None, problem: ObjProblem::BeforeFirst }));
                }
                // Beyond u32 is out of range of any file that `finish` lets pass, as is the largest u32.
                self.file.corners.push(u32::try_from(index).unwrap_or(u32::MAX));
            }
            let end = u32::try_from(self.file.corners.len()).map_err(|_| self.too_many())?;
            self.file.face_ends.push(end);
            self.file.face_lines.push(self.lines.saturating_add(line));
        }
        Ok(())
    }

    fn add_runs(&mut self, piece: &mut Piece) {
        let (objects_before, groups_before) = (self.objects.len() - 1, self.groups.len() - 1);
        let (open_object, open_group) = (self.open_object, self.open_group);
        let object_of = |id: usize| if id == CONTINUED { open_object } else { objects_before + id };
        let group_of =
            |id: Option<usize>| id.and_then(|id| if id == CONTINUED { open_group } else { Some(groups_before + id) });
        self.objects.extend(piece.objects.drain(1..));
        self.groups.extend(piece.groups.drain(1..));
        let mut face = self.file.face_ends.len() - piece.face_sizes.len();
        for &Run { object, group, faces } in &piece.runs {
            self.add_run(object_of(object), group_of(group), face..face + faces);
            face += faces;
        }
        self.open_object = object_of(piece.last_object);
        self.open_group = group_of(piece.last_group);
    }

    /// Goes on with the last object and group where these are the same lines.
    fn add_run(&mut self, object: usize, group: Option<usize>, faces: std::ops::Range<usize>) {
        let last = self.last_run.replace((object, group));
        if last.is_none_or(|(last_object, _)| last_object != object) {
            self.file.objects.push(ObjObject { name: self.objects[object].clone(), groups: Vec::new() });
        }
        let Some(open) = self.file.objects.last_mut() else { return };
        match open.groups.last_mut() {
            Some(open) if last == Some((object, group)) => open.faces.end = faces.end,
            _ => {
                let name = group.and_then(|group| self.groups[group].clone());
                open.groups.push(ObjGroup { name, faces });
            }
        }
    }

    /// Counts an error's line from the start of the file, and names the object that reaches in from above.
    fn in_file(&self, error: ObjError) -> ObjError {
        let open = || self.open_group.and_then(|group| self.groups[group].clone());
        let object = error.object.or_else(open).or_else(|| self.objects[self.open_object].clone());
        ObjError { line: self.lines.saturating_add(error.line), object, problem: error.problem }
    }

    fn too_many(&self) -> ObjError {
        ObjError { line: self.lines, object: None, problem: ObjProblem::TooMany }
    }
}
