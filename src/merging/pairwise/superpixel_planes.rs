//! Superpixels of the shared photographs: one part's points give each a plane, the other part's points lie on it.
//!
//! Question     which planes does one part have, and which points of the other part lie on them?
//! Input        the superpixels of both parts, for the photographs that both have
//! Output       [`SharedPlanes`]: for each superpixel, both ways, a plane with its uncertainty and the other part's points
//! Method       [`PlaneGroup::of`] for each superpixel that both parts have points in
//! Assumptions  a superpixel shows one piece of surface
//! Fails when   the superpixels hold fewer than a handful of points (sparse clouds, small superpixels)
//! Source       Ramalingam, Taguchi, Marks and Tuzel 2010, section 5

use super::planes::{PlaneGroup, PlaneOf, SharedPlanes};
use crate::merging::limits::MergeLimits;
use crate::merging::point_covariance::KnownPoint;
use crate::merging::prepared::PreparedPart;
use crate::merging::shared_photos::SharedPhoto;
use crate::reconstruction::{ImageIndex, PointIndex};

/// Planes of the superpixels that both parts have; `None` where there are none.
pub(super) fn superpixel_planes(
    [a, b]: [&PreparedPart<'_>; 2],
    photos: &[SharedPhoto],
    limits: &MergeLimits,
) -> Option<SharedPlanes> {
    let mut groups = Vec::new();
    for photo in photos {
        for (label, in_a) in a.superpixels_of(photo.in_a) {
            let Some(in_b) = b.superpixel(photo.in_b, label) else { continue };
            let (points_a, points_b) = (points(a, in_a), points(b, in_b));
            let eye = |part: &PreparedPart<'_>, image: ImageIndex| part.sfm().images[image.0 as usize].center();
            let forth = PlaneGroup::of(PlaneOf::A, &points_a, &points_b, &eye(a, photo.in_a), limits);
            let back = PlaneGroup::of(PlaneOf::B, &points_b, &points_a, &eye(b, photo.in_b), limits);
            let share = if forth.is_some() && back.is_some() { 0.5 } else { 1.0 };
            groups.extend(forth.into_iter().chain(back).map(|g| PlaneGroup { share, ..g }));
        }
    }
    (!groups.is_empty()).then_some(SharedPlanes { groups, radius: [a.extent.radius, b.extent.radius] })
}

fn points(part: &PreparedPart<'_>, indices: &[PointIndex]) -> Vec<KnownPoint> {
    indices.iter().map(|&p| part.known_point(p)).collect()
}
