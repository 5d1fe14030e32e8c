//! The file of a city index (`.cwi`): a city cut into blocks, any of which can be read without the others.
//!
//! ```text
//! header      64 bytes: magic, version, length of the file, place and checksum of the directory, checksum of the header
//! blocks      the model, one after the other ([`block`]); then what can be seen of each ([`sight`])
//! directory   words (JSON: files, frame, warnings), then one entry of fixed length for each block: box, places, checksums
//! ```
//!
//! Numbers are little-endian. A length is held against the file before memory is taken for it, blocks may not overlap, and every part
//! has a checksum (CRC-32) that is looked at when the part is read: header and directory when the file is opened, a block when it is needed.
//! Blocks are read by their place, not mapped: mapping is `unsafe`, which this crate does without.
//! Some thousand boxes are looked through one by one in microseconds, so there is no tree over them.

mod block;
mod fault;
mod file;
mod records;
mod sight;
mod writer;

pub use block::{Block, BlockParts};
pub use fault::IndexFault;
pub use file::{IndexFile, is_city_index};
pub use records::{BlockEntry, FacetRecord, OWN_VERTEX, ObjectRecord, VertexRecord, WallRecord};
pub use sight::BlockSight;
pub use writer::IndexWriter;
