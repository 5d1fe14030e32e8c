//! Rows of values: binary ones of any shape, and ASCII ones.

use super::field::ByteOrder;
use super::header::{Element, PropertyKind, shown};

/// Takes binary rows off the front of `left`.
pub(super) struct BinaryRows<'a> {
    pub left: &'a [u8],
    pub order: ByteOrder,
}

impl BinaryRows<'_> {
    /// The next row of an element; `None` where the bytes end before it does. Of a list the count stands for it.
    pub fn next(&mut self, element: &Element, values: &mut Vec<f64>) -> Option<()> {
        values.clear();
        for property in &element.properties {
            match property.kind {
                PropertyKind::Scalar(kind) => values.push(self.number(kind)?),
                PropertyKind::List(length_kind, kind) => {
                    let length = self.number(length_kind)?;
                    // Of floating-point counts the whole part counts; negative ones are none.
                    let bytes = (length as usize).checked_mul(kind.size())?;
                    self.left = self.left.get(bytes..)?;
                    values.push(length);
                }
            }
        }
        Some(())
    }

    fn number(&mut self, kind: super::FieldKind) -> Option<f64> {
        let value = kind.read(self.left, self.order)?;
        self.left = &self.left[kind.size()..];
        Some(value)
    }
}

/// What is wrong in an ASCII row.
pub(super) struct RowFault {
    pub expected: String,
    pub got: String,
}

/// The values of an ASCII row of an element; of a list the count stands for it.
pub(super) fn ascii_row(element: &Element, row: &[u8], values: &mut Vec<f64>) -> Result<(), RowFault> {
    values.clear();
    let mut rest = row;
    for property in &element.properties {
        let name = &property.name;
        let mut value = || {
            number(&mut rest).ok_or_else(|| RowFault {
                expected: format!("a number for `{}` of {}", shown(name.as_bytes()), shown(element.name.as_bytes())),
                got: told(rest),
            })
        };
        values.push(value()?);
        if let PropertyKind::List(..) = property.kind {
            // A length beyond the row's end, or one that is no number, is found by the values it asks for.
            for _ in 0..values.last().map_or(0, |length| *length as u64) {
                value()?;
            }
        }
    }
    match rest.trim_ascii() {
        [] => Ok(()),
        rest => {
            let count = element.properties.len();
            let expected = format!("{count} values in a row of {}", shown(element.name.as_bytes()));
            Err(RowFault { expected, got: told(rest) })
        }
    }
}

fn told(rest: &[u8]) -> String {
    match rest {
        [] => "the end of the line".to_string(),
        token => format!("`{}`", shown(token)),
    }
}

/// Takes the next number off `rest`.
fn number(rest: &mut &[u8]) -> Option<f64> {
    let text = rest.trim_ascii_start();
    *rest = text;
    let (value, length) = fast_float2::parse_partial::<f64, _>(text).ok()?;
    if text.get(length).is_some_and(|b| !b.is_ascii_whitespace()) {
        return None;
    }
    *rest = &text[length..];
    Some(value)
}
