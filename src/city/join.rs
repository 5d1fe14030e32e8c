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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::city::CityRole;
    use crate::format::obj::read_obj;
    use crate::geometry::Vector3;
    use crate::random::Random;

    fn source(text: &str) -> Source {
        Source::from_obj(Path::new("a.obj"), CityRole::City, read_obj(text.as_bytes()).unwrap())
    }

    /// Triangles on corners of a small lattice, of which many are the same place.
    fn lattice(random: &mut Random, triangles: usize) -> String {
        let mut text = String::new();
        for _ in 0..3 * triangles {
            let [x, y, z] = [(); 3].map(|()| random.below(3) as f64 - 1.0);
            text += &format!("v {x} {y} {z}\n");
        }
        (0..triangles).for_each(|at| text += &format!("f {} {} {}\n", 3 * at + 1, 3 * at + 2, 3 * at + 3));
        text
    }

    #[test]
    fn joins_what_comparing_every_pair_joins_across_files() {
        let mut random = Random::stream(3, 0);
        for _ in 0..20 {
            let sources = [source(&lattice(&mut random, 6)), source(&lattice(&mut random, 4))];
            let mut model = CityModel { origin: Vector3::new(1.0, 2.0, 3.0), ..CityModel::default() };
            let vertex_of = join_vertices(&mut model, &mut Warnings::default(), &sources).unwrap();
            let mut expected: Vec<Point3<f64>> = Vec::new();
            for source in &sources {
                for &corner in &source.corners {
                    let place = source.positions[corner as usize] - model.origin;
                    if !expected.contains(&place) {
                        expected.push(place);
                    }
                }
            }
            assert_eq!(model.vertices, expected, "each place once, in the order of first use");
            for (source, vertex_of) in sources.iter().zip(&vertex_of) {
                for &corner in &source.corners {
                    let joined = model.vertices[vertex_of[corner as usize] as usize];
                    assert_eq!(joined, source.positions[corner as usize] - model.origin);
                }
            }
        }
    }

    #[test]
    fn the_two_zeros_are_one_place_and_what_no_face_uses_is_left_out() {
        let sources = [source("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nv -0 -0 -0\nv 0 0 1\nf 1 2 3\nf 5 2 6\n")];
        let mut model = CityModel::default();
        let vertex_of = join_vertices(&mut model, &mut Warnings::default(), &sources).unwrap();
        assert_eq!(model.vertices.len(), 4);
        assert_eq!((vertex_of[0][0], vertex_of[0][3]), (vertex_of[0][4], UNUSED));
    }
}
