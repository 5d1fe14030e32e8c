//! The boundaries of one geometry: surfaces of rings of indices, in shells and solids.

use super::fault::{CityJsonProblem, Fault};
use super::nest::{Nest, Token, index};

/// The primitives that have surfaces, by how deep their boundaries nest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// MultiSurface, CompositeSurface: surfaces of rings of indices.
    Surfaces,
    /// Solid: an outer shell and cavities.
    Solid,
    /// MultiSolid, CompositeSolid.
    Solids,
}

impl Form {
    /// `None` for points, lines and what is not known.
    pub fn named(kind: &str) -> Option<Form> {
        match kind {
            "MultiSurface" | "CompositeSurface" => Some(Form::Surfaces),
            "Solid" => Some(Form::Solid),
            "MultiSolid" | "CompositeSolid" => Some(Form::Solids),
            _ => None,
        }
    }

    /// Arrays around an index.
    pub fn depth(self) -> usize {
        match self {
            Form::Surfaces => 3,
            Form::Solid => 4,
            Form::Solids => 5,
        }
    }
}

/// The nested arrays of one geometry, flat. Each list holds the ends, in the list before it, of what it counts.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    pub corners: Vec<u32>,
    pub ring_ends: Vec<u32>,
    pub surface_ends: Vec<u32>,
    /// A geometry of surfaces alone counts as one shell of one solid.
    pub shell_ends: Vec<u32>,
    pub solid_ends: Vec<u32>,
}

impl Shape {
    /// Reads anew; `byte` is where the boundaries begin in the text, `vertices` how many there are.
    pub fn read(&mut self, boundaries: &str, byte: usize, form: Form, vertices: usize) -> Result<(), Fault> {
        self.clear();
        let deepest = form.depth();
        let mut nest = Nest::new(boundaries);
        while let Some((at, token)) = nest.next() {
            match token {
                Token::Leaf(leaf) if nest.depth == deepest => {
                    let corner = corner(leaf, vertices).map_err(|problem| Fault::at(byte + at, problem))?;
                    self.corners.push(corner);
                }
                Token::Open if nest.depth <= deepest => {}
                Token::Close => self.close(deepest - nest.depth.min(deepest)),
                Token::Open | Token::Leaf(_) => {
                    let found = if let Token::Leaf(leaf) = token { leaf.to_owned() } else { "[".to_owned() };
                    let problem = CityJsonProblem::Nesting {
                        what: "boundaries",
                        found,
                        depth: nest.depth,
                        expected: "an index",
                        level: deepest,
                    };
                    return Err(Fault::at(byte + at, problem));
                }
            }
        }
        if form == Form::Surfaces {
            self.close(deepest + 1);
        }
        Ok(())
    }

    fn clear(&mut self) {
        self.corners.clear();
        for ends in [&mut self.ring_ends, &mut self.surface_ends, &mut self.shell_ends, &mut self.solid_ends] {
            ends.clear();
        }
    }

    /// Ends what is open `level` steps above the indices: 1 a ring, 2 a surface, 3 a shell, 4 a solid.
    fn close(&mut self, level: usize) {
        match level {
            1 => {
                // Some writers repeat the first corner at the end.
                let start = self.ring_ends.last().map_or(0, |&end| end as usize);
                if self.corners.len() > start + 1 && self.corners.last() == self.corners.get(start) {
                    self.corners.pop();
                }
                self.ring_ends.push(self.corners.len() as u32);
            }
            2 => self.surface_ends.push(self.ring_ends.len() as u32),
            3 => self.shell_ends.push(self.surface_ends.len() as u32),
            4 => self.solid_ends.push(self.shell_ends.len() as u32),
            _ => {}
        }
    }
}

/// An index of one of so many vertices.
pub(super) fn corner(leaf: &str, vertices: usize) -> Result<u32, CityJsonProblem> {
    let corner = index(leaf).ok_or_else(|| not_an_index(leaf, vertices))?;
    if (corner as usize) < vertices { Ok(corner) } else { Err(out_of_range(leaf, vertices)) }
}

fn not_an_index(leaf: &str, vertices: usize) -> CityJsonProblem {
    let is_whole = !leaf.is_empty() && leaf.bytes().all(|byte| byte.is_ascii_digit());
    if is_whole { out_of_range(leaf, vertices) } else { CityJsonProblem::NotAnIndex { found: leaf.to_owned() } }
}

fn out_of_range(leaf: &str, count: usize) -> CityJsonProblem {
    CityJsonProblem::IndexOutOfRange { what: "vertices", index: leaf.to_owned(), count }
}
