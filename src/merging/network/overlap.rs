//! Parts that overlap in the city alone, held to each other by the surfaces that both see.
//!
//! Question     how do two parts stand to each other that share no photograph, but stand in the city side by side?
//! Input        the parts and their places in the city
//! Output       an edge for each such pair whose surfaces say something
//! Method       patches of either part take the other's points that lie among them, and a least squares moves the one along what
//!              these planes hold; what they leave open stays with the city. Surfaces further apart than parts bend are not used
//! Fails when   the parts see no surface in common: then there is no edge, and each stands by itself

use super::graph::Network;
use crate::geometry::Similarity;
use crate::merging::fault::{EdgeFault, PairFault};
use crate::merging::limits::MergeLimits;
use crate::merging::outcome::{Edge, EdgeSource};
use crate::merging::pairwise::{OwnFit, Pair, PairDecision, SharedPlanes, settle_planes, whole_planes};
use crate::merging::prepared::PreparedPart;

/// Pairs of placed parts that overlap in the city and that no edge joins yet.
pub(super) fn overlaps(network: &Network<'_>, poses: &[Option<Similarity>]) -> Vec<Pair> {
    let is_joined = |a: usize, b: usize| network.pairs.iter().any(|p| p.edge.touches(a) && p.edge.touches(b));
    let mut found = Vec::new();
    for (i, &a) in network.order.iter().enumerate() {
        for &b in &network.order[i + 1..] {
            let both_stand = network.anchored[a] && network.anchored[b];
            if let (Some(pose_a), Some(pose_b), true) = (poses[a], poses[b], both_stand && !is_joined(a, b)) {
                found.extend(overlap(network.parts, [a, b], &(pose_a.inverse() * pose_b), network.limits));
            }
        }
    }
    found
}

fn overlap(
    parts: &[PreparedPart<'_>],
    [a, b]: [usize; 2],
    a_from_b: &Similarity,
    limits: &MergeLimits,
) -> Option<Pair> {
    let radius = parts[a].extent.radius;
    let floor = limits.network.edge_floor * radius;
    let planes = whole_planes([&parts[a], &parts[b]], a_from_b, floor, limits)?;
    let OwnFit { fit, .. } = settle_planes(&planes, a_from_b, &limits.fit);
    let off = off_surfaces(&planes, a_from_b);
    let is_close = off < limits.network.overlap_floors * floor;
    let fault = (!is_close).then_some(PairFault::SurfacesApart { off: off / radius });
    let refusal = fault.clone().map(EdgeFault::from);
    let decision = fault.map_or(PairDecision::Accepted, PairDecision::Open);
    let edge = Edge {
        a,
        b,
        source: EdgeSource::City,
        shared_photos: Vec::new(),
        pairs: planes.correspondences(),
        inliers: fit.inlier_count(),
        rms: fit.rms,
        refusal,
        note: None,
    };
    Some(Pair { edge, fit: Some(fit), decision })
}

/// Root mean square distance of points from the surfaces that they should lie on, a's units.
fn off_surfaces(planes: &SharedPlanes, a_from_b: &Similarity) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0f64);
    for group in &planes.groups {
        for point in &group.points {
            squares += group.measured(point, a_from_b, 0.0, planes.radius).residual.powi(2);
            count += 1.0;
        }
    }
    (squares / count.max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Rotation3, Vector3};
    use crate::merging::pairwise::{ACROSS, part, truth};
    use crate::merging::part::Part;

    /// Two parts of a corner, and where the city has the second: two centimetres and a tenth of a degree off.
    fn corner() -> ([Part; 2], Similarity) {
        let parts = [part(4, 0.0, &Similarity::identity()), part(4, 0.5, &truth().inverse())];
        let turn = Rotation3::from_euler_angles(0.001, -0.002, 0.0015);
        let off = Similarity { scale: 1.001, rotation: turn, translation: Vector3::new(0.015, -0.01, 0.012) };
        (parts, off * truth())
    }

    fn overlap_of(parts: &[Part; 2], a_from_b: &Similarity) -> Option<Pair> {
        let limits = MergeLimits::default();
        let parts = parts.each_ref().map(|part| PreparedPart::of(part, &limits));
        overlap(&parts, [0, 1], a_from_b, &limits)
    }

    #[test]
    fn surfaces_that_both_parts_see_bring_them_together() {
        let (parts, by_city) = corner();
        let pair = overlap_of(&parts, &by_city).unwrap();
        assert!(pair.edge.is_used() && pair.edge.source == EdgeSource::City, "{:?}", pair.edge);
        assert!(pair.edge.inliers > 1000, "{}", pair.edge.inliers);
        let a_from_b = pair.fit.unwrap().a_from_b;
        for corner in [Point3::origin(), Point3::new(6.0, 6.0, 0.0), Point3::new(0.0, 6.0, 4.0)] {
            let in_b = truth().inverse().apply(&corner);
            let miss = |pose: &Similarity| (pose.apply(&in_b) - corner).norm();
            assert!(miss(&by_city) > 0.015 && miss(&a_from_b) < 2.0 * ACROSS, "{} {}", miss(&by_city), miss(&a_from_b));
        }
    }

    #[test]
    fn surfaces_that_contradict_the_city_are_told_and_not_used() {
        let (parts, by_city) = corner();
        let off = Similarity { translation: by_city.translation + Vector3::new(0.3, 0.25, 0.2), ..by_city };
        let edge = overlap_of(&parts, &off).unwrap().edge;
        assert!(!edge.is_used() && edge.reason().is_some_and(|told| told.contains("of the extent apart")));
    }

    #[test]
    fn parts_that_see_nothing_in_common_have_no_edge() {
        let (parts, by_city) = corner();
        let far = Similarity { translation: by_city.translation + Vector3::new(0.0, 90.0, 0.0), ..by_city };
        assert!(overlap_of(&parts, &far).is_none());
    }
}
