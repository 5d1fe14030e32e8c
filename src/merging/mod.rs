//! Several reconstructions of one place become one.
//!
//! Question     which similarities carry the parts into one frame, do they belong together at all, and which cameras, images,
//!              points and observations are the same?
//! Input        parts as they were reconstructed, each in a frame of its own; photographs are told by name alone, which `one_name.rs` makes one first
//! Output       [`Merge`]: a verdict, every part's place or the reason why it has none, one model, and a balanced [`Ledger`]
//! Method       each part is prepared once; each two parts that share photographs are compared (`pairwise`); accepted pairs
//!              and anchors in a
//!              city form a network that is solved as a whole (`network`); what was placed is fused (`fuse`)
//! Assumptions  a photograph of one name shows the same pixels in both parts, at whatever size
//! Fails when   two parts share no photograph and no anchor, or their shared photographs have too few keypoints in common

mod error;
mod fault;
mod extent;
mod fuse;
mod join;
mod ledger;
mod limits;
mod network;
mod one_name;
mod outcome;
mod pair_limits;
mod pairwise;
mod part;
mod point_covariance;
mod prepared;
mod shared_photos;
mod surfaces;

pub use error::MergeError;
pub use fault::{EdgeFault, PairFault};
pub use join::{JoinOptions, join};
pub use ledger::{Account, DropReason, Ledger, Unbalanced};
pub use limits::MergeLimits;
pub use one_name::unify_names;
pub use outcome::{Edge, EdgeSource, Fused, Merge, MergeVerdict, MergedFrame, PartPlace, PartSupport};
pub use pairwise::PairSources;
pub use part::{Anchor, Part};
