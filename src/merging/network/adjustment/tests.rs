use super::super::tests::{pair, part, shifted};
use super::*;
use crate::geometry::Point3;
use crate::merging::limits::MergeLimits;
use crate::merging::part::Part;
use crate::merging::prepared::PreparedPart;
use crate::random::Random;

/// The robust sum that the adjustment makes least: `c ln(1 + q / c)` of every edge, q its squared sigmas and c seven gates squared; its
/// slope is the weight.
fn loss(network: &Network<'_>, poses: &[Option<Similarity>]) -> f64 {
    let c = 7.0 * network.limits.network.pull_sigmas.powi(2);
    let of = |edge: EdgeId| {
        let (miss, information) = (network.miss(poses, edge).unwrap(), network.information(edge).unwrap());
        c * (miss.dot(&(information * miss)) / c).ln_1p()
    };
    network.edges(None).map(of).sum()
}

#[test]
fn no_motion_of_a_part_makes_the_sum_of_all_edges_less() {
    let limits = MergeLimits::default();
    let given: Vec<Part> = (0..4).map(part).collect();
    let parts: Vec<PreparedPart<'_>> = given.iter().map(|part| PreparedPart::of(part, &limits)).collect();
    let order: Vec<usize> = (0..4).collect();
    let mut random = Random::stream(52, 0);
    for _ in 0..5 {
        let mut pairs = Vec::new();
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let error = MotionParameters::of_similarity(Point3::origin(), 1.7)
                .moved(&Similarity::identity(), &Vector7::from_fn(|_, _| 0.004 * random.normal()));
            pairs.push(pair(a, b, 50, &error));
        }
        let network = Network::new(&parts, &order, pairs, &limits);
        let mut poses = network.place(None).poses;
        let before = loss(&network, &poses);
        let held = adjust(&network, &mut poses);
        let least = loss(&network, &poses);
        assert!(least < before);
        assert!(held[0].is_none() && held[1..].iter().all(Option::is_some), "the first part is the frame");
        for p in 1..4 {
            let parameters = held[p].as_ref().unwrap().parameters;
            for k in 0..7 {
                for step in [-1e-4, 1e-4] {
                    let mut unknowns = Vector7::zeros();
                    unknowns[k] = step;
                    let mut other = poses.clone();
                    other[p] = poses[p].map(|pose| parameters.moved(&pose, &unknowns));
                    assert!(loss(&network, &other) > least, "part {p}, unknown {k}");
                }
            }
        }
    }
}

#[test]
fn what_holds_a_part_is_the_curvature_of_the_sum_with_all_others_free() {
    let limits = MergeLimits::default();
    let given: Vec<Part> = (0..3).map(part).collect();
    let parts: Vec<PreparedPart<'_>> = given.iter().map(|part| PreparedPart::of(part, &limits)).collect();
    let order: Vec<usize> = (0..3).collect();
    // A chain of equal edges: the last part is known half as well, as a variance, as the one before it.
    let pairs = [(0, 1), (1, 2)].map(|(a, b)| pair(a, b, 50, &shifted(0.0)));
    let network = Network::new(&parts, &order, pairs.into(), &limits);
    let mut poses = network.place(None).poses;
    let held = adjust(&network, &mut poses);
    let sigma = |p: usize| {
        let held = held[p].as_ref().unwrap();
        let covariance = held.information.try_inverse().unwrap();
        // Shifts alone: the same unit in the merged frame, which is the first part's.
        covariance.fixed_view::<3, 3>(3, 3).trace().sqrt()
    };
    assert!(sigma(2) > 1.2 * sigma(1), "{} {}", sigma(1), sigma(2));
}
