//! Lists of vertices: three numbers each, brought to coordinates by the file's transform.

use super::document::Transform;
use super::fault::{CityJsonProblem, Fault};
use super::nest::{Nest, Token};

/// Metres; the same reach as an OBJ file has.
pub(super) const COORDINATE_LIMIT: f64 = 1e9;

/// Depth of a coordinate in `[[x, y, z], ...]`.
const DEPTH: usize = 2;

/// Adds the vertices of one list; `byte` is where it begins in the text.
pub(super) fn read_vertices(
    list: &str,
    byte: usize,
    transform: &Transform,
    positions: &mut Vec<[f64; 3]>,
) -> Result<(), Fault> {
    let mut nest = Nest::new(list);
    let (mut vertex, mut count) = ([0.0; 3], 0);
    while let Some((at, token)) = nest.next() {
        let depth = nest.depth;
        match token {
            Token::Open if depth <= DEPTH => count = 0,
            Token::Leaf(leaf) if depth == DEPTH => {
                let value = whole(leaf).or_else(|| fast_float2::parse(leaf).ok()).unwrap_or(f64::NAN);
                if let Some(place) = vertex.get_mut(count) {
                    *place = transform.scale[count] * value + transform.translate[count];
                    if place.is_nan() || place.abs() > COORDINATE_LIMIT {
                        let problem = CityJsonProblem::OutOfReach { found: leaf.into(), limit: COORDINATE_LIMIT };
                        return Err(Fault::at(byte + at, problem));
                    }
                }
                count += 1;
            }
            Token::Close if depth + 1 == DEPTH && count == vertex.len() => positions.push(vertex),
            Token::Close if depth + 1 == DEPTH => {
                let found = format!("{count} numbers");
                return Err(Fault::at(byte + at, misplaced(found, DEPTH, "three numbers")));
            }
            Token::Close => {}
            Token::Open => return Err(Fault::at(byte + at, misplaced("[".into(), depth, "a number"))),
            Token::Leaf(leaf) => return Err(Fault::at(byte + at, misplaced(leaf.into(), depth, "a number"))),
        }
    }
    Ok(())
}

/// A whole number, as nearly all vertices are: exact in so few digits.
fn whole(leaf: &str) -> Option<f64> {
    const MOST_DIGITS: usize = 15;
    let digits = leaf.strip_prefix('-').unwrap_or(leaf).as_bytes();
    if digits.is_empty() || digits.len() > MOST_DIGITS {
        return None;
    }
    let mut value: u64 = 0;
    for byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = 10 * value + u64::from(digit);
    }
    Some(if digits.len() < leaf.len() { -(value as f64) } else { value as f64 })
}

fn misplaced(found: String, depth: usize, expected: &'static str) -> CityJsonProblem {
    CityJsonProblem::Nesting { what: "vertices", found, depth, expected, level: DEPTH }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_equal_the_general_parser_to_the_last_bit() {
        for text in ["0", "-0", "7", "-12", "5335000123", "999999999999999", "-999999999999999"] {
            let expected: f64 = fast_float2::parse(text).unwrap();
            assert_eq!(whole(text).map(f64::to_bits), Some(expected.to_bits()), "{text}");
        }
        for text in ["", "-", "--1", "1.5", "1e3", "null", "+1", "1000000000000000"] {
            assert_eq!(whole(text), None, "{text}");
        }
    }
}
