//! What is told of every part: its place, or where it would fit best and why it has none.

use std::collections::BTreeSet;

use super::adjustment::Held;
use super::freedoms::{in_a_parts_frame, in_the_city};
use super::graph::Network;
use crate::geometry::Similarity;
use crate::merging::outcome::{PartPlace, PartSupport};
use crate::merging::pairwise::{Pair, PairDecision};
use crate::robust::{Matrix7, MotionParameters};
use crate::verdict::Freedom;

/// All parts in the order given; `held`: how firmly the adjustment holds those that it moved.
pub(super) fn places(network: &Network<'_>, poses: &[Option<Similarity>], held: &[Option<Held>]) -> Vec<PartPlace> {
    let candidates = candidates(network, poses);
    let is_in_city = network.anchored.contains(&true);
    let place = |p: usize| PartPlace {
        name: network.parts[p].name().to_owned(),
        merged_from_part: poses[p],
        best_candidate: candidates[p],
        reason: poses[p].is_none().then(|| why_not(p, network)),
        freedoms: match (&held[p], poses[p]) {
            (Some(held), _) if is_in_city => in_the_city(held, &network.limits.verdict),
            (Some(held), _) => in_a_parts_frame(held, network.limits),
            (None, Some(_)) => Vec::new(),
            (None, None) => loose_freedoms(p, network, candidates[p]),
        },
        support: support(p, network),
    };
    (0..poses.len()).map(place).collect()
}

fn support(part: usize, network: &Network<'_>) -> PartSupport {
    let given = network.parts[part].part;
    let own = || network.pairs.iter().map(|l| &l.edge).filter(|e| e.is_used() && e.touches(part));
    let photos: BTreeSet<&String> = own().flat_map(|e| &e.shared_photos).collect();
    PartSupport {
        images: given.sfm.images.len(),
        points: given.sfm.points.len(),
        edges: own().count(),
        shared_photos: photos.len(),
        inliers: own().map(|e| e.inliers).sum(),
        city: given.anchor.as_ref().map(|a| a.support.clone()),
    }
}

/// What is known of a part that has no place: as the city sees it, or as the edge that suggests its place.
fn loose_freedoms(part: usize, network: &Network<'_>, candidate: Option<Similarity>) -> Vec<Freedom> {
    if let Some(anchor) = &network.parts[part].part.anchor {
        return anchor.freedoms.clone();
    }
    let Some(pose) = candidate else { return Vec::new() };
    let is_open = |l: &&Pair| matches!(l.decision, PairDecision::Open(_)) && l.edge.a.max(l.edge.b) == part;
    let Some((pair, fit)) = network.pairs.iter().find(is_open).and_then(|l| Some((l, l.fit.as_ref()?))) else {
        return Vec::new();
    };
    // The unknowns are in the frame of the edge's first part, which is the common one or this part's own.
    let common_from_own = if pair.edge.a == part { pose } else { Similarity::identity() };
    let parameters = MotionParameters::of_similarity(
        common_from_own.apply(&fit.parameters.center),
        common_from_own.scale * fit.parameters.radius,
    );
    let information = turned(&fit.information, &common_from_own);
    in_a_parts_frame(&Held { parameters, information }, network.limits)
}

/// Information in the unknowns of another frame.
fn turned(information: &Matrix7, to_from: &Similarity) -> Matrix7 {
    let mut turn = Matrix7::identity();
    turn.fixed_view_mut::<3, 3>(0, 0).copy_from(to_from.rotation.matrix());
    turn.fixed_view_mut::<3, 3>(3, 3).copy_from(to_from.rotation.matrix());
    turn * information * turn.transpose() / (to_from.scale * to_from.scale)
}

/// Where parts that are not placed would fit best: anchors that are not determined, and open edges.
fn candidates(network: &Network<'_>, poses: &[Option<Similarity>]) -> Vec<Option<Similarity>> {
    let anchor = |p: usize| network.parts[p].part.anchor.as_ref().map(|a| a.common_from_part);
    let mut found: Vec<Option<Similarity>> = (0..poses.len()).map(|p| poses[p].map_or(anchor(p), |_| None)).collect();
    for pair in network.pairs.iter().filter(|l| matches!(l.decision, PairDecision::Open(_))) {
        let (Some(fit), a, b) = (&pair.fit, pair.edge.a, pair.edge.b) else { continue };
        let (first, second, second_from_first) = match a < b {
            true => (a, b, fit.a_from_b),
            false => (b, a, fit.a_from_b.inverse()),
        };
        if poses.iter().all(Option::is_none) && found.iter().all(Option::is_none) {
            found[first] = Some(Similarity::identity());
            found[second] = Some(second_from_first);
        }
    }
    found
}

fn why_not(part: usize, network: &Network<'_>) -> String {
    if let Some(fault) = &network.anchor_faults[part] {
        return fault.to_string();
    }
    if let Some(anchor) = network.parts[part].part.anchor.as_ref().filter(|a| !a.is_determined()) {
        return anchor.reason.clone();
    }
    let own: Vec<&Pair> = network.pairs.iter().filter(|l| l.edge.touches(part)).collect();
    let other = |l: &Pair| if l.edge.a == part { l.edge.b } else { l.edge.a };
    let told: Vec<String> = own
        .iter()
        .filter_map(|l| Some(format!("with {}: {}", network.parts[other(l)].name(), l.edge.reason()?)))
        .collect();
    if told.is_empty() {
        return "it shares no photograph (by name) with the other parts; give a city and a start, or a photograph that both show"
            .to_owned();
    }
    told.join("; ")
}
