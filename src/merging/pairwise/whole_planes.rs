//! Surfaces that both parts have, wherever they were photographed from.
//!
//! Question     which points of one part lie on which planes of the other, once it is known roughly how the parts stand?
//! Input        the surfaces of both parts and the similarity between them
//! Output       [`SharedPlanes`], both ways: planar patches of each part with the other's points on them
//! Method       each part's cloud is cut into planar patches. A point of one part's patch goes to the patch of the other part whose
//!              point is nearest to it, if that is not further than the cloud's spacing and the bend explain and both
//!              patches face the same way. (Superpixels tell the same for shared photographs alone, but need no pose.)
//! Assumptions  the similarity is right to within the spacing of the points
//! Fails when   the parts have no surface in common: then there is no evidence
//! Source       refinement on planes of all points: Ramalingam, Taguchi, Marks and Tuzel 2010, section 5

use std::collections::BTreeMap;

use super::planes::{PlaneGroup, PlaneOf, SharedPlanes};
use crate::geometry::Similarity;
use crate::merging::limits::MergeLimits;
use crate::merging::point_covariance::KnownPoint;
use crate::merging::prepared::PreparedPart;
use crate::merging::surfaces::Surfaces;

/// Planes of each part with the other's points on them; `bend` in a's units.
pub(in crate::merging) fn whole_planes(
    [a, b]: [&PreparedPart<'_>; 2],
    a_from_b: &Similarity,
    bend: f64,
    limits: &MergeLimits,
) -> Option<SharedPlanes> {
    let (in_a, in_b) = (a.surfaces()?, b.surfaces()?);
    let forth = Laid { own: in_a, other: in_b, own_from_other: *a_from_b, bend };
    let back = Laid { own: in_b, other: in_a, own_from_other: a_from_b.inverse(), bend: bend / a_from_b.scale };
    let mut groups = forth.groups(PlaneOf::A, limits);
    groups.extend(back.groups(PlaneOf::B, limits));
    (!groups.is_empty()).then_some(SharedPlanes { groups, radius: [a.extent.radius, b.extent.radius] })
}

/// One part's surfaces laid over the other's; the bend in the frame of `own`.
struct Laid<'a> {
    own: &'a Surfaces,
    other: &'a Surfaces,
    own_from_other: Similarity,
    bend: f64,
}

impl Laid<'_> {
    /// Patches of `own` with the points of `other` on them.
    fn groups(&self, plane_of: PlaneOf, limits: &MergeLimits) -> Vec<PlaneGroup> {
        let own = self.own;
        let mut members: Vec<Vec<KnownPoint>> = vec![Vec::new(); own.normals.len()];
        for (point, patch) in own.points.iter().zip(&own.patch_of) {
            members[*patch as usize].push(point.clone());
        }
        let partners = self.partners(limits).into_iter();
        let enough = partners.filter(|(_, points)| points.len() >= limits.planes.fewest_partners);
        let groups = enough.filter_map(|(patch, points)| {
            let patch = patch as usize;
            PlaneGroup::of(plane_of, &members[patch], &points, &own.eyes[patch], limits)
        });
        // Both ways are the same two sets of points.
        groups.map(|g| PlaneGroup { share: 0.5, ..g }).collect()
    }

    /// For each patch of `own` the points of `other` that lie among its own.
    fn partners(&self, limits: &MergeLimits) -> BTreeMap<u32, Vec<KnownPoint>> {
        let (own, other, planes) = (self.own, self.other, &limits.planes);
        let reach = planes.partner_spacings * own.spacing.max(other.spacing * self.own_from_other.scale)
            + planes.partner_bends * self.bend;
        let mut partners: BTreeMap<u32, Vec<KnownPoint>> = BTreeMap::new();
        for (point, patch) in other.points.iter().zip(&other.patch_of) {
            let normal = self.own_from_other.rotation * other.normals[*patch as usize];
            if let Some(patch) = own.patch_at(&self.own_from_other.apply(&point.at), &normal, reach) {
                partners.entry(patch).or_default().push(point.clone());
            }
        }
        partners
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_scene::{ACROSS, ROWS, part, truth};
    use super::*;
    use crate::geometry::Vector3;
    use crate::merging::part::Part;

    fn found(parts: [&Part; 2], a_from_b: &Similarity) -> Option<SharedPlanes> {
        let limits = MergeLimits::default();
        let [a, b] = parts.map(|part| PreparedPart::of(part, &limits));
        whole_planes([&a, &b], a_from_b, 0.001, &limits)
    }

    #[test]
    fn points_go_to_the_surface_that_both_parts_have_both_ways() {
        let a = part(3, 0.0, &Similarity::identity());
        let b = part(4, 0.5, &truth().inverse());
        let found = found([&a, &b], &truth()).unwrap();
        for (side, expected) in [(PlaneOf::A, 3), (PlaneOf::B, 3)] {
            assert_eq!(found.groups.iter().filter(|g| g.plane_of == side).count(), expected);
        }
        for group in &found.groups {
            for point in &group.points {
                let m = group.measured(point, &truth(), 0.0, found.radius);
                assert!(m.residual.abs() < 3.0 * ACROSS && !m.is_beside, "{}", m.residual);
            }
        }
        // Nearly all points of the shared surfaces; those at an edge may have their neighbour round the corner.
        let shared = 2 * 3 * (ROWS * ROWS) as usize;
        assert!((shared * 8 / 10..=shared).contains(&found.correspondences()), "{}", found.correspondences());
    }

    #[test]
    fn parts_without_a_common_surface_have_no_evidence() {
        let a = part(3, 0.0, &Similarity::identity());
        let b = part(3, 0.5, &truth().inverse());
        let far = Similarity { translation: truth().translation + Vector3::new(0.0, 0.0, 50.0), ..truth() };
        assert!(found([&a, &b], &far).is_none());
    }
}
