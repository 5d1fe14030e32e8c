//! All parts at once: which edges hold, where every part stands.
//!
//! Method       the strongest edges that join everything (greatest spanning tree by inliers) give the start; every further edge closes
//!              a cycle and must agree with it; then all similarities are adjusted together to all edges that agree, each with its
//!              own information (Gauss-Newton, weights that bound an edge's pull)

use nalgebra::{DMatrix, DVector};

use super::judge::Opinion;
use super::pairwise::{Edge, EdgeSource, Link};
use super::sigma::extent;
use super::{MergeVerdict, Part, PartPlace};
use crate::geometry::Similarity;
use crate::robust::{Chart, Vector7};

/// A cycle that does not close to this share of the scene's radius has a wrong edge in it.
const CYCLE_GAP: f64 = 0.05;
/// An edge further off than this many sigmas pulls no harder.
const EDGE_GATE: f64 = 5.0;
const ROUNDS: usize = 20;
const CONVERGED: f64 = 1e-10;
/// Step of numerical derivatives, share of the radius.
const DIFFERENCE: f64 = 1e-6;

pub(super) struct Solved {
    pub verdict: MergeVerdict,
    pub reason: String,
    pub frame: String,
    pub places: Vec<PartPlace>,
    pub edges: Vec<Edge>,
}

pub(super) fn solve(parts: &[Part], order: &[usize], mut links: Vec<Link>) -> Solved {
    let has_anchors = parts.iter().any(|p| p.anchor.is_some());
    let mut poses = anchored(parts);
    spread(&mut poses, &links, parts, order);
    check_cycles(&poses, &mut links);
    adjust(&mut poses, &links, parts);
    let candidates = candidates(parts, &poses, &links);
    let frame = if has_anchors && parts.iter().zip(&poses).any(|(p, t)| p.anchor.is_some() && t.is_some()) {
        "the city's".to_owned()
    } else {
        parts.iter().zip(&poses).find(|(_, t)| t.is_some()).map_or("none".into(), |(p, _)| format!("{}'s", p.name))
    };
    let place = |p: usize| PartPlace {
        name: parts[p].name.clone(),
        merged_from_part: poses[p],
        best_candidate: candidates[p],
        reason: poses[p].is_none().then(|| why_not(p, parts, &links)),
        images: parts[p].sfm.images.len(),
        points: parts[p].sfm.points.len(),
    };
    let places: Vec<PartPlace> = (0..parts.len()).map(place).collect();
    let (verdict, reason) = verdict(&places, &links, parts);
    Solved { verdict, reason, frame, places, edges: edges(parts, &poses, links) }
}

/// The parts that stand in the common frame by themselves; with fewer than two of them, and no edges, nothing is joined.
fn anchored(parts: &[Part]) -> Vec<Option<Similarity>> {
    parts.iter().map(|p| p.anchor.as_ref().filter(|a| a.determined).map(|a| a.common_from_part)).collect()
}

/// Carries places along the strongest edges. Without an anchor the largest group of joined parts is placed, in the frame
/// of the one that was given first.
fn spread(poses: &mut [Option<Similarity>], links: &[Link], parts: &[Part], order: &[usize]) {
    let mut strongest: Vec<&Link> = links.iter().filter(|l| l.edge.used).collect();
    strongest.sort_by_key(|l| std::cmp::Reverse(l.edge.inliers));
    let mut group: Vec<usize> = (0..parts.len()).collect();
    let mut tree: Vec<&Link> = Vec::new();
    for link in strongest {
        let (a, b) = (group[link.edge.a], group[link.edge.b]);
        if a != b {
            group.iter_mut().filter(|g| **g == b).for_each(|g| *g = a);
            tree.push(link);
        }
    }
    if poses.iter().all(Option::is_none) {
        let size = |g: usize| group.iter().filter(|other| **other == g).count();
        let points = |g: usize| -> usize {
            (0..parts.len()).filter(|p| group[*p] == g).map(|p| parts[p].sfm.points.len()).sum()
        };
        // The last of equals is taken, so the canonical order is walked backwards.
        let largest = order.iter().rev().map(|p| group[*p]).max_by_key(|g| (size(*g), points(*g)));
        if let Some(g) = largest.filter(|g| size(*g) > 1) {
            let root = (0..parts.len()).find(|p| group[*p] == g).unwrap_or(0);
            poses[root] = Some(Similarity::identity());
        }
    }
    // Each sweep reaches at least one further part.
    for _ in 0..parts.len() {
        for link in &tree {
            let Some(fit) = &link.fit else { continue };
            match (poses[link.edge.a], poses[link.edge.b]) {
                (Some(a), None) => poses[link.edge.b] = Some(a * fit.a_from_b),
                (None, Some(b)) => poses[link.edge.a] = Some(b * fit.a_from_b.inverse()),
                _ => {}
            }
        }
    }
}

