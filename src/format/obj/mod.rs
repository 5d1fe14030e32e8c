//! Wavefront OBJ: polygons with their objects and groups, positions in f64.
//!
//! The `obj` crate reads faces, objects and groups; it keeps positions in f32, loses faces on nameless groups and
//! accepts what is no mesh. So a guard stands before it: it reads the lines, keeps the positions itself, hands
//! on only what the crate reads well, and remembers on which line everything stood.

mod file;
mod guard;
mod join;
mod number;
mod piece;
#[cfg(test)]
mod tests;
mod write;

pub use file::{ObjError, ObjFile, ObjGroup, ObjObject, ObjOddities, ObjProblem, read_obj};
pub use write::write_obj;
