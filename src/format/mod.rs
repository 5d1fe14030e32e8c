//! Raw records as the specifications of the file formats write them, both directions.

pub mod obj;
mod alignment;
mod placement;
mod start;

pub use alignment::{StoredAlignment, read_alignment};
pub use placement::PlacementError;
pub use start::read_start;
