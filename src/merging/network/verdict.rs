//! What the places of all parts make the whole.

use super::graph::Network;
use crate::merging::outcome::{EdgeSource, MergeVerdict, PartPlace};
use crate::merging::pairwise::{Pair, PairDecision};
use crate::verdict::Verdict;

/// The verdict, and one sentence with figures.
pub(super) fn verdict(places: &[PartPlace], network: &Network<'_>) -> (MergeVerdict, String) {
    let placed = places.iter().filter(|p| p.merged_from_part.is_some()).count();
    let names = || {
        let left: Vec<String> =
            places.iter().filter_map(|p| p.reason.as_ref().map(|reason| format!("{} ({reason})", p.name))).collect();
        left.join(", ")
    };
    if placed == places.len() && placed > 1 {
        let is_shared = |l: &&Pair| l.edge.is_used() && l.edge.source != EdgeSource::City;
        let used: Vec<&Pair> = network.pairs.iter().filter(is_shared).collect();
        let inliers: usize = used.iter().map(|l| l.edge.inliers).sum();
        let photos: usize = used.iter().map(|l| l.edge.shared_photos.len()).sum();
        let by_planes = used.iter().any(|l| l.edge.source == EdgeSource::Superpixels);
        let what = if by_planes { "points on planes" } else { "point pairs" };
        let over = format!("{placed} parts are joined over {photos} shared photographs and {inliers} agreeing {what}");
        let in_city = network.anchored.iter().filter(|used| **used).count();
        let reason = match (used.is_empty(), in_city) {
            (true, _) => stands_in_city(placed, network),
            (false, 0) => over,
            (false, anchors) => format!("{over}, and {anchors} stand in the city by themselves"),
        };
        return (MergeVerdict::Merged, reason);
    }
    if placed > 1 {
        return (
            MergeVerdict::Partial,
            format!("{placed} of {} parts are joined; left out: {}", places.len(), names()),
        );
    }
    if let Some(reason) = &network.ambiguity {
        return (MergeVerdict::Ambiguous, reason.to_string());
    }
    let in_city = |verdict| network.parts.iter().any(|p| p.part.anchor.as_ref().is_some_and(|a| a.verdict == verdict));
    if in_city(Verdict::Ambiguous) {
        return (MergeVerdict::Ambiguous, format!("parts stand in the city in more than one way: {}", names()));
    }
    let open = network.pairs.iter().any(|l| matches!(l.decision, PairDecision::Open(_)));
    if open || in_city(Verdict::Undetermined) {
        return (MergeVerdict::Undetermined, format!("how the parts stand to each other is not fixed: {}", names()));
    }
    (MergeVerdict::Failed, format!("nothing joins any two parts: {}", names()))
}

fn stands_in_city(placed: usize, network: &Network<'_>) -> String {
    let overlaps = network.pairs.iter().filter(|l| l.edge.is_used() && l.edge.source == EdgeSource::City);
    match overlaps.map(|l| l.edge.inliers).sum() {
        0 => format!("each of {placed} parts stands in the city by itself"),
        inliers => format!(
            "{placed} parts stand in the city and are held to each other by {inliers} points on surfaces that two of them see"
        ),
    }
}
