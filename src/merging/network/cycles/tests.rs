use super::super::tests::{pair, part, shifted};
use super::*;
use crate::merging::limits::MergeLimits;
use crate::merging::pairwise::Pair;
use crate::merging::part::Part;
use crate::merging::prepared::PreparedPart;
use crate::random::Random;

/// A network of six parts with so many random edges, all right.
fn random_pairs(random: &mut Random, count: usize) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    while pairs.len() < count {
        let (a, b) = (random.below(6), random.below(6));
        let is_there = |p: &Pair| p.edge.a == a.min(b) && p.edge.b == a.max(b);
        if a != b && !pairs.iter().any(is_there) {
            pairs.push(pair(a.min(b), a.max(b), 10 + random.below(90), &shifted(0.0)));
        }
    }
    pairs
}

/// All edges on the way from one part to another along edges of the tree, by trying every way.
fn way(tree: &[(usize, usize, usize)], from: usize, to: usize, walked: &mut Vec<usize>) -> Option<Vec<usize>> {
    if from == to {
        return Some(walked.clone());
    }
    for &(index, a, b) in tree {
        let next = if a == from { b } else { a };
        if (a == from || b == from) && !walked.contains(&index) {
            walked.push(index);
            let found = way(tree, next, to, walked);
            walked.pop();
            if found.is_some() {
                return found;
            }
        }
    }
    None
}

#[test]
fn the_cycle_of_an_edge_is_the_only_way_round_through_the_tree() {
    let limits = MergeLimits::default();
    let given: Vec<Part> = (0..6).map(part).collect();
    let order: Vec<usize> = (0..6).collect();
    let mut random = Random::stream(51, 0);
    let mut closed = 0;
    for case in 0..60 {
        let parts: Vec<PreparedPart<'_>> = given.iter().map(|part| PreparedPart::of(part, &limits)).collect();
        let pairs = random_pairs(&mut random, 5 + case % 8);
        let network = Network::new(&parts, &order, pairs, &limits);
        let placement = network.place(None);
        let in_tree: std::collections::BTreeSet<usize> = placement
            .paths
            .iter()
            .flatten()
            .filter_map(|edge| if let EdgeId::Pair(index) = edge { Some(*index) } else { None })
            .collect();
        let of = |index: usize| (index, network.pairs[index].edge.a, network.pairs[index].edge.b);
        let tree: Vec<_> = in_tree.iter().map(|index| of(*index)).collect();
        for index in 0..network.pairs.len() {
            let (_, a, b) = of(index);
            if placement.poses[a].is_none() {
                continue;
            }
            let mut found: Vec<usize> = network
                .cycle(&placement, EdgeId::Pair(index))
                .into_iter()
                .map(|edge| if let EdgeId::Pair(index) = edge { index } else { usize::MAX })
                .collect();
            found.sort_unstable();
            let mut expected =
                if in_tree.contains(&index) { Vec::new() } else { way(&tree, a, b, &mut Vec::new()).unwrap() };
            expected.sort_unstable();
            assert_eq!(found, expected, "edge {a} to {b}");
            closed += usize::from(!expected.is_empty());
        }
    }
    assert!(closed > 100, "{closed}");
}

#[test]
fn edges_that_agree_miss_by_nothing_and_one_that_is_off_by_what_it_is_off() {
    let limits = MergeLimits::default();
    let given: Vec<Part> = (0..4).map(part).collect();
    let parts: Vec<PreparedPart<'_>> = given.iter().map(|part| PreparedPart::of(part, &limits)).collect();
    let order: Vec<usize> = (0..4).collect();
    let of = |off: f64| {
        let ring = [(0, 1, 90), (1, 2, 80), (2, 3, 70), (0, 3, 5)];
        let pairs = ring.map(|(a, b, inliers)| pair(a, b, inliers, &shifted(if b == 3 && a == 0 { off } else { 0.0 })));
        let network = Network::new(&parts, &order, pairs.into(), &limits);
        let placement = network.place(None);
        network.missed(&placement, EdgeId::Pair(3)).unwrap()
    };
    assert!(of(0.0).share < 1e-9 && of(0.0).sigmas < 1e-6);
    // The first part has radius 1.7 in its own unit, which is the world's.
    assert!((of(0.17).share - 0.1).abs() < 1e-9, "{}", of(0.17).share);
    assert!((of(0.34).sigmas / of(0.17).sigmas - 2.0).abs() < 0.01);
}
