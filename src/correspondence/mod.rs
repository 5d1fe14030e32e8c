//! Which patch may lie on which plane of the city, and which poses follow: what is known beforehand, candidate pairs, the search and its
//! refinement.

mod belief;
mod candidates;
mod cliques;
mod first_pair;
mod mover;
mod offers;
mod null_poses;
mod solver_choice;
mod pose_search;
mod prior;
mod refine;
mod rotations;
mod sample;
mod sampler;
mod scene;
mod scoring;
mod search;
mod weighted_choice;
mod occlusion;
mod targets;
#[cfg(test)]
pub(crate) mod test_scene;
mod level_cloud;
mod line_search;

pub use candidates::{Candidate, candidate_at, candidates, joined, refined_to_end};
pub use cliques::Graph;
pub use level_cloud::{LevelCloud, LevelPatch};
pub use null_poses::{Basin, null_poses};
pub use pose_search::PoseSearch;
pub use prior::{Prior, Vertical};
pub use refine::{PointPlaneMatch, PoseRefiner, RefinedPose};
pub use sampler::Sampler;
pub use scene::Scene;
pub use search::{Hypotheses, NO_SOLVER, search};
