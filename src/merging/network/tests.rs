//! Networks of made-up pairs and anchors.

use super::*;
use crate::geometry::{Point3, Rotation3, Similarity, Vector3};
use crate::merging::outcome::EdgeSource;
use crate::merging::pairwise::{Fit, PairDecision};
use crate::merging::part::{Anchor, Part};
use crate::reconstruction::Reconstruction;
use crate::robust::{Matrix7, MotionParameters};
use crate::verdict::Verdict;

/// A cloud of radius about one, the same in the world for all parts.
pub(super) fn part(k: usize) -> Part {
    let wave = |i: usize, step: f64| 2.0 * (i as f64 * step).fract() - 1.0;
    let x = |i: usize| Point3::new(wave(i, 0.754_877_666), wave(i, 0.569_840_291), wave(i, 0.381_966));
    let points = (0..100 + k).map(|i| world_from_part(k).inverse().apply(&x(i))).collect();
    let sfm = Reconstruction { points, ..Reconstruction::default() };
    Part { name: format!("part {k}"), sfm, superpixels: None, anchor: None }
}

pub(super) fn world_from_part(k: usize) -> Similarity {
    let t = k as f64;
    Similarity {
        scale: 1.0 + 0.3 * t,
        rotation: Rotation3::from_euler_angles(0.3 * t, -0.2 * t, 0.9 * t),
        translation: Vector3::new(t, -2.0 * t, 0.5),
    }
}

pub(super) fn pair(a: usize, b: usize, inliers: usize, error: &Similarity) -> Pair {
    let edge = Edge {
        a,
        b,
        source: EdgeSource::Tracks,
        shared_photos: vec!["x.jpg".into()],
        pairs: inliers,
        inliers,
        rms: 0.01,
        refusal: None,
        note: None,
    };
    let parameters = MotionParameters::of_similarity(
        world_from_part(a).inverse().apply(&Point3::origin()),
        1.7 / world_from_part(a).scale,
    );
    let fit = Fit {
        a_from_b: world_from_part(a).inverse() * *error * world_from_part(b),
        parameters,
        information: Matrix7::identity() * 1e6,
        bend: 1e-3,
        inliers: vec![true; inliers],
        rms: 0.01,
    };
    Pair { edge, fit: Some(fit), decision: PairDecision::Accepted }
}

pub(super) fn shifted(along_x: f64) -> Similarity {
    Similarity { translation: Vector3::new(along_x, 0.0, 0.0), ..Similarity::identity() }
}

fn solved(count: usize, pairs: Vec<Pair>) -> Solved {
    let parts: Vec<Part> = (0..count).map(part).collect();
    let order: Vec<usize> = (0..count).rev().collect();
    solved_in(&parts, &order, pairs)
}

fn solved_in(parts: &[Part], order: &[usize], pairs: Vec<Pair>) -> Solved {
    let limits = MergeLimits::default();
    let parts: Vec<PreparedPart<'_>> = parts.iter().map(|part| PreparedPart::of(part, &limits)).collect();
    solve(&parts, order, pairs, &limits)
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
    let mut pairs = Vec::new();
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        let wrong = (a, b) == (1, 2);
        pairs.push(pair(a, b, if wrong { 900 } else { 100 }, &shifted(if wrong { 0.8 } else { 0.0 })));
    }
    let found = solved(4, pairs);
    assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
    assert_placed(&found, &[0, 1, 2, 3]);
    let unused: Vec<&Edge> = found.edges.iter().filter(|e| !e.is_used()).collect();
    assert_eq!(unused.len(), 1);
    let reason = unused[0].reason().unwrap();
    assert!(reason.contains("part 1 and part 2") && reason.contains('%'), "{reason}");
}

#[test]
fn does_not_choose_which_edge_of_a_lone_cycle_is_wrong() {
    let ring = [(0, 1), (1, 2), (2, 3), (0, 3)];
    let links = ring.iter().map(|&(a, b)| pair(a, b, 100 + b, &shifted(if a == 1 { 0.8 } else { 0.0 })));
    let found = solved(4, links.collect());
    assert_eq!(found.verdict, MergeVerdict::Ambiguous, "{}", found.reason);
    assert!(found.places.iter().filter(|p| p.merged_from_part.is_some()).count() < 2);
}

#[test]
fn carries_places_along_a_chain_of_five() {
    let links = (0..4).map(|a| pair(a, a + 1, 50 + a, &shifted(0.0))).collect();
    let found = solved(5, links);
    assert_eq!(found.verdict, MergeVerdict::Merged);
    assert_placed(&found, &[0, 1, 2, 3, 4]);
}

#[test]
fn places_the_larger_of_two_islands() {
    let links = vec![pair(0, 1, 500, &shifted(0.0)), pair(2, 3, 50, &shifted(0.0)), pair(3, 4, 50, &shifted(0.0))];
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
        parameters: MotionParameters::of_similarity(Point3::origin(), 1.7),
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
    let found = solved_in(&parts, &[1, 0], vec![pair(0, 1, 100, &shifted(0.0))]);
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
    let links = |count: usize| -> Vec<Pair> {
        (0..count).flat_map(|b| (0..b).map(move |a| pair(a, b, 100, &shifted(0.0)))).collect()
    };
    let off = |k: usize, wrong: usize| anchored(k, &shifted(if k == wrong { 0.9 } else { 0.0 }), 0.02);
    let parts: Vec<Part> = (0..3).map(|k| off(k, 1)).collect();
    let found = solved_in(&parts, &[2, 1, 0], links(3));
    assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
    let unused: Vec<&Edge> = found.edges.iter().filter(|e| !e.is_used()).collect();
    assert!(unused.iter().all(|e| e.reason().unwrap().contains("part 1 and the city")), "{unused:?}");
    let moved = found.places[1].merged_from_part.unwrap() * world_from_part(1).inverse();
    assert!(moved.translation.norm() < 1e-3, "{moved:?}");

    // Two anchors that contradict each other, and edges that all agree: no place, and the reason says so.
    let parts: Vec<Part> = (0..3).map(|k| if k == 2 { part(k) } else { off(k, 1) }).collect();
    let found = solved_in(&parts, &[2, 1, 0], links(3));
    assert_eq!(found.verdict, MergeVerdict::Ambiguous, "{}", found.reason);
    assert!(found.places.iter().all(|p| p.reason.as_ref().unwrap().contains("a cycle does not close")));

    // One edge and two anchors: any of the three may be wrong.
    let parts: Vec<Part> = (0..2).map(|k| off(k, 1)).collect();
    let found = solved_in(&parts, &[1, 0], links(2));
    assert_eq!(found.verdict, MergeVerdict::Ambiguous, "{}", found.reason);
}

#[test]
fn a_cycle_misses_by_what_its_edges_leave_open_without_blame() {
    let ring = |information: f64| {
        let ring = [(0, 1), (1, 2), (2, 3), (0, 3)];
        let links = ring.map(|(a, b)| {
            let mut pair = pair(a, b, 100, &shifted(if a == 1 { 0.2 } else { 0.0 }));
            pair.fit.as_mut().unwrap().information = Matrix7::identity() * information;
            pair
        });
        solved(4, links.into()).verdict
    };
    assert_eq!(ring(400.0), MergeVerdict::Merged, "0.2 is two of four edges' joint sigmas of 0.1 or more");
    assert_eq!(ring(1e6), MergeVerdict::Ambiguous);
}
