//! Which patch may lie on which plane of the city, and which poses follow: fields of facets, candidate pairs, the search and its
//! refinement.

mod cliques;
mod contenders;
mod economy;
mod field;
mod hop;
mod lead;
mod pairing;
mod refine;
mod scene;
mod scoring;
mod search;
mod sight;
mod slide;
mod votes;

pub use cliques::{Cliques, Graph};
pub use contenders::{Contender, Contest, contest, refiner};
pub use economy::{Prospect, cheapest, prospects};
pub use field::{FacetField, FieldTriangle, Hit, Probe};
pub use pairing::{Pair, Pairing, Sample};
pub use refine::{ErrorModel, ProbeOnPlane, Refined, Refiner};
pub use scene::Scene;
pub use scoring::{Mover, Scorer};
pub use search::{PoseSearch, largest_shift};
pub use sight::Sightlines;
pub use slide::slide;
pub use votes::{LevelPatch, Votes};
