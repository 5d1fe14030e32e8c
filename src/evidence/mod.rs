//! Evidence against chance, in bits: how much likelier is what the cloud meets in the city under a pose than under poses that were fitted to
//! other places?

mod bits;
mod chance;
mod evaluation;
mod occluded;
mod outcomes;
mod cloud_planes;

pub use evaluation::{CandidateEvaluation, EvaluatedCandidate};
