//! Several placed parts become one model.
//!
//! Question     which cameras, photographs, points and observations of the parts are the same?
//! Input        the parts, and the places of those that have one
//! Output       one reconstruction, and a [`Ledger`] of what became of everything
//! Method       cameras of the same numbers are one. Versions of one photograph are laid over each other, the one that sees
//!              most points giving
//!              the pose; keypoints of one pixel tell which points may be one, and their covariances whether they are
//! Assumptions  a photograph of one name shows the same pixels in all parts, at whatever size
//! Fails when   nothing: what cannot be kept is counted with its reason

mod cameras;
mod model;
mod moved;
mod photographs;
mod points;
mod rigs;

use self::cameras::Cameras;
use self::model::build;
use self::moved::Moved;
use self::photographs::PhotoFuser;
use self::points::PointSets;
use super::ledger::Ledger;
use super::limits::MergeLimits;
use super::outcome::Fused;
use super::part::Part;
use crate::geometry::Similarity;

/// Joins the parts `placed`, in that order.
pub(super) fn fuse(
    parts: &[Part],
    placed: &[usize],
    places: &[Option<Similarity>],
    limits: &MergeLimits,
) -> (Fused, Ledger) {
    let mut ledger = Ledger::open(parts, |p| placed.contains(&p));
    let moved: Vec<Moved<'_>> = placed.iter().map(|&p| Moved::of(&parts[p].sfm, places[p].as_ref())).collect();
    let cameras = Cameras::of(&moved);
    let mut sets = PointSets::of(&moved, limits);
    let photos = PhotoFuser { moved: &moved, sets: &mut sets, ledger: &mut ledger, limits }.photos();
    let (sfm, origins) = build(&moved, &cameras, &sets, photos, &mut ledger);
    let part_of_point = origins.iter().map(|&k| placed[k] as u32).collect();
    (Fused { sfm, part_of_point }, ledger)
}
