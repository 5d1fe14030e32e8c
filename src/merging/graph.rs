//! All parts at once: which edges hold, where every part stands.
//!
//! Method       the strongest edges that join everything (greatest spanning tree by inliers) give the start; every further edge closes
//!              a cycle and must agree with it, or the edge that the others contradict is left out by name; then all similarities are adjusted together to all edges that agree, each with its
//!              own information (Gauss-Newton, weights that bound an edge's pull)

use nalgebra::{DMatrix, DVector};

use super::judge::Opinion;
use super::pairwise::{Edge, EdgeSource, Link};
use super::sigma::extent;
use super::{MergeVerdict, Part, PartPlace};
use crate::geometry::{Point3, Similarity};
use crate::robust::{Chart, Vector7};

/// A cycle that does not close to this share of the scene's radius has a wrong edge in it.
const CYCLE_GAP: f64 = 0.05;
/// What an edge of a cycle with an unknown wrong edge is told by.
const CYCLE_OPEN: &str = "a cycle does not close";
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
    let place = |links: &[Link]| {
        let mut poses = anchored(parts);
        spread(&mut poses, links, parts, order);
        poses
    };
    let mut poses = settle(&mut links, parts, &place);
    retire_unplaced(&poses, &mut links);
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

/// How far a motion carries a scene, as a share of its radius: turned, shifted and scaled.
fn motion_share(motion: &Similarity, center: &Point3<f64>, radius: f64) -> f64 {
    let shift = (motion.apply(center) - center).norm() / radius;
    motion.rotation.angle().hypot(shift).hypot(motion.scale.ln())
}

/// The edges in use that do not close their cycle.
fn contradictions(poses: &[Option<Similarity>], links: &[Link]) -> Vec<usize> {
    let is_open = |l: &Link| gap_share(poses, l).is_some_and(|share| share > CYCLE_GAP);
    (0..links.len()).filter(|&i| links[i].edge.used && is_open(&links[i])).collect()
}

fn gap_share(poses: &[Option<Similarity>], link: &Link) -> Option<f64> {
    let (unknowns, radius) = gap(link, &poses[link.edge.a]?, &poses[link.edge.b]?)?;
    Some(unknowns.norm() / radius)
}

/// Places the parts without the edges that contradict the others. A cycle that does not close says that one of its edges is
/// wrong, but only the other cycles say which one: where several are as likely, the parts whose place hangs on the choice
/// get none. `place` carries places along the edges in use.
fn settle(
    links: &mut [Link],
    parts: &[Part],
    place: &dyn Fn(&[Link]) -> Vec<Option<Similarity>>,
) -> Vec<Option<Similarity>> {
    let mut poses = place(links);
    let mut doubtful = vec![false; parts.len()];
    while !contradictions(&poses, links).is_empty() {
        let suspects = suspects(links, &poses, place);
        let Some((weakest, settled)) = suspects.first().cloned() else { break };
        for (_, other) in &suspects[1..] {
            (0..parts.len()).for_each(|p| doubtful[p] |= differs(&parts[p], settled[p], other[p]));
        }
        let edge = &mut links[weakest].edge;
        edge.used = false;
        let names = format!("{} and {}", parts[edge.a].name, parts[edge.b].name);
        let share = gap_share(&settled, &links[weakest]).unwrap_or(f64::INFINITY);
        links[weakest].edge.reason = Some(match suspects.len() {
            1 => format!("puts {names} {:.1} % of the extent off from where the other edges put them", 50.0 * share),
            n => format!(
                "{CYCLE_OPEN}: the edges round {names} disagree by {:.1} % of the extent, and any of {n} may be the wrong one; \
                 a further shared photograph would tell",
                50.0 * share
            ),
        });
        poses = settled;
    }
    (0..parts.len()).map(|p| poses[p].filter(|_| !doubtful[p])).collect()
}

/// The edges without which fewest contradictions are left, the weakest first, each with the places that the others give.
fn suspects(
    links: &[Link],
    poses: &[Option<Similarity>],
    place: &dyn Fn(&[Link]) -> Vec<Option<Similarity>>,
) -> Vec<(usize, Vec<Option<Similarity>>)> {
    let placed = |poses: &[Option<Similarity>]| poses.iter().flatten().count();
    let mut trials = Vec::new();
    for index in (0..links.len()).filter(|&i| links[i].edge.used) {
        let mut others = links.to_vec();
        others[index].edge.used = false;
        let without = place(&others);
        // An edge without which a part has no place at all is in no cycle.
        let is_in_cycle = placed(&without) == placed(poses);
        // One that agrees with the places of the others is not to blame.
        let is_off = gap_share(&without, &links[index]).is_some_and(|share| share > CYCLE_GAP);
        if is_in_cycle && is_off {
            trials.push((contradictions(&without, &others).len(), links[index].edge.inliers, index, without));
        }
    }
    trials.sort_by_key(|(left, inliers, index, _)| (*left, *inliers, *index));
    let fewest = trials.first().map(|t| t.0);
    trials.into_iter().filter(|t| Some(t.0) == fewest).map(|(_, _, index, without)| (index, without)).collect()
}

fn differs(part: &Part, one: Option<Similarity>, other: Option<Similarity>) -> bool {
    let (Some(one), Some(other)) = (one, other) else { return one.is_some() != other.is_some() };
    let (center, radius) = extent(&part.sfm.points);
    motion_share(&(one.inverse() * other), &center, radius) > CYCLE_GAP
}

/// Edges whose parts were not placed carry nothing.
fn retire_unplaced(poses: &[Option<Similarity>], links: &mut [Link]) {
    for link in links.iter_mut().filter(|l| l.edge.used) {
        if poses[link.edge.a].is_none() || poses[link.edge.b].is_none() {
            link.edge.used = false;
            link.edge.reason = Some("its parts belong to another group than the one that was placed".into());
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
    let in_cycle = |l: &&Link| l.edge.reason.as_ref().is_some_and(|r| r.starts_with(CYCLE_OPEN));
    if let Some(reason) = links.iter().find(in_cycle).and_then(|l| l.edge.reason.clone()) {
        return (MergeVerdict::Ambiguous, reason);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation3, Vector3};
    use crate::merging::fit::Fit;
    use crate::reconstruction::Reconstruction;
    use crate::robust::Matrix7;

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
        let chart = Chart {
            center: world_from_part(a).inverse().apply(&Point3::origin()),
            radius: 1.7 / world_from_part(a).scale,
        };
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
}
