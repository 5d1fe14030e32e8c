//! Surfaces that both parts have, wherever they were photographed from.
//!
//! Question     which points of one part lie on which planes of the other, once it is known roughly how the parts stand?
//! Input        both parts and the similarity between them
//! Output       [`PlaneEvidence`], both ways: planar patches of each part with the other's points on them
//! Method       each part's cloud is cut into planar patches. A point of one part's patch goes to the patch of the other part whose
//!              point is nearest to it, if that is not further than the cloud's spacing and the bend explain and both
//!              patches face the same way. (Superpixels tell the same for shared photographs alone, but need no pose.)
//! Assumptions  the similarity is right to within the spacing of the points
//! Fails when   the parts have no surface in common: then there is no evidence
//! Source       refinement on planes of all points: Ramalingam, Taguchi, Marks and Tuzel (ECCV 2010), section 5

use std::collections::BTreeMap;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::Part;
use super::plane_evidence::{PlaneEvidence, PlaneGroup, PlaneOf, PointOnPlane, group};
use super::sigma::{covariance, extent, median};
use crate::geometry::{Point3, Similarity, Vector3};
use crate::limits::{Limits, PatchLimits};
use crate::planes::patches;

/// Points that tell all that there is to say, since those of one plane share its error.
const MOST_POINTS: usize = 10_000;
/// A partner is no further than so many times the median distance of neighbours, beside what the bend explains ...
const SPACINGS: f64 = 4.0;
/// ... which is so many of its sigmas.
const BENDS: f64 = 3.0;
/// Both patches face the same way to within this, degrees.
const SAME_NORMAL_DEG: f64 = 20.0;
/// Fewer points of the other part on a patch may be there by chance.
const FEWEST_PARTNERS: usize = 3;

/// The points of a part's patches, in its own frame.
struct Surfaces {
    points: Vec<PointOnPlane>,
    /// For each point its patch, and for each patch its normal, towards the cameras.
    patch_of: Vec<u32>,
    normals: Vec<Vector3<f64>>,
    /// For each patch a place from which it was seen.
    eyes: Vec<Point3<f64>>,
    tree: ImmutableKdTree<f64, 3>,
    /// Median distance from a point to its nearest neighbour.
    spacing: f64,
    radius: f64,
}

/// `bend` in a's units.
pub(super) fn whole_planes(a: &Part, b: &Part, a_from_b: &Similarity, bend: f64) -> Option<PlaneEvidence> {
    let (in_a, in_b) = (Surfaces::of(a)?, Surfaces::of(b)?);
    let mut groups = groups_on(PlaneOf::A, &in_a, &in_b, a_from_b, bend);
    groups.extend(groups_on(PlaneOf::B, &in_b, &in_a, &a_from_b.inverse(), bend / a_from_b.scale));
    (!groups.is_empty()).then_some(PlaneEvidence { groups, radius: [in_a.radius, in_b.radius] })
}

impl Surfaces {
    fn of(part: &Part) -> Option<Surfaces> {
        let limits = PatchLimits { most_points: MOST_POINTS, ..Limits::default().patches };
        let found = patches(&part.sfm, part.superpixels.as_ref(), &limits);
        let (_, radius) = extent(&part.sfm.points);
        let (mut points, mut patch_of, mut normals, mut eyes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (index, patch) in found.patches.iter().enumerate() {
            let views: Vector3<f64> = patch.members.iter().map(|&m| found.views[m as usize]).sum();
            normals.push(patch.fit.plane.normal);
            eyes.push(patch.fit.center + views);
            for &m in &patch.members {
                let index_in_part = found.support[m as usize];
                let at = found.points[m as usize];
                points.push(PointOnPlane { at, covariance: covariance(&part.sfm, index_in_part, radius) });
                patch_of.push(index as u32);
            }
        }
        let entries: Vec<[f64; 3]> = points.iter().map(|p| p.at.coords.into()).collect();
        let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&entries).ok()?;
        let mut surfaces = Surfaces { points, patch_of, normals, eyes, tree, spacing: 0.0, radius };
        let two = std::num::NonZero::new(2)?;
        let to_neighbour = |p: &PointOnPlane| {
            let found = surfaces.tree.query(&p.at.coords.into()).nearest_n::<SquaredEuclidean<f64>>(two).execute();
            found.iter().map(|n| n.distance.sqrt()).fold(0.0, f64::max)
        };
        let mut spacings: Vec<f64> = surfaces.points.iter().map(to_neighbour).collect();
        surfaces.spacing = median(&mut spacings)?;
        Some(surfaces)
    }

    /// The patch of the point that is nearest to a place, if it is within reach and faces the way of `normal`.
    fn patch_at(&self, place: &Point3<f64>, normal: &Vector3<f64>, reach: f64) -> Option<u32> {
        let one = std::num::NonZero::<usize>::MIN;
        let found = self.tree.query(&place.coords.into()).nearest_n::<SquaredEuclidean<f64>>(one).execute();
        let nearest = found.first().filter(|n| n.distance <= reach * reach)?;
        let patch = self.patch_of[nearest.item as usize];
        let cos = self.normals[patch as usize].dot(normal);
        (cos > SAME_NORMAL_DEG.to_radians().cos()).then_some(patch)
    }
}

/// Patches of `own` with the points of `other` on them; `own_from_other` and `bend` in the frame of `own`.
fn groups_on(
    plane_of: PlaneOf,
    own: &Surfaces,
    other: &Surfaces,
    own_from_other: &Similarity,
    bend: f64,
) -> Vec<PlaneGroup> {
    let reach = SPACINGS * own.spacing.max(other.spacing * own_from_other.scale) + BENDS * bend;
    let mut partners: BTreeMap<u32, Vec<PointOnPlane>> = BTreeMap::new();
    for (point, patch) in other.points.iter().zip(&other.patch_of) {
        let normal = own_from_other.rotation * other.normals[*patch as usize];
        if let Some(patch) = own.patch_at(&own_from_other.apply(&point.at), &normal, reach) {
            partners.entry(patch).or_default().push(point.clone());
        }
    }
    let mut members: Vec<Vec<PointOnPlane>> = vec![Vec::new(); own.normals.len()];
    for (point, patch) in own.points.iter().zip(&own.patch_of) {
        members[*patch as usize].push(point.clone());
    }
    let enough = partners.into_iter().filter(|(_, points)| points.len() >= FEWEST_PARTNERS);
    let groups = enough.filter_map(|(patch, points)| {
        let patch = patch as usize;
        group(plane_of, &members[patch], &points, &own.eyes[patch])
    });
    // Both ways are the same two sets of points.
    groups.map(|g| PlaneGroup { share: 0.5, ..g }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::plane_scene::{ACROSS, ROWS, part, truth};
    use super::*;

    #[test]
    fn points_go_to_the_surface_that_both_parts_have_both_ways() {
        let a = part(3, 0.0, &Similarity::identity());
        let b = part(4, 0.5, &truth().inverse());
        let found = whole_planes(&a, &b, &truth(), 0.001).unwrap();
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
        assert!(whole_planes(&a, &b, &far, 0.001).is_none());
    }
}
