//! Rows in any number and distribution: all their poses, or the reason why none is isolated.
//!
//! | file | step |
//! |---|---|
//! | `solve` | the whole of it, and its card |
//! | `normalised` | units of the problem's own, tests of its structure (`same_planes`) |
//! | `forms` | very many rows as few |
//! | `candidates` | rotations to start from |
//! | `polish` | Gauss and Newton on all rows (`jacobian`) |
//! | `degeneracy` | why a pose is not determined, and how well it is |

mod candidates;
mod degeneracy;
mod forms;
mod jacobian;
mod normalised;
mod polish;
mod same_planes;
mod solve;

pub use degeneracy::{Degeneracy, NOT_ISOLATED, WEAK, condition_at};
pub use solve::{Solution, refine, solve};
