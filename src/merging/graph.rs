//! All parts at once: which ties hold, where every part stands, and what that makes the whole.

use super::adjust::{Held, adjust};
use super::cycles::Network;
use super::judge::Opinion;
use super::meeting::meetings;
use super::pairwise::{Edge, EdgeSource, Link};
use super::{MergeVerdict, Part, PartPlace, PartSupport, freedoms};
use crate::geometry::Similarity;
use crate::robust::{Chart, Matrix7};
use crate::verdict::{Freedom, Verdict};

pub(super) struct Solved {
    pub verdict: MergeVerdict,
    pub reason: String,
    pub frame: String,
    pub in_city: bool,
    pub places: Vec<PartPlace>,
    pub edges: Vec<Edge>,
}

pub(super) fn solve(parts: &[Part], order: &[usize], links: Vec<Link>) -> Solved {
    let mut network = Network::new(parts, order, links);
    let mut poses = network.settle();
    network.retire_unplaced(&poses);
    let meetings = meetings(&network, &poses);
    network.links.extend(meetings);
    let held = adjust(&network, &mut poses);
    let candidates = candidates(parts, &poses, &network.links);
    let in_city = network.anchored.contains(&true);
    let frame = match parts.iter().zip(&poses).find(|(_, pose)| pose.is_some()) {
        Some(_) if in_city => "the city's".to_owned(),
        Some((part, _)) => format!("{}'s", part.name),
        None => "none".to_owned(),
    };
    let place = |p: usize| PartPlace {
        name: parts[p].name.clone(),
        merged_from_part: poses[p],
        best_candidate: candidates[p],
        reason: poses[p].is_none().then(|| why_not(p, &network)),
        freedoms: match (&held[p], poses[p]) {
            (Some(held), _) if in_city => freedoms::in_the_city(held),
            (Some(held), _) => freedoms::in_a_parts_frame(held),
            (None, Some(_)) => Vec::new(),
            (None, None) => loose_freedoms(p, parts, &candidates, &network.links),
        },
        support: support(p, parts, &network.links),
    };
    let places: Vec<PartPlace> = (0..parts.len()).map(place).collect();
    let (verdict, reason) = verdict(&places, &network);
    Solved { verdict, reason, frame, in_city, places, edges: edges(&poses, network) }
}

fn support(part: usize, parts: &[Part], links: &[Link]) -> PartSupport {
    let own = || links.iter().map(|l| &l.edge).filter(|e| e.used && (e.a == part || e.b == part));
    let photos: std::collections::BTreeSet<&String> = own().flat_map(|e| &e.shared_photos).collect();
    PartSupport {
        images: parts[part].sfm.images.len(),
        points: parts[part].sfm.points.len(),
        edges: own().count(),
        shared_photos: photos.len(),
        inliers: own().map(|e| e.inliers).sum(),
        city: parts[part].anchor.as_ref().map(|a| a.support.clone()),
    }
}

fn stands_in_city(placed: usize, network: &Network<'_>) -> String {
    let meetings = network.links.iter().filter(|l| l.edge.used && l.edge.source == EdgeSource::City);
    match meetings.map(|l| l.edge.inliers).sum() {
        0 => format!("each of {placed} parts stands in the city by itself"),
        inliers => format!(
            "{placed} parts stand in the city and are held to each other by {inliers} points on surfaces that two of them see"
        ),
    }
}

/// What is known of a part that has no place: as the city sees it, or as the edge that suggests its place.
fn loose_freedoms(part: usize, parts: &[Part], candidates: &[Option<Similarity>], links: &[Link]) -> Vec<Freedom> {
    if let Some(anchor) = &parts[part].anchor {
        return anchor.freedoms.clone();
    }
    let Some(pose) = candidates[part] else { return Vec::new() };
    let is_open = |l: &&Link| matches!(l.opinion, Opinion::Open(_)) && l.edge.a.max(l.edge.b) == part;
    let Some((link, fit)) = links.iter().find(is_open).and_then(|l| Some((l, l.fit.as_ref()?))) else {
        return Vec::new();
    };
    // The unknowns are in the frame of the edge's first part, which is the common one or this part's own.
    let common_from_chart = if link.edge.a == part { pose } else { Similarity::identity() };
    let chart =
        Chart::of_similarity(common_from_chart.apply(&fit.chart.center), common_from_chart.scale * fit.chart.radius);
    let information = turned(&fit.information, &common_from_chart);
    freedoms::in_a_parts_frame(&Held { chart, information })
}

