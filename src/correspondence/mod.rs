//! Which patch may lie on which plane of the city, and which poses follow: fields of facets, candidate pairs, the search and its
//! refinement.

mod belief;
mod candidates;
mod cliques;
mod contenders;
mod economy;
mod pose_search;
mod prior;
mod refine;
mod sampler;
mod scene;
mod scoring;
mod search;
mod sight;
mod targets;
#[cfg(test)]
pub(crate) mod test_scene;
mod votes;
mod walk;

pub use candidates::{Candidate, candidate_at, candidates, joined, settled};
pub use cliques::Graph;
pub use contenders::{Place, contenders};
pub use pose_search::PoseSearch;
pub use prior::Prior;
pub use refine::{ProbeOnPlane, Refined, Refiner};
pub use sampler::Sampler;
pub use scene::Scene;
pub use search::{Hypotheses, NO_SOLVER, search};
pub use votes::{LevelPatch, Votes};
