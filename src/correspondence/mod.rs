//! Which patch may lie on which plane of the city: facets that can be seen, fields of facets, candidate pairs.

mod field;
mod pairing;
mod refine;
mod scoring;
mod search;
mod sight;
mod slide;
mod votes;

pub use field::{FacetField, FieldTriangle, Hit, Probe};
pub use pairing::{Pair, Pairing, Sample};
pub use refine::{ErrorModel, Refined, refine};
pub use scoring::{Mover, Scorer};
pub use search::{PoseSearch, largest_shift};
pub use sight::Sightlines;
pub use slide::slide;
pub use votes::{LevelPatch, Votes};
