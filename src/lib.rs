//! cityweld sets structure-from-motion (SfM) reconstructions into polyhedral city models, and onto each other.
//!
//! The rooms stand in the order in which data flows through them; each imports only from rooms above it
//! (`ARCHITECTURE.md` says why, `tests/layering.rs` holds the list).
#![forbid(unsafe_code)]

pub mod limits;
pub mod geometry;
pub mod format;
pub mod city;
pub mod reconstruction;
pub mod imagery;
pub mod solvers;
pub mod problem;
pub mod robust;
pub mod planes;
pub mod correspondence;
pub mod evidence;
pub mod uncertainty;
pub mod verdict;
pub mod merging;
pub mod export;
pub mod synthetic;

mod align;

pub use align::{AlignOptions, Progress, Up, align};
