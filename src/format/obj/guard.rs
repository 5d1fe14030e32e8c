//! The line reader that stands before the `obj` crate.

use std::borrow::Cow;
use std::io::{self, Read};

use super::number::coordinate;
use super::{ObjError, ObjOddities, ObjProblem};

/// The name under which a piece's first lines go on with the object and group of the piece before.
pub(super) const CONTINUED: usize = 0;

/// Added to indices that count back from a vertex: how many vertices came before is known when all pieces are read.
/// Out of reach of honest indices, which fit in 32 bits.
pub(super) const RELATIVE: i64 = 1 << 48;

/// The crate asks for 8 KiB at a time; a batch of this size keeps the copying cheap.
const BATCH_BYTES: usize = 1 << 15;

/// Words that begin a line in OBJ and hold nothing that is read here.
const PASSED_OVER: [&[u8]; 30] = [
    b"vt",
    b"vn",
    b"vp",
    b"l",
    b"p",
    b"s",
    b"mg",
    b"usemtl",
    b"mtllib",
    b"usemap",
    b"maplib",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
];

/// Reads the lines of one piece, keeps positions and names, and hands the crate clean `f`, `o` and `g` lines alone.
///
/// Vertices are not handed on, so the crate neither counts them nor rounds them to f32; in place of names go numbers,
/// so it meets none that it cannot split.
pub(super) struct ObjGuard<'a> {
    rest: &'a [u8],
    line_end: u8,
    /// Whether the line that was read last has its end; only the file's last may lack it.
    is_ended: bool,
    clean: Vec<u8>,
    taken: usize,
    /// Line of each line that was handed on.
    clean_lines: Vec<u32>,
    /// Lines read so far; line numbers count from 1 within the piece.
    pub lines: u32,
    pub positions: Vec<[f64; 3]>,
    /// Line of each face.
    pub face_lines: Vec<u32>,
    /// Names of `o` lines; the first stands for whatever the piece before ended with.
    pub objects: Vec<Option<String>>,
    /// Names of `g` lines, likewise.
    pub groups: Vec<Option<String>>,
    /// Index of the last `g` line, unless an `o` line came after it.
    pub last_group: Option<usize>,
    pub oddities: ObjOddities,
    pub failure: Option<ObjError>,
}

impl Read for ObjGuard<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.taken == self.clean.len() {
            self.clean.clear();
            self.taken = 0;
            if let Err(failure) = self.fill() {
                self.failure = Some(failure);
                return Err(io::Error::from(io::ErrorKind::InvalidData));
            }
        }
        let count = into.len().min(self.clean.len() - self.taken);
        into[..count].copy_from_slice(&self.clean[self.taken..self.taken + count]);
        self.taken += count;
        Ok(count)
    }
}

