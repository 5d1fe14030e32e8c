//! Nested JSON arrays of numbers, token by token, without recursion.

/// A token of nested arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Open,
    Close,
    /// A number, `null`, or what else stands there, as it is written.
    Leaf(&'a str),
}

/// Walks the text of one JSON value. The text is sound JSON: `serde_json` has passed over it.
pub(super) struct Nest<'a> {
    text: &'a str,
    at: usize,
    /// Arrays that are open.
    pub depth: usize,
}

impl<'a> Nest<'a> {
    pub fn new(text: &'a str) -> Nest<'a> {
        Nest { text, at: 0, depth: 0 }
    }

    /// The next token and the byte at which it begins; `None` at the end.
    pub fn next(&mut self) -> Option<(usize, Token<'a>)> {
        let bytes = self.text.as_bytes();
        while matches!(bytes.get(self.at)?, b' ' | b'\t' | b'\n' | b'\r' | b',') {
            self.at += 1;
        }
        let start = self.at;
        self.at += 1;
        let token = match bytes[start] {
            b'[' => {
                self.depth += 1;
                Token::Open
            }
            b']' => {
                self.depth = self.depth.saturating_sub(1);
                Token::Close
            }
            b'"' | b'{' => {
                // Neither belongs here; the rest is not looked at.
                self.at = bytes.len();
                Token::Leaf(shortened(self.text.get(start..).unwrap_or_default()))
            }
            _ => {
                let ends = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | b',' | b']');
                self.at = bytes[start..].iter().position(ends).map_or(bytes.len(), |length| start + length);
                Token::Leaf(self.text.get(start..self.at).unwrap_or_default())
            }
        };
        Some((start, token))
    }
}

/// The beginning of a text, for a message.
fn shortened(text: &str) -> &str {
    const SHOWN: usize = 20;
    text.char_indices().nth(SHOWN).and_then(|(end, _)| text.get(..end)).unwrap_or(text)
}

/// A whole number from 0 on that fits in 32 bits.
pub(super) fn index(leaf: &str) -> Option<u32> {
    const MOST_DIGITS: usize = 10;
    if leaf.is_empty() || leaf.len() > MOST_DIGITS {
        return None;
    }
    let mut value: u64 = 0;
    for byte in leaf.bytes() {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = 10 * value + u64::from(digit);
    }
    u32::try_from(value).ok()
}
