//! What the surfaces of a geometry are: values of its semantics, which nest as its boundaries do.

use super::boundaries::Shape;
use super::document::Semantics;
use super::nest::{Nest, Token, index};
use crate::format::surfaces::SurfaceKind;

/// The kind of each surface, and how many values fit no surface (too many, at another depth, of no semantic surface).
pub(super) fn kinds_of(
    semantics: Option<&Semantics<'_>>,
    shape: &Shape,
    depth: usize,
) -> (Vec<Option<SurfaceKind>>, usize) {
    let mut kinds = vec![None; shape.surface_ends.len()];
    let Some((semantics, values)) = semantics.and_then(|semantics| Some((semantics, semantics.values?))) else {
        return (kinds, 0);
    };
    let known: Vec<SurfaceKind> = semantics.surfaces.iter().map(|surface| kind_named(&surface.kind)).collect();
    let mut misfits = 0;
    // Values stand two levels above indices: one for a surface. `null` above that stands for a whole shell or solid.
    let depth = depth - 2;
    // How many members each open array has had.
    let mut path = [0_usize; 4];
    let mut nest = Nest::new(values.get());
    while let Some((_, token)) = nest.next() {
        match token {
            Token::Open if nest.depth < path.len() => path[nest.depth] = 0,
            Token::Open => misfits += 1,
            Token::Close => path[nest.depth.min(path.len() - 1)] += 1,
            Token::Leaf(leaf) => {
                let kind = index(leaf).and_then(|at| known.get(at as usize));
                let surface = if nest.depth == depth { surface_at(shape, &path[1..=depth]) } else { None };
                match (kind, surface) {
                    (Some(&kind), Some(surface)) => kinds[surface] = Some(kind),
                    _ if leaf == "null" => {}
                    _ => misfits += 1,
                }
                path[nest.depth.min(path.len() - 1)] += 1;
            }
        }
    }
    (kinds, misfits)
}

/// The surface at a path of solid, shell and surface, the first of which may be left out.
fn surface_at(shape: &Shape, path: &[usize]) -> Option<usize> {
    let member = |ends: &[u32], of: usize, at: usize| {
        let start = if of == 0 { 0 } else { *ends.get(of - 1)? } as usize;
        Some(start + at).filter(|&found| ends.get(of).is_some_and(|&end| found < end as usize))
    };
    let (&surface, above) = path.split_last()?;
    let shell = match above {
        [solid, shell] => member(&shape.solid_ends, *solid, *shell)?,
        [shell] => *shell,
        _ => 0,
    };
    member(&shape.shell_ends, shell, surface)
}

fn kind_named(name: &str) -> SurfaceKind {
    match name {
        "GroundSurface" => SurfaceKind::Ground,
        "RoofSurface" => SurfaceKind::Roof,
        "WallSurface" => SurfaceKind::Wall,
        "ClosureSurface" => SurfaceKind::Closure,
        _ => SurfaceKind::Other,
    }
}
