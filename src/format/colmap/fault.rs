//! What is wrong at one place of a file.

/// What was wrong in a file; the reader of the whole file adds its path and, for text, the line.
#[derive(Debug)]
pub(super) enum Fault {
    Unreadable(std::io::Error),
    /// Text of 16 bits a character.
    Utf16,
    Malformed {
        at: u64,
        object: String,
        expected: String,
        got: String,
    },
}

impl Fault {
    pub fn malformed(at: u64, object: impl Into<String>, expected: impl Into<String>, got: impl Into<String>) -> Fault {
        Fault::Malformed { at, object: object.into(), expected: expected.into(), got: got.into() }
    }
}
