//! Control points as programs write them: records alone, in the frame of the file.

mod read;
mod record;
#[cfg(test)]
mod tests;

pub use read::read_control_points;
pub use record::{ControlFile, PointRole, PointSight, StoredPoint};
