//! The edges as the report tells them.

use super::graph::Network;
use crate::geometry::Similarity;
use crate::merging::fault::EdgeFault;
use crate::merging::outcome::{Edge, EdgeSource};

/// Edges for the report, lengths in the merged frame, and one for every two parts that only the city joins.
pub(super) fn edges(poses: &[Option<Similarity>], network: Network<'_>) -> Vec<Edge> {
    let Network { parts, pairs, anchored: in_use, anchor_faults, .. } = network;
    let mut edges: Vec<Edge> = pairs
        .into_iter()
        .map(|pair| {
            let scale = poses[pair.edge.a].map_or(1.0, |pose| pose.scale);
            Edge { rms: pair.edge.rms * scale, ..pair.edge }
        })
        .collect();
    let anchored: Vec<usize> = (0..parts.len()).filter(|&p| parts[p].part.anchor.is_some()).collect();
    for pair in anchored.windows(2) {
        let is_told = |e: &Edge| [e.a.min(e.b), e.a.max(e.b)] == pair && e.source == EdgeSource::City;
        if edges.iter().any(is_told) {
            continue;
        }
        let fault = pair.iter().find_map(|&p| anchor_faults[p].clone());
        edges.push(Edge {
            a: pair[0],
            b: pair[1],
            source: EdgeSource::City,
            shared_photos: Vec::new(),
            pairs: 0,
            inliers: 0,
            rms: 0.0,
            refusal: (!pair.iter().all(|&p| in_use[p])).then(|| fault.unwrap_or(EdgeFault::NotFixedByCity)),
            note: None,
        });
    }
    edges.iter_mut().for_each(|e| (e.a, e.b) = (e.a.min(e.b), e.a.max(e.b)));
    edges.sort_by_key(|e| (e.a, e.b));
    edges
}
