//! The bytes of an XML file as UTF-8, with lines counted.

use std::io::{BufRead, Chain, Cursor, Error, Read, Result};

use encoding_rs::Encoding;
use quick_xml::encoding::DecodingReader;

use crate::format::surface_error::SurfaceError;

/// Bytes within which an XML declaration ends.
const DECLARATION_BYTES: u64 = 1024;

/// A source whose first bytes were looked at.
pub(super) type Begun<R> = Chain<Cursor<Vec<u8>>, R>;

/// What a source is written in.
pub(super) enum Text<R: BufRead> {
    Utf8(Begun<R>),
    Other(Box<DecodingReader<Begun<R>>>),
}

/// Finds out the encoding by the byte order mark or the declaration; without either it is UTF-8.
pub(super) fn text_of<R: BufRead>(mut source: R) -> std::result::Result<Text<R>, SurfaceError> {
    let unreadable = |error: Error| SurfaceError::whole(format!("cannot read the file: {error}"));
    let mut head = Vec::new();
    source.by_ref().take(DECLARATION_BYTES).read_to_end(&mut head).map_err(unreadable)?;
    let is_utf16 = matches!(head[..], [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] | [b'<', 0, ..] | [0, b'<', ..]);
    let label = declared_encoding(&head).to_owned();
    let encoding = Encoding::for_label(label.as_bytes());
    let begun = Cursor::new(head).chain(source);
    match encoding {
        // It finds out which by itself.
        _ if is_utf16 => Ok(Text::Other(Box::new(DecodingReader::new(begun)))),
        Some(encoding) if encoding == encoding_rs::UTF_8 => Ok(Text::Utf8(begun)),
        Some(encoding) if encoding.is_ascii_compatible() => {
            let mut decoding = DecodingReader::new(begun);
            decoding.set_encoding(encoding);
            Ok(Text::Other(Box::new(decoding)))
        }
        _ => Err(SurfaceError::whole(format!(
            "the file says that it is written in `{label}`, which is not known; expected UTF-8: save it so"
        ))),
    }
}

/// `ISO-8859-1` of `<?xml version="1.0" encoding="ISO-8859-1"?>`.
fn declared_encoding(head: &[u8]) -> &str {
    const DEFAULT: &str = "utf-8";
    let declaration = head.split(|&byte| byte == b'>').next().unwrap_or_default();
    let declaration = std::str::from_utf8(declaration).unwrap_or_default().trim_start_matches('\u{feff}').trim_start();
    if !declaration.starts_with("<?xml") {
        return DEFAULT;
    }
    let Some((_, value)) = declaration.split_once("encoding") else { return DEFAULT };
    let value = value.trim_start().trim_start_matches('=').trim_start();
    value.split(['"', '\'']).nth(1).unwrap_or(DEFAULT)
}

/// Counts the lines that were taken.
pub(super) struct LineCounter<R> {
    inner: R,
    /// Number of the line that comes next, from 1.
    pub line: u64,
}

impl<R> LineCounter<R> {
    pub fn new(inner: R) -> LineCounter<R> {
        LineCounter { inner, line: 1 }
    }
}

impl<R: BufRead> Read for LineCounter<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let count = self.inner.read(buffer)?;
        self.line += memchr::memchr_iter(b'\n', &buffer[..count]).count() as u64;
        Ok(count)
    }
}

impl<R: BufRead> BufRead for LineCounter<R> {
    fn fill_buf(&mut self) -> Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        // What is consumed lies in the buffer already, so this reads nothing and cannot fail.
        if let Ok(buffer) = self.inner.fill_buf() {
            let taken = &buffer[..count.min(buffer.len())];
            self.line += memchr::memchr_iter(b'\n', taken).count() as u64;
        }
        self.inner.consume(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn decoded(bytes: &[u8]) -> std::result::Result<String, SurfaceError> {
        let mut text = String::new();
        match text_of(bytes)? {
            Text::Utf8(mut source) => source.read_to_string(&mut text),
            Text::Other(mut source) => source.read_to_string(&mut text),
        }
        .map_err(|error| SurfaceError::whole(error.to_string()))?;
        Ok(text)
    }

    #[test]
    fn the_declaration_names_the_encoding() {
        for (declaration, byte, expected) in [
            ("<?xml version='1.0' encoding='ISO-8859-1'?>", 0xE9_u8, "\u{e9}"),
            ("<?xml version=\"1.0\" encoding = \"windows-1252\" ?>", 0x80, "\u{20ac}"),
            ("<?xml version='1.0' encoding='ISO-8859-15'?>", 0xA4, "\u{20ac}"),
        ] {
            let text = decoded(&[declaration.as_bytes(), &[byte]].concat()).unwrap();
            assert!(text.ends_with(expected), "{text}");
        }
        assert_eq!(decoded("\u{feff}<a>\u{fc}".as_bytes()).unwrap(), "\u{feff}<a>\u{fc}");
        assert_eq!(decoded(b"<a encoding='EBCDIC'>").unwrap(), "<a encoding='EBCDIC'>");
        assert!(decoded(b"<?xml encoding='nonsense'?>").unwrap_err().to_string().contains("`nonsense`"));
    }

    #[test]
    fn a_declaration_beyond_the_first_bytes_is_none() {
        let padded = format!("{}<?xml encoding='ISO-8859-1'?>", " ".repeat(2000));
        assert_eq!(decoded(padded.as_bytes()).unwrap().len(), padded.len());
    }

    #[test]
    fn lines_are_counted_as_they_are_taken() {
        for capacity in [1, 2, 3, 100] {
            let mut counter = LineCounter::new(BufReader::with_capacity(capacity, &b"a\nb\n\nc"[..]));
            let mut first = Vec::new();
            counter.read_until(b'b', &mut first).unwrap();
            assert_eq!((first.len(), counter.line), (3, 2));
            let mut rest = Vec::new();
            counter.read_to_end(&mut rest).unwrap();
            assert_eq!((rest.len(), counter.line), (3, 4));
        }
    }
}