impl<'a> ObjGuard<'a> {
    pub fn new(piece: &'a [u8], line_end: u8) -> ObjGuard<'a> {
        ObjGuard {
            rest: piece,
            line_end,
            is_ended: true,
            clean: format!("o {CONTINUED}\ng {CONTINUED}\n").into_bytes(),
            taken: 0,
            clean_lines: vec![0, 0],
            lines: 0,
            positions: Vec::new(),
            face_lines: Vec::new(),
            objects: vec![None],
            groups: vec![None],
            last_group: Some(CONTINUED),
            oddities: ObjOddities::default(),
            failure: None,
        }
    }

    /// Gives an error of the crate its line.
    pub fn place(&self, error: obj::ObjError) -> ObjError {
        let source_line = |clean_line: usize| self.clean_lines.get(clean_line).copied().unwrap_or(0);
        let (line, problem) = match error {
            obj::ObjError::ZeroVertexNumber { line_number } => (source_line(line_number), ObjProblem::ZeroIndex),
            obj::ObjError::MalformedFaceGroup { line_number, group } => {
                (source_line(line_number), ObjProblem::NotAnIndex { token: group })
            }
            other => (self.lines, ObjProblem::Reader { message: other.to_string() }),
        };
        ObjError { line, object: self.name(), problem }
    }

    fn name(&self) -> Option<String> {
        let group = self.last_group.and_then(|group| self.groups[group].clone());
        group.or_else(|| self.objects.last().cloned().flatten())
    }

    /// Reads lines until a batch is full or the piece ends.
    fn fill(&mut self) -> Result<(), ObjError> {
        while self.clean.len() < BATCH_BYTES && !self.rest.is_empty() {
            let number = self.lines + 1;
            let line = self.next_line();
            let whole = if self.is_ended { Ok(()) } else { refuse_cut(&line) };
            if let Err(problem) = whole.and_then(|()| self.take_line(&line, number)) {
                return Err(ObjError { line: number, object: self.name(), problem });
            }
        }
        Ok(())
    }

    /// The next line without its end; lines that end with a backslash are joined with the next.
    fn next_line(&mut self) -> Cow<'a, [u8]> {
        let line = self.next_physical_line();
        // A remark or a path may end with a backslash and mean nothing by it.
        if !line.ends_with(b"\\") || is_free_text(line) {
            return Cow::Borrowed(line);
        }
        let mut joined = line[..line.len() - 1].to_vec();
        while !self.rest.is_empty() {
            let line = self.next_physical_line();
            joined.push(b' ');
            joined.extend_from_slice(line.strip_suffix(b"\\").unwrap_or(line));
            if !line.ends_with(b"\\") {
                break;
            }
        }
        Cow::Owned(joined)
    }

    fn next_physical_line(&mut self) -> &'a [u8] {
        let found = memchr::memchr(self.line_end, self.rest);
        self.is_ended = found.is_some();
        let end = found.unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or(&[]);
        self.lines += 1;
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    fn take_line(&mut self, line: &[u8], number: u32) -> Result<(), ObjProblem> {
        let mut words = words(line);
        match words.next() {
            None => {}
            Some(b"v") => {
                let position = position(words)?;
                if position.iter().any(|value| value.is_nan()) {
                    self.oddities.lost_vertices.add(number);
                }
                self.positions.push(position);
            }
            Some(b"f" | b"fo") => self.take_face(words, number)?,
            Some(b"o") => self.take_object(line, number),
            Some(b"g") => self.take_group(line, number),
            Some(word) if word.starts_with(b"#") => {}
            Some(b"curv" | b"curv2" | b"surf") => self.oddities.free_forms.add(number),
            Some(word) if PASSED_OVER.contains(&word) => {}
            Some(_) => self.take_odd_line(line, number),
        }
        Ok(())
    }

    /// Hands on `f` with positive position indices alone.
    fn take_face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>, number: u32) -> Result<(), ObjProblem> {
        let start = self.clean.len();
        self.clean.push(b'f');
        let mut corners = 0;
        for word in words.take_while(|word| word[0] != b'#') {
            let index = &word[..word.iter().position(|&byte| byte == b'/').unwrap_or(word.len())];
            self.clean.push(b' ');
            if index.first() == Some(&b'-') {
                let absolute = self.relative(index)?;
                self.clean.extend_from_slice(absolute.to_string().as_bytes());
            } else if !index.is_empty() && index.iter().all(u8::is_ascii_digit) && index.len() <= 10 {
                self.clean.extend_from_slice(index);
            } else {
                return Err(ObjProblem::NotAnIndex { token: String::from_utf8_lossy(word).into_owned() });
            }
            corners += 1;
        }
        if corners < 3 {
            self.clean.truncate(start);
            self.oddities.short_faces.add(number);
            return Ok(());
        }
        self.clean.push(b'\n');
        self.clean_lines.push(number);
        self.face_lines.push(number);
        Ok(())
    }

    /// A negative index counts back from the last vertex above the face, which may stand in an earlier piece.
    fn relative(&self, index: &[u8]) -> Result<i64, ObjProblem> {
        let token = String::from_utf8_lossy(index);
        match token.parse::<i64>() {
            Ok(0) => Err(ObjProblem::ZeroIndex),
            Ok(back) if back >= -i64::from(u32::MAX) => Ok(RELATIVE + self.positions.len() as i64 + 1 + back),
            _ => Err(ObjProblem::NotAnIndex { token: token.into_owned() }),
        }
    }

    fn take_object(&mut self, line: &[u8], number: u32) {
        self.hand_on_name(b'o', self.objects.len(), number);
        self.objects.push(name_of(line));
        self.last_group = None;
    }

    fn take_group(&mut self, line: &[u8], number: u32) {
        self.hand_on_name(b'g', self.groups.len(), number);
        self.last_group = Some(self.groups.len());
        self.groups.push(name_of(line));
    }

    fn hand_on_name(&mut self, keyword: u8, id: usize, number: u32) {
        self.clean.extend_from_slice(&[keyword, b' ']);
        self.clean.extend_from_slice(id.to_string().as_bytes());
        self.clean.push(b'\n');
        self.clean_lines.push(number);
    }

    /// A keyword may be parted from its name by a space that is none in ASCII.
    fn take_odd_line(&mut self, line: &[u8], number: u32) {
        match decoded(line).split_whitespace().next() {
            Some("o") => self.take_object(line, number),
            Some("g") => self.take_group(line, number),
            _ => self.oddities.unknown_lines.add(number),
        }
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| is_space(byte)).filter(|word| !word.is_empty())
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\x0b' | b'\x0c' | b'\r')
}

