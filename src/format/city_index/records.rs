//! Records of fixed length, as they lie in the file.

use zerocopy::little_endian::{F64, U32, U64};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// As PNG's: no text begins so, and a transfer that takes it for text spoils it.
pub(super) const MAGIC: [u8; 8] = *b"\x89CWI\r\n\x1a\n";

/// Goes up with every change of what the bytes mean, and of what is found out for them (what can be seen, where walls are).
pub(super) const VERSION: u32 = 1;

#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(super) struct Header {
    pub magic: [u8; 8],
    pub version: U32,
    pub block_count: U32,
    pub file_length: U64,
    pub directory_at: U64,
    /// Of the words, which come first in the directory.
    pub words_length: U64,
    pub directory_checksum: U32,
    pub reserved: [u8; 16],
    /// Of all bytes before it.
    pub checksum: U32,
}

/// What the directory says of a block.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct BlockEntry {
    /// Box of its facets; metres about the city's origin.
    pub low: [F64; 3],
    pub high: [F64; 3],
    pub model: Piece,
    pub sight: Piece,
    pub facets: U32,
    pub triangles: U32,
}

impl BlockEntry {
    /// Walls that can be seen of it; what is seen is a byte for each triangle, then the walls.
    pub fn walls(&self) -> usize {
        let bytes = self.sight.length.get().saturating_sub(u64::from(self.triangles.get()));
        bytes as usize / size_of::<WallRecord>()
    }
}

/// A run of bytes of the file.
#[derive(Clone, Copy, Debug, Default, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct Piece {
    pub at: U64,
    pub length: U64,
    pub checksum: U32,
}

/// What stands at the head of a block: how many of each there are.
#[derive(Clone, Copy, Debug, Default, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub(super) struct BlockCounts {
    pub objects: U32,
    pub name_bytes: U32,
    pub vertices: U32,
    pub facets: U32,
    pub rings: U32,
    pub corners: U32,
    pub triangles: U32,
}

/// An object, or the part of one that is in this block.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct ObjectRecord {
    /// Its place among all objects of the city.
    pub order: U32,
    pub name_length: U32,
}

/// Set in the order of a vertex that is joined with none of another block, whatever their places.
pub const OWN_VERTEX: u64 = 1 << 63;

#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct VertexRecord {
    /// Its place among all vertices of the city.
    pub order: U64,
    /// Metres about the city's origin.
    pub position: [F64; 3],
}

#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct FacetRecord {
    /// Its place among all facets of the city; those of one polygon have the same and stand one after the other.
    pub order: U32,
    /// Among those of the block.
    pub object: U32,
    /// The outline and its holes.
    pub rings: U32,
    pub triangles: U32,
    /// 0 where the file does not say what it is.
    pub kind: u8,
    pub reserved: [u8; 3],
    pub normal: [F64; 3],
    pub offset: F64,
    pub area: F64,
}

/// A stretch of wall that can be seen; metres about the city's origin.
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, KnownLayout, Immutable, Unaligned)]
#[repr(C)]
pub struct WallRecord {
    pub from: [F64; 2],
    pub to: [F64; 2],
    /// Unit, outward.
    pub normal: [F64; 2],
    pub foot_m: F64,
    pub top_m: F64,
}
