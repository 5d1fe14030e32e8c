//! Two parts: how they stand to each other, and whether they belong together.
//!
//! Question     which similarity carries one part onto the other, how far is it known, and is it to be believed?
//! Input        two prepared parts that share photographs
//! Output       [`Pair`]: an edge for the report, a [`Fit`] with its information, a [`PairDecision`]
//! Method       `shared_tracks`, `superpixel_planes` and `whole_planes` gather what the parts share. Point pairs, cameras and planes are
//!              rows of one least squares (`rows`: `point_rows`, `camera_rows`, `plane_rows`; `fit`), found without a start
//!              by `track_fit` and
//!              `plane_search`, brought together by `joint`. One decision (`decision`) rests on the same checks of either source
//!              (`track_checks`, `plane_checks`)
//! Assumptions  a photograph of one name shows the same pixels in both parts, at whatever size
//! Fails when   the shared photographs have too few keypoints in common, or show one plane

mod camera_rows;
mod design_effect;
mod disagreement;
mod fit;
mod joint;
mod decision;
mod on_planes;
mod pair;
mod plane_rows;
mod plane_search;
mod plane_checks;
mod planes;
mod point_rows;
mod rows;
mod same_place;
mod superpixel_planes;
#[cfg(test)]
mod test_scene;
mod shared_tracks;
mod track_fit;
mod track_checks;
mod whole_planes;

pub(super) use decision::PairDecision;
#[cfg(test)]
pub(super) use fit::Fit;
pub(super) use fit::OwnFit;
pub use pair::PairSources;
pub(super) use pair::{Comparison, Pair};
pub(super) use plane_rows::settle_planes;
pub(super) use planes::SharedPlanes;
#[cfg(test)]
pub(super) use test_scene::{ACROSS, part, truth};
pub(super) use whole_planes::whole_planes;
