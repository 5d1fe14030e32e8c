//! Why a text is no CityJSON, and where.

use crate::format::escaped;

/// Why a text is no CityJSON, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct CityJsonError {
    /// Counted from 1; 0 where the whole is meant.
    pub line: usize,
    /// In bytes, counted from 1.
    pub column: usize,
    /// Id of the city object it concerns.
    pub object: Option<String>,
    pub problem: CityJsonProblem,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CityJsonProblem {
    #[error("the file is cut off: {}; get it again", escaped(message))]
    CutOff { message: String },
    #[error("the JSON is broken: {}", escaped(message))]
    Json { message: String },
    #[error("the text is not UTF-8; save it as UTF-8")]
    NotUtf8,
    #[error("CityJSON version {}, expected 1.0, 1.1 or 2.0; convert the file (cjio upgrade)", escaped(found))]
    Version { found: String },
    #[error("the JSON is of type {}, expected {expected}", escaped(found))]
    Type { found: String, expected: &'static str },
    #[error(
        "a CityJSONFeature without the header line before it (type CityJSON), which has the transform of its vertices; put the \
         first line of the whole file in front"
    )]
    NoHeader,
    #[error("{what} is missing")]
    Missing { what: &'static str },
    #[error("index {index} points outside the {count} {what}")]
    IndexOutOfRange { what: &'static str, index: String, count: usize },
    #[error("`{}` is no index, expected a whole number from 0 on", escaped(found))]
    NotAnIndex { found: String },
    #[error("{what}: `{}` at nesting depth {depth}, expected {expected} at depth {level}", escaped(found))]
    Nesting { what: &'static str, found: String, depth: usize, expected: &'static str, level: usize },
    #[error("coordinate `{}` is not a finite number within {limit:e} m of zero", escaped(found))]
    OutOfReach { found: String, limit: f64 },
    #[error("the transform's {what} is [{}, {}, {}], expected finite numbers{}", values[0], values[1], values[2], expected)]
    Transform { what: &'static str, values: [f64; 3], expected: &'static str },
    #[error(
        "the matrix of a GeometryInstance has {found}, expected 16 finite numbers, row by row, the last row 0 0 0 1"
    )]
    Matrix { found: String },
    #[error(
        "more than {limit} corners when every template stands at its places, too many for {bytes} bytes; split the file"
    )]
    TooLarge { limit: usize, bytes: usize },
    #[error("more than 4 billion corners or vertices; split the file")]
    TooMany,
}

/// An error on its way out: where it stands is a byte of the text.
#[derive(Clone, Debug)]
pub(super) struct Fault {
    pub byte: usize,
    pub object: Option<String>,
    pub problem: CityJsonProblem,
}

impl Fault {
    pub fn at(byte: usize, problem: CityJsonProblem) -> Fault {
        Fault { byte, object: None, problem }
    }

    /// Names the object where none is named yet.
    pub fn of(self, object: &str) -> Fault {
        Fault { object: self.object.or_else(|| Some(object.to_owned())), ..self }
    }

    /// What `serde_json` says of a part that begins at `byte` of the text.
    pub fn json(byte: usize, part: &str, error: &serde_json::Error) -> Fault {
        let before: usize = part.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        let place = byte + (before + error.column().saturating_sub(1)).min(part.len());
        let message = error.to_string();
        // The place is told by the line and column of the whole file.
        let message = message.split(" at line ").next().unwrap_or_default().to_owned();
        let problem =
            if error.is_eof() { CityJsonProblem::CutOff { message } } else { CityJsonProblem::Json { message } };
        Fault::at(place, problem)
    }

    /// The error with the line and column of its place.
    pub fn in_text(self, text: &[u8]) -> CityJsonError {
        let before = &text[..self.byte.min(text.len())];
        let line_start = memchr::memrchr(b'\n', before).map_or(0, |at| at + 1);
        let line = 1 + memchr::memchr_iter(b'\n', before).count();
        CityJsonError { line, column: 1 + before.len() - line_start, object: self.object, problem: self.problem }
    }
}

/// Where a part of the text begins, in bytes.
pub(super) fn place_of(text: &str, part: &str) -> usize {
    (part.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize)
}
