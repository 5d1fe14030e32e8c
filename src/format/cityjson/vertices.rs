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
                let value = fast_float2::parse::<f64, _>(leaf).unwrap_or(f64::NAN);
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

fn misplaced(found: String, depth: usize, expected: &'static str) -> CityJsonProblem {
    CityJsonProblem::Nesting { what: "vertices", found, depth, expected, level: DEPTH }
}