/// How far an edge is from what the places say, in its chart's unknowns.
fn gap(link: &Link, a: &Similarity, b: &Similarity) -> Option<(Vector7, f64)> {
    let fit = link.fit.as_ref()?;
    let motion = (a.inverse() * *b) * fit.a_from_b.inverse();
    let (center, radius) = (fit.chart.center, fit.chart.radius);
    let turn = motion.rotation.scaled_axis() * radius;
    let shift = motion.apply(&center) - center;
    let scale = motion.scale.ln() * radius;
    Some((Vector7::from_column_slice(&[turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, scale]), radius))
}

fn check_cycles(poses: &[Option<Similarity>], links: &mut [Link]) {
    for link in links.iter_mut().filter(|l| l.edge.used) {
        let (Some(a), Some(b)) = (poses[link.edge.a], poses[link.edge.b]) else {
            link.edge.used = false;
            link.edge.reason = Some("its parts belong to another group than the one that was placed".into());
            continue;
        };
        let Some((unknowns, radius)) = gap(link, &a, &b) else { continue };
        let share = unknowns.norm() / radius;
        if share > CYCLE_GAP {
            link.edge.used = false;
            let reason = format!("contradicts the stronger edges by {:.1} % of the extent", 50.0 * share);
            link.edge.reason = Some(reason);
        }
    }
}

/// Least squares over all similarities; the anchors, or else the first placed part, stay.
fn adjust(poses: &mut [Option<Similarity>], links: &[Link], parts: &[Part]) {
    let any_anchor = parts.iter().any(|p| p.anchor.as_ref().is_some_and(|a| a.determined));
    let first = poses.iter().position(Option::is_some);
    let is_fixed = |p: usize| match any_anchor {
        true => parts[p].anchor.as_ref().is_some_and(|a| a.determined),
        false => Some(p) == first,
    };
    let free: Vec<usize> = (0..parts.len()).filter(|&p| poses[p].is_some() && !is_fixed(p)).collect();
    let used: Vec<&Link> = links.iter().filter(|l| l.edge.used).collect();
    if free.is_empty() || used.len() <= free.len() && !any_anchor {
        // A tree has no contradictions to share out.
        return;
    }
    let charts: Vec<Chart> = (0..parts.len())
        .map(|p| {
            let (center, radius) = extent(&parts[p].sfm.points);
            let pose = poses[p].unwrap_or_else(Similarity::identity);
            Chart { center: pose.apply(&center), radius: pose.scale * radius }
        })
        .collect();
    for _ in 0..ROUNDS {
        let Some(step) = joint_step(poses, &used, &free, &charts) else { return };
        let mut largest: f64 = 0.0;
        for (k, &p) in free.iter().enumerate() {
            let own = Vector7::from_iterator(step.rows(7 * k, 7).iter().copied());
            largest = largest.max(own.norm() / charts[p].radius);
            poses[p] = poses[p].map(|pose| charts[p].moved(&pose, &own));
        }
        if largest < CONVERGED {
            return;
        }
    }
}

