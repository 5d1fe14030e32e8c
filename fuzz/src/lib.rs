//! Damaged files for every reader of cityweld, and the promises that the readers keep.
//!
//! ```text
//! seeds ──► damage (json, xml, text, bytes, e57, glb) ──► Case ──► formats (read, and hold to the promises) ──► trial ──► found/
//! ```
//!
//! `worker.rs` tries case after case of one format in a process of its own; `parent.rs` watches these, since a stack that overflows
//! takes its process with it. A case is known by format, seed and number, and is the same wherever it is made.

pub mod args;
pub mod case;
pub mod chance;
pub mod formats;
pub mod memory;
pub mod parent;
pub mod target;
pub mod trial;
pub mod worker;

mod bytes;
mod checksum;
mod damage;
mod e57;
mod found;
mod glb;
mod json;
mod promises;
mod seeds;
mod text;
mod tree;
mod words;
mod xml;
