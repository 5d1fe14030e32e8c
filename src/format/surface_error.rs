//! Why a file of surfaces cannot be read, in one shape for all formats of such files.

use std::fmt;
use std::path::{Path, PathBuf};

use super::escape::escaped;

/// What is wrong (with what was expected and what to do), where, and of which object.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", escaped(problem))]
pub struct SurfaceError {
    /// The file that it is about, where that is another than the one that was asked for.
    pub path: Option<PathBuf>,
    pub place: Place,
    /// Identifier of the object within which it was met.
    pub object: Option<String>,
    pub problem: String,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The whole file.
    Whole,
    /// A text's line, from 1, and byte, from 0. What was met lies there or a little before.
    Line {
        line: u64,
        byte: u64,
    },
    Byte(u64),
    /// A row of a table or a record, from 1.
    Record(u64),
    /// Members of a JSON text, such as `root.children[2]`, or what the format calls a part.
    Part(String),
}

impl SurfaceError {
    pub(super) fn at(place: Place, problem: impl Into<String>) -> SurfaceError {
        SurfaceError { path: None, place, object: None, problem: problem.into() }
    }

    pub(super) fn whole(problem: impl Into<String>) -> SurfaceError {
        SurfaceError::at(Place::Whole, problem)
    }

    /// Names the file where none is named yet.
    pub(super) fn in_file(self, path: &Path) -> SurfaceError {
        SurfaceError { path: self.path.or_else(|| Some(path.to_owned())), ..self }
    }

    /// Names the object where none is named yet.
    pub(super) fn of(self, object: Option<String>) -> SurfaceError {
        SurfaceError { object: self.object.or(object), ..self }
    }

    /// Object, place and file in words, for the end of a message; `path` is the file that was asked for.
    pub fn place_in(&self, path: &Path) -> String {
        let object = self.object.as_ref().map_or(String::new(), |object| format!("object {}, ", escaped(object)));
        let path = self.path.as_deref().unwrap_or(path).display().to_string();
        match &self.place {
            Place::Whole => format!("{object}{}", escaped(&path)),
            place => format!("{object}{place}, {}", escaped(&path)),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Whole => f.write_str("the whole file"),
            Place::Line { line, byte } => write!(f, "line {line} (byte {byte})"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
            Place::Record(record) => write!(f, "record {record}"),
            Place::Part(part) => write!(f, "{}", escaped(part)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_names_object_line_and_file() {
        let error = SurfaceError::at(Place::Line { line: 3, byte: 70 }, "x").of(Some("house\u{1b}".to_owned()));
        assert_eq!(error.place_in(Path::new("a.gml")), "object house\\u{1b}, line 3 (byte 70), a.gml");
        let error = error.of(Some("other".to_owned())).in_file(Path::new("b.gml")).in_file(Path::new("c.gml"));
        assert_eq!(error.place_in(Path::new("a.gml")), "object house\\u{1b}, line 3 (byte 70), b.gml");
        assert_eq!(SurfaceError::whole("y\n").to_string(), format!("{}", escaped("y\n")));
    }
}
