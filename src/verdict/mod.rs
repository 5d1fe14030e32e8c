//! The verdict on an alignment, `aligned`, `undetermined`, `ambiguous` or `failed`, with its reason and figures.
//!
//! Input        evidence for the best pose and its rivals in bits, information of the data and of the start on the pose, how far the model's
//!              and the reconstruction's own errors reach
//! Output       [`Alignment`]: the pose, its covariance, each freedom with its standard deviation and whether it is determined, the rivals that
//!              are left. The report, the 3D scene and the summary are views of it
//! Method       `judge` asks in this order: does a given scale contradict the data, is there more evidence than chance gives, does another
//!              pose explain as much, does every freedom reach the accuracy that is asked for (`freedoms`); `words` puts the answer
//!              into a sentence
//! It compares numbers that others have estimated; it estimates nothing itself.

mod alignment;
mod freedoms;
mod judge;
mod words;

pub use alignment::{
    Alignment, Alternative, Certainty, Freedom, FreedomKind, FreedomUnit, ModelErrors, PlaneSupport, SearchSummary,
    Support, Verdict,
};
pub use freedoms::{GivenScale, PoseInformation, freedoms};
pub use judge::{Decision, Evidence, LeftOut, Rival, SearchSpace, judge};
