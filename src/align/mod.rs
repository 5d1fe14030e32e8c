//! Aligns one reconstruction to a city: `task` is the whole job, `obstacle` why none is possible, `evidence` what the verdict reads, `report` the
//! result.

mod evidence;
mod obstacle;
mod options;
mod outcome;
mod report;
mod task;

pub use options::{AlignOptions, Up};
pub use task::align;