/// Lines whose end is a name, a path or a remark.
pub(super) fn is_free_text(line: &[u8]) -> bool {
    words(line).next().is_some_and(|word| word[0] == b'#' || matches!(word, b"mtllib" | b"usemtl" | b"usemap"))
}

/// Refuses a last line without an end that is plainly the beginning of one: too few corners or coordinates, a corner of another form
/// than the first (`f 1/2/3 4/5`), half a keyword. A number that lost its last digits looks like any other.
fn refuse_cut(line: &[u8]) -> Result<(), ObjProblem> {
    let mut words = words(line);
    let Some(keyword) = words.next() else { return Ok(()) };
    let rest: Vec<&[u8]> = words.take_while(|word| word[0] != b'#').collect();
    let form = |word: &&[u8]| {
        let texts = word.split(|byte| *byte == b'/').map(<[u8]>::is_empty);
        texts.collect::<Vec<bool>>()
    };
    let is_cut = match keyword {
        b"f" | b"fo" => rest.len() < 3 || rest.first().map(form) != rest.last().map(form),
        b"v" => rest.len() < 3,
        word => {
            let is_known = word.starts_with(b"#") || [&b"o"[..], b"g"].contains(&word) || PASSED_OVER.contains(&word);
            !is_known && rest.is_empty() && PASSED_OVER.iter().any(|known| known.starts_with(word))
        }
    };
    let line = || String::from_utf8_lossy(line).chars().take(SHOWN).collect();
    if is_cut { Err(ObjProblem::CutOff { line: line() }) } else { Ok(()) }
}

/// Letters of a line that a message shows.
const SHOWN: usize = 60;

fn position<'w>(words: impl Iterator<Item = &'w [u8]>) -> Result<[f64; 3], ObjProblem> {
    let mut position = [0.0; 3];
    let mut found = 0;
    for (slot, word) in position.iter_mut().zip(words.take_while(|word| word[0] != b'#')) {
        *slot = coordinate(word)?;
        found += 1;
    }
    if found < 3 { Err(ObjProblem::TooFewCoordinates { found }) } else { Ok(position) }
}

/// What stands after the keyword, in UTF-8, or Latin-1 where it is not.
fn name_of(line: &[u8]) -> Option<String> {
    let text = decoded(line);
    let mut words = text.split_whitespace().skip(1);
    let mut name = words.next()?.to_owned();
    for word in words {
        name.push(' ');
        name.push_str(word);
    }
    Some(name)
}

fn decoded(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(line.iter().map(|&byte| char::from(byte)).collect()),
    }
}
