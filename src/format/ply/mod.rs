//! Point clouds in PLY files: ASCII and both binary orders, numbers of every type, further properties with them.

mod cloud;
mod field;
mod header;
mod read;
mod rows;

pub use cloud::PlyCloud;
pub(super) use field::ByteOrder;
pub use field::{CloudField, FieldKind};
pub(super) use header::{Element, Encoding, Header, PropertyKind};
pub use read::{PlyError, is_ply, read_ply};

#[cfg(test)]
mod tests;
