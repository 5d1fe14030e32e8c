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
pub use cliques::{Cliques, Graph};
pub use contenders::{Place, contenders};
pub use economy::{Prospect, cheapest, prospects};
pub use pose_search::{PoseSearch, largest_shift};
pub use prior::Prior;
pub use refine::{ProbeOnPlane, Refined, Refiner};
pub use sampler::{Pair, Sample, Sampler};
pub use scene::Scene;
pub use search::{Hypotheses, NO_SOLVER, search};
pub use votes::{LevelPatch, Votes};
pub use walk::{hop, settle, slide};
