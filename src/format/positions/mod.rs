//! Where photographs were taken, as programs write it: records alone, in the frame of the file.
//!
//! [`read_positions`] tells the form by content: a folder of photographs (EXIF), a COLMAP database, an OpenSfM reconstruction, a table with
//! a header (Metashape, RealityScan), `geo.txt` of ODM, or lines `name X Y Z`.

mod columns;
mod database;
mod error;
mod exif;
mod frame;
mod lines;
mod opensfm;
mod read;
mod record;
mod table;
#[cfg(test)]
mod tests;

pub use error::PositionsError;
pub use exif::photographs_in;
pub(in crate::format) use frame::frame_of_line;
pub use frame::{Frame, GEOGRAPHIC};
pub use read::read_positions;
pub use record::{PositionsFile, StoredPosition};
