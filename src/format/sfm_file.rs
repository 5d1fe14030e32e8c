//! What can be wrong with a file of a reconstruction that is not COLMAP's, and tokens of text with their places.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::file::{LARGEST_MODEL_BYTES, read_regular};

/// Why a file could not be read as what it is.
#[derive(Debug, thiserror::Error)]
pub enum SfmFileError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path}, {place}: expected {expected}, got {got}; write the file again as {format}")]
    Malformed { path: PathBuf, format: &'static str, place: String, expected: String, got: String },
}

/// What is wrong at one place; the reader of the file adds path and format.
#[derive(Debug)]
pub(super) struct Fault {
    pub place: String,
    pub expected: String,
    pub got: String,
}

/// Characters of a file that a message repeats at most.
const SHOWN_BYTES: usize = 40;

/// What editors put before text.
const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";

impl Fault {
    pub fn new(place: impl Into<String>, expected: impl Into<String>, got: impl Into<String>) -> Fault {
        Fault { place: place.into(), expected: expected.into(), got: got.into() }
    }

    pub fn in_file(self, path: &Path, format: &'static str) -> SfmFileError {
        let Fault { place, expected, got } = self;
        SfmFileError::Malformed { path: path.into(), format, place, expected, got }
    }
}

/// The bytes of a file, without the mark that some editors put first.
pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, SfmFileError> {
    let unreadable = |source| SfmFileError::Unreadable { path: path.into(), source };
    let mut bytes = read_regular(path, LARGEST_MODEL_BYTES).map_err(unreadable)?;
    if bytes.starts_with(UTF8_MARK) {
        bytes.drain(..UTF8_MARK.len());
    }
    Ok(bytes)
}

/// A JSON file as records.
pub(super) fn json_of<T: DeserializeOwned>(path: &Path, format: &'static str) -> Result<T, SfmFileError> {
    json(&bytes_of(path)?).map_err(|fault| fault.in_file(path, format))
}

pub(super) fn json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Fault> {
    serde_json::from_slice(bytes).map_err(|error| {
        let place = format!("line {}, column {}", error.line(), error.column());
        let told = error.to_string();
        // The crate ends with the place, which stands before here.
        let got = told.rsplit_once(" at line ").map_or(told.as_str(), |(what, _)| what);
        Fault::new(place, "JSON with the fields of this format", super::escaped(got).to_string())
    })
}

/// Values of a text file, apart by blanks and line ends.
pub(super) struct Tokens<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    pub fn new(bytes: &'a [u8]) -> Tokens<'a> {
        Tokens { bytes, at: 0 }
    }

    /// The rest of the line, trimmed.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
        self.at = (self.at + end + 1).min(self.bytes.len());
        rest[..end].trim_ascii()
    }

    /// The next value; empty at the end.
    pub fn token(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.at += start + length;
        &rest[start..start + length]
    }

    pub fn name(&mut self, expected: &str) -> Result<String, Fault> {
        match self.token() {
            [] => Err(self.fault(expected, b"")),
            token => Ok(String::from_utf8_lossy(token).into_owned()),
        }
    }

    /// A number, finite or not.
    pub fn number(&mut self, expected: &str) -> Result<f64, Fault> {
        let token = self.token();
        fast_float2::parse(token).map_err(|_| self.fault(expected, token))
    }

    pub fn numbers<const N: usize>(&mut self, expected: &str) -> Result<[f64; N], Fault> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.number(expected)?;
        }
        Ok(values)
    }

    /// A whole number.
    pub fn count(&mut self, expected: &str) -> Result<usize, Fault> {
        let token = self.token();
        let parsed = std::str::from_utf8(token).ok().and_then(|text| text.parse().ok());
        parsed.ok_or_else(|| self.fault(expected, token))
    }

    /// A count of things that take at least so many bytes each, which must be there.
    pub fn counted(&mut self, of: &str, least_bytes: usize) -> Result<usize, Fault> {
        let count = self.count(&format!("a number of {of}"))?;
        let left = self.bytes.len() - self.at;
        if count.checked_mul(least_bytes).is_some_and(|needed| needed <= left + 1) {
            return Ok(count);
        }
        let expected = format!("at most {} {of} in the {left} bytes that are left", (left + 1) / least_bytes);
        Err(self.fault(&expected, count.to_string().as_bytes()))
    }

    pub fn fault(&self, expected: &str, got: &[u8]) -> Fault {
        let line = 1 + memchr::memchr_iter(b'\n', &self.bytes[..self.at.min(self.bytes.len())]).count();
        let got = match got {
            [] => "the end of the file".to_string(),
            token => format!("`{}`", String::from_utf8_lossy(&token[..token.len().min(SHOWN_BYTES)]).escape_debug()),
        };
        Fault::new(format!("line {line}"), expected, got)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_stand_in_their_lines() {
        let mut tokens = Tokens::new(b"head line\r\n 2 name -1.5e3\nx");
        assert_eq!(tokens.line(), b"head line");
        assert_eq!(tokens.count("a count").unwrap(), 2);
        assert_eq!(tokens.name("a name").unwrap(), "name");
        assert_eq!(tokens.number("a number").unwrap(), -1500.0);
        let fault = tokens.number("a number").unwrap_err();
        assert_eq!((fault.place.as_str(), fault.got.as_str()), ("line 3", "`x`"));
        assert_eq!(tokens.number("a number").unwrap_err().got, "the end of the file");
    }

    #[test]
    fn a_count_beyond_the_bytes_is_refused() {
        assert_eq!(Tokens::new(b"3 1 2 3").counted("things", 2).unwrap(), 3);
        let fault = Tokens::new(b"4000000000 1 2 3").counted("things", 2).unwrap_err();
        assert!(fault.expected.contains("at most 3 things"), "{}", fault.expected);
        assert!(Tokens::new(b"18446744073709551615 1").counted("things", 9).is_err());
        assert!(Tokens::new(b"-3 1").counted("things", 9).is_err());
    }

    #[test]
    fn json_is_faulted_with_its_place() {
        let fault = json::<Vec<u32>>(b"[1,\n 2, \"\x1b\"]").unwrap_err();
        assert!(fault.place.starts_with("line 2, column"), "{}", fault.place);
        assert!(!fault.got.contains('\u{1b}') && !fault.got.contains(" at line"), "{}", fault.got);
    }
}
