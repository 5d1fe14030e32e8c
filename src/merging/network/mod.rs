//! All parts at once: which edges hold, where every part stands, and what that makes the whole.
//!
//! Question     where does each part stand in one frame, and which of the measured edges are not to be believed?
//! Input        pairs of parts, each with its estimate and decision, and anchors in a city
//! Output       [`Solved`]: a verdict, every part's place or the reason why it has none, the edges
//! Method       the strongest edges place the parts (`graph`); the edges that the others contradict are put aside
//!              (`cycles`); parts that overlap
//!              in the city alone get an edge (`overlap`); all places are moved to the least squares of all edges (`adjustment`), and told
//!              (`places`, `freedoms`, `edges`, `verdict`)
//! Assumptions  wrong edges are fewer than right ones
//! Fails when   a single cycle does not close: then nobody can tell which of its edges is wrong, and the verdict says so

mod adjustment;
mod cycles;
mod edges;
mod freedoms;
mod graph;
mod overlap;
mod places;
#[cfg(test)]
mod tests;
mod verdict;

use self::adjustment::adjust;
use self::edges::edges;
use self::graph::Network;
use self::overlap::overlaps;
use self::places::places;
use self::verdict::verdict;
use super::limits::MergeLimits;
use super::outcome::{Edge, MergeVerdict, MergedFrame, PartPlace};
use super::pairwise::Pair;
use super::prepared::PreparedPart;

/// What came of all parts.
pub(super) struct Solved {
    pub verdict: MergeVerdict,
    pub reason: String,
    pub frame: MergedFrame,
    pub places: Vec<PartPlace>,
    pub edges: Vec<Edge>,
}

/// Solves the network of all pairs and anchors; `order`: the parts by their content.
pub(super) fn solve(parts: &[PreparedPart<'_>], order: &[usize], pairs: Vec<Pair>, limits: &MergeLimits) -> Solved {
    let mut network = Network::new(parts, order, pairs, limits);
    let mut poses = network.settle();
    network.retire_unplaced(&poses);
    let overlaps = overlaps(&network, &poses);
    network.pairs.extend(overlaps);
    let held = adjust(&network, &mut poses);
    let places = places(&network, &poses, &held);
    let frame = match places.iter().find(|place| place.merged_from_part.is_some()) {
        Some(_) if network.anchored.contains(&true) => MergedFrame::City,
        Some(place) => MergedFrame::Part(place.name.clone()),
        None => MergedFrame::Nobodys,
    };
    let (verdict, reason) = verdict(&places, &network);
    Solved { verdict, reason, frame, places, edges: edges(&poses, network) }
}
