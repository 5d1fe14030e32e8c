//! Vertices of all files to one list: shifted, and one vertex for every place.

use rayon::prelude::*;

use super::CityModel;
use super::sorting::{digest, each_alike};
use super::source::Source;
use super::warning::{CityDefect, Warnings};
use crate::geometry::Point3;

/// No vertex has this index.
const UNUSED: u32 = u32::MAX;

/// A vertex that a face uses.
struct Used {
    source: u32,
    /// Index into the source's positions.
    vertex: u32,
    /// The first corner that uses it.
    corner: u32,
}

/// Moves the vertices that faces use into the model, in order of first use, those at exactly the same place only once,
/// also across files. Returns for each source which vertex of the model each of its own became.
/// `None` where there are too many to count in 32 bits.
pub(super) fn join_vertices(
    model: &mut CityModel,
    warnings: &mut Warnings,
    sources: &[Source],
) -> Option<Vec<Vec<u32>>> {
    let used = used_vertices(sources);
    u32::try_from(used.len()).ok().filter(|&count| count < UNUSED)?;
    let local = |used: &Used| sources[used.source as usize].positions[used.vertex as usize] - model.origin;
    let positions: Vec<Point3<f64>> = used.par_iter().map(local).collect();
    let first_at_place = first_at_place(&positions);
    let mut vertex_of: Vec<Vec<u32>> = sources.iter().map(|source| vec![UNUSED; source.positions.len()]).collect();
    let mut joined: Vec<u32> = Vec::with_capacity(used.len());
    for (at, (here, &first)) in used.iter().zip(&first_at_place).enumerate() {
        let vertex = if first as usize == at { model.vertices.len() as u32 } else { joined[first as usize] };
        if first as usize == at {
            model.vertices.push(positions[at]);
        } else if here.source == used[first as usize].source {
            let source = &sources[here.source as usize];
            let place = || source.place_of(source.face_of_corner(here.corner as usize));
            warnings.add(CityDefect::DuplicateVertices, u64::from(source.shares_vertices), place);
        }
        joined.push(vertex);
        vertex_of[here.source as usize][here.vertex as usize] = vertex;
    }
    Some(vertex_of)
}

fn used_vertices(sources: &[Source]) -> Vec<Used> {
    let mut used = Vec::with_capacity(sources.iter().map(|source| source.positions.len()).sum());
    for (at, source) in sources.iter().enumerate() {
        let mut is_used = vec![false; source.positions.len()];
        for (corner, &vertex) in source.corners.iter().enumerate() {
            if !std::mem::replace(&mut is_used[vertex as usize], true) {
                used.push(Used { source: at as u32, vertex, corner: corner as u32 });
            }
        }
    }
    used
}

/// For each position the index of the first that equals it.
fn first_at_place(positions: &[Point3<f64>]) -> Vec<u32> {
    // Adding zero turns a negative zero into the usual one, which has other bits.
    let key = |at: u32| {
        let position = &positions[at as usize];
        [position.x, position.y, position.z].map(|value| (value + 0.0).to_bits())
    };
    let count = positions.len() as u32;
    let mut first: Vec<u32> = (0..count).collect();
    each_alike(
        count,
        |at| digest(key(at)),
        key,
        |same| {
            same[1..].iter().for_each(|&at| first[at as usize] = same[0]);
        },
    );
    first
}
