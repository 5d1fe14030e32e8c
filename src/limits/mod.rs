//! Every number that decides how a reconstruction is aligned and judged, in one value.
//!
//! Each says where it comes from: *derived* (from what), *measured on* (what), or *chosen* (why). Guards of arithmetic (smallest
//! lengths, block sizes of parallel work) stand beside the code that they guard. Lengths are metres; a *unit* is the width of a
//! scene's narrowest gate, [`Limits::model_unit_m`] and so many sigmas of the cloud's noise.

mod all;
mod evidence;
mod patches;
mod place_search;
mod refinement;
mod search;
mod uncertainty;
mod verdict;
mod visibility;

pub use all::Limits;
pub use evidence::{EvidenceLimits, NullPoseLimits};
pub use patches::{PatchLimits, UpErrorModel, UpLimits};
pub use place_search::PlaceSearchLimits;
pub use refinement::{LineSearchLimits, OcclusionLimits, RefinementLimits, StageLimits};
pub use search::SearchLimits;
pub use uncertainty::UncertaintyLimits;
pub use verdict::VerdictLimits;
pub use visibility::FacetVisibilityLimits;
