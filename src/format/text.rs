//! Text as editors and shells save it: UTF-8 with a byte order mark or without, or the UTF-16 of a redirected PowerShell.

use std::io::{self, Error, ErrorKind};
use std::path::Path;

use super::file::read_regular;

/// The longest report of a large city has some megabytes; a file beyond this is another file given by mistake.
pub const LARGEST_TEXT_BYTES: u64 = 64 << 20;

/// The text of a regular file of at most `limit` bytes.
pub fn read_text(path: &Path, limit: u64) -> io::Result<String> {
    text_of(read_regular(path, limit)?)
}

/// The text of a stream, up to `limit` bytes.
#[cfg(feature = "cli")]
pub fn text_from(stream: impl std::io::Read, limit: u64) -> io::Result<String> {
    text_of(super::file::read_at_most(stream, 0, limit)?)
}

fn text_of(bytes: Vec<u8>) -> io::Result<String> {
    decode(bytes).map_err(|message| Error::new(ErrorKind::InvalidData, message))
}

fn decode(bytes: Vec<u8>) -> Result<String, String> {
    let utf16 = |pairs: &[u8], unit: fn([u8; 2]) -> u16| {
        let pairs = pairs.chunks_exact(2);
        let whole = pairs.remainder().is_empty();
        let text = char::decode_utf16(pairs.map(|pair| unit([pair[0], pair[1]]))).collect::<Result<String, _>>();
        text.ok().filter(|_| whole).ok_or_else(|| "this is damaged UTF-16 text; save it as UTF-8".to_owned())
    };
    match bytes.as_slice() {
        [0xEF, 0xBB, 0xBF, ..] => utf8(bytes[3..].to_vec()),
        // UTF-32, whose mark begins like that of UTF-16.
        [0xFF, 0xFE, 0, 0, ..] | [0, 0, 0xFE, 0xFF, ..] => Err("this is UTF-32 text; save it as UTF-8".into()),
        [0xFF, 0xFE, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => utf16(rest, u16::from_be_bytes),
        // JSON begins with an ASCII sign; RFC 4627, section 3, tells the encodings apart by it.
        [sign, 0, ..] if *sign != 0 => utf16(&bytes, u16::from_le_bytes),
        [0, sign, ..] if *sign != 0 => utf16(&bytes, u16::from_be_bytes),
        _ => utf8(bytes),
    }
}

fn utf8(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        format!("line {line} is not UTF-8 text; save it as UTF-8")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\"name\": \"Straße 😀\"}\r\n";

    fn utf16(unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
        TEXT.encode_utf16().flat_map(unit).collect()
    }

    #[test]
    fn reads_what_windows_saves_as_if_it_were_plain_utf8() {
        let marked = |mark: &[u8], bytes: &[u8]| [mark, bytes].concat();
        let (little, big) = (utf16(u16::to_le_bytes), utf16(u16::to_be_bytes));
        for bytes in [
            TEXT.as_bytes().to_vec(),
            marked(&[0xEF, 0xBB, 0xBF], TEXT.as_bytes()),
            marked(&[0xFF, 0xFE], &little),
            marked(&[0xFE, 0xFF], &big),
            little.clone(),
            big.clone(),
        ] {
            assert_eq!(text_from(bytes.as_slice(), 1000).unwrap(), TEXT);
        }
        assert_eq!(text_from(&b""[..], 1000).unwrap(), "");
    }

    #[test]
    fn says_how_to_save_what_is_no_text() {
        let odd = [&[0xFF, 0xFE], &utf16(u16::to_le_bytes)[..5]].concat();
        let lone = [0xFF, 0xFE, 0x00, 0xD8, b'x', 0];
        let utf32 = [0xFF, 0xFE, 0, 0, b'{', 0, 0, 0];
        for (bytes, says) in [
            (&odd[..], "UTF-16"),
            (&lone[..], "UTF-16"),
            (&utf32[..], "UTF-32"),
            (b"{\n\"name\": \"Stra\xDFe\"}", "line 2 is not UTF-8"),
        ] {
            let message = text_from(bytes, 1000).unwrap_err().to_string();
            assert!(message.contains(says) && message.contains("save it as UTF-8"), "{message}");
        }
        assert!(text_from(io::repeat(b' '), 1000).unwrap_err().to_string().contains("at most 1000"));
    }
}
