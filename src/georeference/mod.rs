//! Where a reconstruction stands, from what people have: positions of photographs, control points.
//!
//! Each source becomes an [`Estimate`]: a start with its sigmas about the middle of the reconstruction, and the words that name it.
//! Positions ([`from_positions`]) are levelled first and leave four freedoms, fitted by consensus and least squares; control points
//! ([`from_control_points`]) fix all seven. Several estimates must agree and are put together ([`agreed`]).

mod agree;
mod control;
mod error;
mod estimate;
mod extent;
mod heights;
mod level;
mod level_fit;
mod matched;
mod names;
mod point_fit;
mod positions;
mod projection;
mod rays;
mod reach;
#[cfg(test)]
mod tests;

pub use agree::agreed;
pub use control::from_control_points;
pub use error::GeoreferenceError;
pub use estimate::{ControlPoint, ControlUse, Estimate};
pub use positions::from_positions;
pub use projection::from_geographic;
