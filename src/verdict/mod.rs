//! What was found, how sure it is, and on which evidence: the one struct that the report, the picture and the summary are
//! views of. Verdicts read evidence; they never estimate.

mod alignment;
mod freedoms;
mod judge;
mod words;

pub use alignment::{
    Alignment, Alternative, Certainty, Freedom, FreedomKind, FreedomUnit, ModelErrors, PlaneSupport, SearchSummary,
    Support, Verdict,
};
pub use freedoms::{GivenScale, PoseInformation, freedoms};
pub use judge::{Decision, Evidence, Rival, judge};
