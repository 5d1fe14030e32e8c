//! A city prepared once: written as an index of blocks, read again as a model of all of it or of any part.
//!
//! `draft.rs` makes the blocks of a model, `sequence.rs` those of a file that is too long for one (`plan.rs` says which facet goes where, `pack.rs` turns a block into records) and `open.rs` reads them;
//! `assemble.rs` puts any of them together to the model that the files gave, facet by facet. `words.rs` is what is said of the whole,
//! `stamp.rs` tells whether the files are still those that were read.

mod assemble;
mod counted;
mod draft;
mod open;
mod pack;
mod plan;
mod sequence;
mod stamp;
mod survey;
mod tally;
mod words;

#[cfg(test)]
mod tests;

pub use draft::{IndexDraft, Surroundings};
pub use open::{CityIndex, IndexOverview};
pub use stamp::CityChange;