/// Information in the unknowns of another frame.
fn turned(information: &Matrix7, to_from: &Similarity) -> Matrix7 {
    let mut turn = Matrix7::identity();
    turn.fixed_view_mut::<3, 3>(0, 0).copy_from(to_from.rotation.matrix());
    turn.fixed_view_mut::<3, 3>(3, 3).copy_from(to_from.rotation.matrix());
    turn * information * turn.transpose() / (to_from.scale * to_from.scale)
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

fn why_not(part: usize, network: &Network<'_>) -> String {
    let Network { parts, links, anchor_faults, .. } = network;
    if let Some(fault) = &anchor_faults[part] {
        return fault.clone();
    }
    if let Some(anchor) = parts[part].anchor.as_ref().filter(|a| !a.is_determined()) {
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

fn verdict(places: &[PartPlace], network: &Network<'_>) -> (MergeVerdict, String) {
    let placed = places.iter().filter(|p| p.merged_from_part.is_some()).count();
    let names = || {
        let left: Vec<String> =
            places.iter().filter_map(|p| p.reason.as_ref().map(|reason| format!("{} ({reason})", p.name))).collect();
        left.join(", ")
    };
    if placed == places.len() && placed > 1 {
        let is_shared = |l: &&Link| l.edge.used && l.edge.source != EdgeSource::City;
        let used: Vec<&Link> = network.links.iter().filter(is_shared).collect();
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
        return (MergeVerdict::Ambiguous, reason.clone());
    }
    let in_city = |verdict| network.parts.iter().any(|p| p.anchor.as_ref().is_some_and(|a| a.verdict == verdict));
    if in_city(Verdict::Ambiguous) {
        return (MergeVerdict::Ambiguous, format!("parts stand in the city in more than one way: {}", names()));
    }
    let open = network.links.iter().any(|l| matches!(l.opinion, Opinion::Open(_)));
    if open || in_city(Verdict::Undetermined) {
        return (MergeVerdict::Undetermined, format!("how the parts stand to each other is not fixed: {}", names()));
    }
    (MergeVerdict::Failed, format!("nothing joins any two parts: {}", names()))
}

/// Edges for the report, lengths in the merged frame, and one for every pair that meets only through the city.
fn edges(poses: &[Option<Similarity>], network: Network<'_>) -> Vec<Edge> {
    let Network { parts, links, anchored: in_use, anchor_faults, .. } = network;
    let mut edges: Vec<Edge> = links
        .into_iter()
        .map(|link| {
            let scale = poses[link.edge.a].map_or(1.0, |pose| pose.scale);
            Edge { rms: link.edge.rms * scale, ..link.edge }
        })
        .collect();
    let anchored: Vec<usize> = (0..parts.len()).filter(|&p| parts[p].anchor.is_some()).collect();
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
            used: pair.iter().all(|&p| in_use[p]),
            reason: match pair.iter().all(|&p| in_use[p]) {
                true => None,
                false => Some(fault.unwrap_or_else(|| "the city does not fix both parts".to_owned())),
            },
        });
    }
    edges.iter_mut().for_each(|e| (e.a, e.b) = (e.a.min(e.b), e.a.max(e.b)));
    edges.sort_by_key(|e| (e.a, e.b));
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Rotation3, Vector3};
    use crate::merging::Anchor;
    use crate::merging::fit::Fit;
    use crate::reconstruction::Reconstruction;

    /// A cloud of radius about one, the same in the world for all parts.
    fn part(k: usize) -> Part {
        let wave = |i: usize, step: f64| 2.0 * (i as f64 * step).fract() - 1.0;
        let x = |i: usize| Point3::new(wave(i, 0.754_877_666), wave(i, 0.569_840_291), wave(i, 0.381_966));
        let points = (0..100 + k).map(|i| world_from_part(k).inverse().apply(&x(i))).collect();
        let sfm = Reconstruction { points, ..Reconstruction::default() };
        Part { name: format!("part {k}"), sfm, superpixels: None, anchor: None }
    }

    fn world_from_part(k: usize) -> Similarity {
        let t = k as f64;
        Similarity {
            scale: 1.0 + 0.3 * t,
            rotation: Rotation3::from_euler_angles(0.3 * t, -0.2 * t, 0.9 * t),
            translation: Vector3::new(t, -2.0 * t, 0.5),
        }
    }

    fn link(a: usize, b: usize, inliers: usize, error: &Similarity) -> Link {
        let edge = Edge {
            a,
            b,
            source: EdgeSource::Tracks,
            shared_photos: vec!["x.jpg".into()],
            pairs: inliers,
            inliers,
            rms: 0.01,
            used: true,
            reason: None,
        };
        let chart =
            Chart::of_similarity(world_from_part(a).inverse().apply(&Point3::origin()), 1.7 / world_from_part(a).scale);
        let fit = Fit {
            a_from_b: world_from_part(a).inverse() * *error * world_from_part(b),
            chart,
            information: Matrix7::identity() * 1e6,
            bend: 1e-3,
            inliers: vec![true; inliers],
            rms: 0.01,
            cameras_used: Vec::new(),
        };
        Link { edge, fit: Some(fit), opinion: Opinion::Together }
    }

    fn shifted(along_x: f64) -> Similarity {
        Similarity { translation: Vector3::new(along_x, 0.0, 0.0), ..Similarity::identity() }
    }

    fn solved(count: usize, links: Vec<Link>) -> Solved {
        let parts: Vec<Part> = (0..count).map(part).collect();
        let order: Vec<usize> = (0..count).rev().collect();
        solve(&parts, &order, links)
    }

    fn assert_placed(found: &Solved, parts: &[usize]) {
        let x = Point3::new(0.2, -0.4, 0.7);
        let root = world_from_part(parts[0]).inverse();
        for &p in parts {
            let pose = found.places[p].merged_from_part.expect("placed");
            let off = pose.apply(&world_from_part(p).inverse().apply(&x)) - root.apply(&x);
            assert!(off.norm() < 1e-6, "part {p} is {} off", off.norm());
        }
    }

    #[test]
    fn names_the_wrong_edge_though_it_is_the_strongest() {
        let mut links = Vec::new();
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let wrong = (a, b) == (1, 2);
            links.push(link(a, b, if wrong { 900 } else { 100 }, &shifted(if wrong { 0.8 } else { 0.0 })));
        }
        let found = solved(4, links);
        assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
        assert_placed(&found, &[0, 1, 2, 3]);
        let unused: Vec<&Edge> = found.edges.iter().filter(|e| !e.used).collect();
        assert_eq!(unused.len(), 1);
        let reason = unused[0].reason.clone().unwrap();
        assert!(reason.contains("part 1 and part 2") && reason.contains('%'), "{reason}");
    }

    #[test]
    fn does_not_choose_which_edge_of_a_lone_cycle_is_wrong() {
        let ring = [(0, 1), (1, 2), (2, 3), (0, 3)];
        let links = ring.iter().map(|&(a, b)| link(a, b, 100 + b, &shifted(if a == 1 { 0.8 } else { 0.0 })));
        let found = solved(4, links.collect());
        assert_eq!(found.verdict, MergeVerdict::Ambiguous, "{}", found.reason);
        assert!(found.places.iter().filter(|p| p.merged_from_part.is_some()).count() < 2);
    }

    #[test]
    fn carries_places_along_a_chain_of_five() {
        let links = (0..4).map(|a| link(a, a + 1, 50 + a, &shifted(0.0))).collect();
        let found = solved(5, links);
        assert_eq!(found.verdict, MergeVerdict::Merged);
        assert_placed(&found, &[0, 1, 2, 3, 4]);
    }

    #[test]
    fn places_the_larger_of_two_islands() {
        let links = vec![link(0, 1, 500, &shifted(0.0)), link(2, 3, 50, &shifted(0.0)), link(3, 4, 50, &shifted(0.0))];
        let found = solved(5, links);
        assert_eq!(found.verdict, MergeVerdict::Partial);
        assert_placed(&found, &[2, 3, 4]);
        assert!(found.places[0].merged_from_part.is_none() && found.places[0].reason.is_some());
    }

    /// The part in the world's frame, `error` off, known to `sigma` in every unknown.
    fn anchored(k: usize, error: &Similarity, sigma: f64) -> Part {
        let anchor = Anchor {
            common_from_part: *error * world_from_part(k),
            verdict: Verdict::Aligned,
            chart: Chart::of_similarity(Point3::origin(), 1.7),
            information: Matrix7::identity() / (sigma * sigma),
            reason: "in the city aligned".into(),
            freedoms: Vec::new(),
            support: crate::verdict::Support::default(),
        };
        Part { anchor: Some(anchor), ..part(k) }
    }

    #[test]
    fn anchors_weigh_by_what_the_city_knows_of_each() {
        let parts = [anchored(0, &shifted(0.0), 0.01), anchored(1, &shifted(0.2), 0.1)];
        let found = solve(&parts, &[1, 0], vec![link(0, 1, 100, &shifted(0.0))]);
        assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
        let x = Point3::new(0.2, -0.4, 0.7);
        for (k, place) in found.places.iter().enumerate() {
            let off = place.merged_from_part.unwrap().apply(&world_from_part(k).inverse().apply(&x)) - x;
            // A hundred times the information against an anchor 0.2 off.
            assert!((off.x - 0.2 / 101.0).abs() < 1e-3 && off.yz().norm() < 1e-3, "part {k} is {off} off");
            assert_eq!(place.freedoms.len(), 7);
        }
    }

    #[test]
    fn an_anchor_that_the_edges_contradict_is_named_or_nothing_is_said() {
        let links = |count: usize| -> Vec<Link> {
            (0..count).flat_map(|b| (0..b).map(move |a| link(a, b, 100, &shifted(0.0)))).collect()
        };
        let off = |k: usize, wrong: usize| anchored(k, &shifted(if k == wrong { 0.9 } else { 0.0 }), 0.02);
        let parts: Vec<Part> = (0..3).map(|k| off(k, 1)).collect();
        let found = solve(&parts, &[2, 1, 0], links(3));
        assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
        let unused: Vec<&Edge> = found.edges.iter().filter(|e| !e.used).collect();
        assert!(unused.iter().all(|e| e.reason.as_ref().unwrap().contains("part 1 and the city")), "{unused:?}");
        let moved = found.places[1].merged_from_part.unwrap() * world_from_part(1).inverse();
        assert!(moved.translation.norm() < 1e-3, "{moved:?}");

        // Two anchors that contradict each other, and edges that all agree: no place, and the reason says so.
        let parts: Vec<Part> = (0..3).map(|k| if k == 2 { part(k) } else { off(k, 1) }).collect();
        let found = solve(&parts, &[2, 1, 0], links(3));
        assert_eq!(found.verdict, MergeVerdict::Ambiguous, "{}", found.reason);
        assert!(found.places.iter().all(|p| p.reason.as_ref().unwrap().contains("a cycle does not close")));

        // One edge and two anchors: any of the three may be wrong.
        let parts: Vec<Part> = (0..2).map(|k| off(k, 1)).collect();
        let found = solve(&parts, &[1, 0], links(2));
        assert_eq!(found.verdict, MergeVerdict::Ambiguous, "{}", found.reason);
    }

    #[test]
    fn a_cycle_misses_by_what_its_edges_leave_open_without_blame() {
        let ring = |information: f64| {
            let ring = [(0, 1), (1, 2), (2, 3), (0, 3)];
            let links = ring.map(|(a, b)| {
                let mut link = link(a, b, 100, &shifted(if a == 1 { 0.2 } else { 0.0 }));
                link.fit.as_mut().unwrap().information = Matrix7::identity() * information;
                link
            });
            solved(4, links.into()).verdict
        };
        assert_eq!(ring(400.0), MergeVerdict::Merged, "0.2 is two of four edges' joint sigmas of 0.1 or more");
        assert_eq!(ring(1e6), MergeVerdict::Ambiguous);
    }
}
