//! cityweld sets structure-from-motion (SfM) reconstructions into polyhedral city models, and onto each other.
//!
//! The rooms stand in the order in which data flows through them; each imports only from rooms above it
//! (`ARCHITECTURE.md` says why, `tests/layering.rs` holds the list).
#![forbid(unsafe_code)]

pub mod city;
pub mod export;
pub mod format;
pub mod geometry;
pub mod imagery;
pub mod reconstruction;
pub mod verdict;

mod align;

pub use align::{AlignOptions, Progress, Up, align};