fn joint_step(poses: &[Option<Similarity>], used: &[&Link], free: &[usize], charts: &[Chart]) -> Option<DVector<f64>> {
    let size = 7 * free.len();
    let (mut information, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for link in used {
        let (Some(a), Some(b), Some(fit)) = (poses[link.edge.a], poses[link.edge.b], &link.fit) else { continue };
        let Some((residual, _)) = gap(link, &a, &b) else { continue };
        let mut jacobian = DMatrix::zeros(7, size);
        for (k, &p) in free.iter().enumerate() {
            for column in 0..7 {
                let mut nudge = Vector7::zeros();
                nudge[column] = DIFFERENCE * charts[p].radius;
                let moved = match p {
                    p if p == link.edge.a => gap(link, &charts[p].moved(&a, &nudge), &b),
                    p if p == link.edge.b => gap(link, &a, &charts[p].moved(&b, &nudge)),
                    _ => None,
                };
                if let Some((nudged, _)) = moved {
                    jacobian.set_column(7 * k + column, &((nudged - residual) / nudge[column]));
                }
            }
        }
        let off = residual.dot(&(fit.information * residual)).max(0.0);
        let weight = (1.0 + off / (7.0 * EDGE_GATE * EDGE_GATE)).recip();
        let weighted = DMatrix::from_iterator(7, 7, (fit.information * weight).iter().copied());
        information += jacobian.transpose() * &weighted * &jacobian;
        gradient += jacobian.transpose() * &weighted * DVector::from_iterator(7, residual.iter().copied());
    }
    information.cholesky().map(|c| -c.solve(&gradient))
}

/// Where parts that are not placed would fit best: anchors that are not determined, and open edges.
fn candidates(parts: &[Part], poses: &[Option<Similarity>], links: &[Link]) -> Vec<Option<Similarity>> {
    let anchor = |p: usize| parts[p].anchor.as_ref().map(|a| a.common_from_part);
    let mut found: Vec<Option<Similarity>> = (0..parts.len()).map(|p| poses[p].map_or(anchor(p), |_| None)).collect();
    for link in links.iter().filter(|l| matches!(l.opinion, Opinion::Open(_))) {
        let (Some(fit), a, b) = (&link.fit, link.edge.a, link.edge.b) else { continue };
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

fn why_not(part: usize, parts: &[Part], links: &[Link]) -> String {
    if let Some(anchor) = parts[part].anchor.as_ref().filter(|a| !a.determined) {
        return anchor.reason.clone();
    }
    let own: Vec<&Link> = links.iter().filter(|l| l.edge.a == part || l.edge.b == part).collect();
    let other = |l: &Link| if l.edge.a == part { l.edge.b } else { l.edge.a };
    let told: Vec<String> = own
        .iter()
        .filter_map(|l| Some(format!("with {}: {}", parts[other(l)].name, l.edge.reason.as_ref()?)))
        .collect();
    if told.is_empty() {
        return "it shares no photograph (by name) with the other parts; give a city and a start, or a photograph that both show"
            .to_owned();
    }
    told.join("; ")
}

fn verdict(places: &[PartPlace], links: &[Link], parts: &[Part]) -> (MergeVerdict, String) {
    let placed = places.iter().filter(|p| p.merged_from_part.is_some()).count();
    let names = || {
        let left: Vec<String> =
            places.iter().filter_map(|p| p.reason.as_ref().map(|reason| format!("{} ({reason})", p.name))).collect();
        left.join(", ")
    };
    if placed == places.len() && placed > 1 {
        let used: Vec<&Link> = links.iter().filter(|l| l.edge.used).collect();
        let inliers: usize = used.iter().map(|l| l.edge.inliers).sum();
        let photos: usize = used.iter().map(|l| l.edge.shared_photos.len()).sum();
        let reason =
            format!("{placed} parts are joined over {photos} shared photographs and {inliers} agreeing point pairs");
        return (MergeVerdict::Merged, reason);
    }
    if placed > 1 {
        return (
            MergeVerdict::Partial,
            format!("{placed} of {} parts are joined; left out: {}", places.len(), names()),
        );
    }
    let open = links.iter().any(|l| matches!(l.opinion, Opinion::Open(_)));
    let loose_anchor = parts.iter().any(|p| p.anchor.as_ref().is_some_and(|a| !a.determined));
    if open || loose_anchor {
        return (MergeVerdict::Undetermined, format!("how the parts stand to each other is not fixed: {}", names()));
    }
    (MergeVerdict::Failed, format!("nothing joins any two parts: {}", names()))
}

/// Edges for the report, lengths in the merged frame, and one for every pair that meets only through the city.
fn edges(parts: &[Part], poses: &[Option<Similarity>], links: Vec<Link>) -> Vec<Edge> {
    let mut edges: Vec<Edge> = links
        .into_iter()
        .map(|link| {
            let scale = poses[link.edge.a].map_or(1.0, |pose| pose.scale);
            Edge { rms: link.edge.rms * scale, ..link.edge }
        })
        .collect();
    let anchored: Vec<usize> = (0..parts.len()).filter(|&p| parts[p].anchor.is_some()).collect();
    for pair in anchored.windows(2) {
        let determined = pair.iter().all(|&p| parts[p].anchor.as_ref().is_some_and(|a| a.determined));
        edges.push(Edge {
            a: pair[0],
            b: pair[1],
            source: EdgeSource::City,
            shared_photos: Vec::new(),
            pairs: 0,
            inliers: 0,
            rms: 0.0,
            used: determined,
            reason: (!determined).then(|| "the city does not fix both parts".to_owned()),
        });
    }
    edges.iter_mut().for_each(|e| (e.a, e.b) = (e.a.min(e.b), e.a.max(e.b)));
    edges.sort_by_key(|e| (e.a, e.b));
    edges
}
