//! Two parts: how they stand to each other, and whether they belong together.
//!
//! Question     which similarity carries one part onto the other, how far is it known, and is it to be believed?
//! Input        two prepared parts that share photographs
//! Output       [`Pair`]: an edge for the report, a [`Fit`] with its information, a [`PairDecision`]
//! Method       `track_evidence`, `superpixel_planes` and `whole_planes` gather what the parts share. Point pairs, cameras and planes are
//!              rows of one least squares (`rows`: `point_rows`, `camera_rows`, `plane_rows`; `fit`), found without a start
//!              by `track_fit` and
//!              `plane_search`, brought together by `joint`. One judge (`judge`) hears what either kind of evidence answers
//!              (`track_testimony`, `plane_testimony`)
//! Assumptions  a photograph of one name shows the same pixels in both parts, at whatever size
//! Fails when   the shared photographs have too few keypoints in common, or show one plane

mod camera_rows;
mod design_effect;
mod disagreement;
mod fault;
mod fit;
mod joint;
mod judge;
mod on_planes;
mod pair;
mod plane_rows;
mod plane_search;
mod plane_testimony;
mod planes;
mod point_rows;
mod rows;
mod same_place;
mod superpixel_planes;
#[cfg(test)]
mod test_scene;
mod track_evidence;
mod track_fit;
mod track_testimony;
mod whole_planes;

pub(super) use fault::PairFault;
#[cfg(test)]
pub(super) use fit::Fit;
pub(super) use fit::OwnFit;
pub(super) use judge::PairDecision;
pub use pair::EvidenceChoice;
pub(super) use pair::{Comparison, Pair};
pub(super) use plane_rows::settle_planes;
pub(super) use planes::PlaneEvidence;
#[cfg(test)]
pub(super) use test_scene::{ACROSS, part, truth};
pub(super) use whole_planes::whole_planes;
