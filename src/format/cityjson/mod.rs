//! CityJSON 1.0, 1.1 and 2.0, and CityJSONSeq (a header, then one feature a line): surfaces with their holes, kinds and levels of
//! detail.
//!
//! The shape of a file is read by `serde_json`, which leaves the bulk (boundaries, vertices, values of semantics) as text; these are
//! nested arrays of numbers, walked here without recursion. Attributes, textures and materials are not looked at.

mod assembly;
mod boundaries;
mod document;
mod fault;
mod kinds;
mod nest;
mod objects;
mod read;
mod templates;
#[cfg(test)]
mod tests;
mod vertices;

pub use fault::{CityJsonError, CityJsonProblem};
pub use read::read_cityjson;
