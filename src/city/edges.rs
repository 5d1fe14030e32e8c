//! Edges of facets, those of the same two vertices beside each other.

use super::CityModel;
use super::sorting::sort;

/// An edge of one facet of an object; in order of its vertices, then of its direction, then of the facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Edge(u128);

impl Edge {
    fn new(from: u32, to: u32, facet: u32) -> Edge {
        let (low, high) = (u128::from(from.min(to)), u128::from(from.max(to)));
        Edge(low << 96 | high << 64 | u128::from(from < to) << 32 | u128::from(facet))
    }

    /// The lower vertex and the higher, in one number.
    pub fn ends(self) -> u64 {
        (self.0 >> 64) as u64
    }

    /// Whether the facet walks it from the lower vertex to the higher.
    pub fn rises(self) -> bool {
        self.0 >> 32 & 1 == 1
    }

    /// The facet's number within its object.
    pub fn facet(self) -> usize {
        self.0 as u32 as usize
    }
}

/// All edges of an object, like ones beside each other.
pub(super) fn sorted_edges(model: &CityModel, facets: &[u32]) -> Vec<Edge> {
    let mut edges: Vec<Edge> = Vec::with_capacity(5 * facets.len());
    for (&facet, at) in facets.iter().zip(0..) {
        for ring in model.facets[facet as usize].rings() {
            let Some(&last) = ring.last() else { continue };
            let mut from = last;
            for &to in ring {
                edges.push(Edge::new(from, to, at));
                from = to;
            }
        }
    }
    sort(&mut edges);
    edges
}

/// The facets of one file, those of each object beside each other, in order.
pub(super) fn by_object(model: &CityModel, facets: std::ops::Range<u32>) -> Vec<u32> {
    let object = |facet: &u32| model.facets[*facet as usize].object.0;
    let mut by_object: Vec<u32> = facets.collect();
    // Stable, and done at once where the file has them in this order.
    by_object.sort_by_key(object);
    by_object
}

/// The facets of each object that has some.
pub(super) fn objects_of<'f>(model: &CityModel, by_object: &'f [u32]) -> Vec<&'f [u32]> {
    let object = |facet: u32| model.facets[facet as usize].object;
    by_object.chunk_by(|&a, &b| object(a) == object(b)).collect()
}
