//! The line reader that stands before the `obj` crate.

use std::borrow::Cow;
use std::io::{self, Read};

use super::{ObjError, ObjOddities, ObjProblem};

/// What the `obj` crate calls an object or a group without a name.
pub(super) const NAMELESS: &str = "default";

/// Metres. The Earth fits in a thousand times over; beyond it, squares of coordinates would lose what areas need.
const COORDINATE_LIMIT: f64 = 1e9;

/// The crate asks for 8 KiB at a time; a batch of this size keeps the copying cheap.
const BATCH_BYTES: usize = 1 << 16;

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

/// Reads lines, keeps the positions, and hands the crate nothing but clean `f`, `g` and `o` lines.
///
/// Vertices are not handed on: negative indices are made positive here, and the range is checked when all is read. So
/// the crate neither counts vertices nor parses numbers that it would round to f32.
pub(super) struct ObjGuard<'a> {
    rest: &'a [u8],
    line_end: u8,
    /// Number of the line that `rest` begins with, from 1.
    line: u32,
    clean: Vec<u8>,
    taken: usize,
    /// Source line of each line that was handed on.
    clean_lines: Vec<u32>,
    name: Option<String>,
    pub positions: Vec<[f64; 3]>,
    pub face_lines: Vec<u32>,
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
    pub fn new(text: &'a [u8]) -> ObjGuard<'a> {
        let rest = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
        // Old Macintosh files end lines with a carriage return alone.
        let line_end = if rest.contains(&b'\n') { b'\n' } else { b'\r' };
        ObjGuard {
            rest,
            line_end,
            line: 1,
            clean: Vec::with_capacity(2 * BATCH_BYTES),
            taken: 0,
            clean_lines: Vec::new(),
            name: None,
            positions: Vec::new(),
            face_lines: Vec::new(),
            oddities: ObjOddities::default(),
            failure: None,
        }
    }

    /// Gives an error of the crate its line in the source.
    pub fn place(&self, error: obj::ObjError) -> ObjError {
        let source_line = |clean_line: usize| self.clean_lines.get(clean_line).copied().unwrap_or(0);
        let (line, problem) = match error {
            obj::ObjError::ZeroVertexNumber { line_number } => (source_line(line_number), ObjProblem::ZeroIndex),
            obj::ObjError::MalformedFaceGroup { line_number, group } => {
                (source_line(line_number), ObjProblem::NotAnIndex { token: group })
            }
            other => (self.line, ObjProblem::Reader { message: other.to_string() }),
        };
        ObjError { line, object: self.name.clone(), problem }
    }

    /// Reads lines until a batch is full or the text ends.
    fn fill(&mut self) -> Result<(), ObjError> {
        while self.clean.len() < BATCH_BYTES && !self.rest.is_empty() {
            let first_line = self.line;
            let line = self.next_line()?;
            self.take_line(&line, first_line).map_err(|problem| ObjError {
                line: first_line,
                object: self.name.clone(),
                problem,
            })?;
        }
        Ok(())
    }

    /// The next line without its end; lines that end with a backslash are joined with the next.
    fn next_line(&mut self) -> Result<Cow<'a, [u8]>, ObjError> {
        let line = self.next_physical_line()?;
        // A comment or a path may end with a backslash and mean nothing by it.
        let continues = |line: &[u8]| line.ends_with(b"\\") && !is_free_text(line);
        if !continues(line) {
            return Ok(Cow::Borrowed(line));
        }
        let mut joined = line[..line.len() - 1].to_vec();
        while !self.rest.is_empty() {
            let line = self.next_physical_line()?;
            joined.push(b' ');
            joined.extend_from_slice(line.strip_suffix(b"\\").unwrap_or(line));
            if !line.ends_with(b"\\") {
                break;
            }
        }
        Ok(Cow::Owned(joined))
    }

    fn next_physical_line(&mut self) -> Result<&'a [u8], ObjError> {
        let end = self.rest.iter().position(|&byte| byte == self.line_end).unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or(&[]);
        self.line = self.line.checked_add(1).ok_or_else(|| ObjError {
            line: u32::MAX,
            object: None,
            problem: ObjProblem::TooMany { limit: u32::MAX },
        })?;
        Ok(line.strip_suffix(b"\r").unwrap_or(line))
    }

    fn take_line(&mut self, line: &[u8], number: u32) -> Result<(), ObjProblem> {
        let mut words = words(line);
        match words.next() {
            None => {}
            Some(b"v") => self.positions.push(position(words)?),
            Some(b"f") => self.take_face(words, number)?,
            Some(word) if word.starts_with(b"#") => {}
            Some(word @ (b"g" | b"o")) => self.take_name(word[0], line, number),
            Some(b"fo") => self.take_face(words, number)?,
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
        for word in words.take_while(|word| !word.starts_with(b"#")) {
            let index = word.split(|&byte| byte == b'/').next().unwrap_or(word);
            self.clean.push(b' ');
            if index.starts_with(b"-") {
                let absolute = self.absolute(index)?;
                self.clean.extend_from_slice(absolute.to_string().as_bytes());
            } else if !index.is_empty() && index.is_ascii() {
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

    /// A negative index counts back from the last vertex above the face.
    fn absolute(&self, index: &[u8]) -> Result<i64, ObjProblem> {
        let token = String::from_utf8_lossy(index);
        let index: i64 = token.parse().map_err(|_| ObjProblem::NotAnIndex { token: token.to_string() })?;
        let vertices = self.positions.len();
        let absolute = vertices as i64 + 1 + index;
        if index == 0 {
            Err(ObjProblem::ZeroIndex)
        } else if absolute < 1 {
            Err(ObjProblem::IndexOutOfRange { index, vertices })
        } else {
            Ok(absolute)
        }
    }

    /// Hands on `o` or `g` with its name; the crate would lose an object on a `g` without one.
    fn take_name(&mut self, keyword: u8, line: &[u8], number: u32) {
        let text = decoded(line);
        let name = text.split_whitespace().skip(1).collect::<Vec<_>>().join(" ");
        let handed = if name.is_empty() { NAMELESS } else { &name };
        self.clean.extend_from_slice(&[keyword, b' ']);
        self.clean.extend_from_slice(handed.as_bytes());
        self.clean.push(b'\n');
        self.clean_lines.push(number);
        self.name = (!name.is_empty()).then_some(name);
    }

    /// A keyword may be parted from its name by a space that is none in ASCII.
    fn take_odd_line(&mut self, line: &[u8], number: u32) {
        match decoded(line).split_whitespace().next() {
            Some("o") => self.take_name(b'o', line, number),
            Some("g") => self.take_name(b'g', line, number),
            _ => self.oddities.unknown_lines.add(number),
        }
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| matches!(byte, b' ' | b'\t' | b'\x0b' | b'\x0c' | b'\r')).filter(|word| !word.is_empty())
}

/// Lines whose end is a name, a path or a remark.
fn is_free_text(line: &[u8]) -> bool {
    words(line).next().is_some_and(|word| word.starts_with(b"#") || matches!(word, b"mtllib" | b"usemtl" | b"usemap"))
}

fn position<'w>(words: impl Iterator<Item = &'w [u8]>) -> Result<[f64; 3], ObjProblem> {
    let mut position = [0.0; 3];
    let mut found = 0;
    for (slot, word) in position.iter_mut().zip(words.take_while(|word| !word.starts_with(b"#"))) {
        *slot = coordinate(word)?;
        found += 1;
    }
    if found < 3 { Err(ObjProblem::TooFewCoordinates { found }) } else { Ok(position) }
}

fn coordinate(word: &[u8]) -> Result<f64, ObjProblem> {
    let token = || String::from_utf8_lossy(word).into_owned();
    let value: Option<f64> = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    match value {
        Some(value) if value.abs() <= COORDINATE_LIMIT => Ok(value),
        Some(_) => Err(ObjProblem::OutOfReach { token: token(), limit: COORDINATE_LIMIT }),
        None => Err(ObjProblem::NotANumber { token: token() }),
    }
}

/// UTF-8, or Latin-1 where it is not.
fn decoded(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(line.iter().map(|&byte| char::from(byte)).collect()),
    }
}
