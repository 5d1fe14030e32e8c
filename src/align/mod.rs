//! Aligns one reconstruction to a city: `task` is the whole job, `whereabouts` where it is sought, `obstacle` why none is possible, `evidence` what the verdict reads, `report` the
//! result; `indexed` the same job where the city is an index.

mod evidence;
mod indexed;
mod obstacle;
mod options;
mod outcome;
mod report;
mod task;
mod whereabouts;

pub use indexed::{AlignIndexError, IndexedAlignment, align_in_index};
pub use options::{AlignOptions, Place, Up};
pub use task::align;
