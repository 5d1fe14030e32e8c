//! What is wrong with the file of an index.

use std::io;

/// What is wrong with the file of an index.
#[derive(Debug, thiserror::Error)]
pub enum IndexFault {
    #[error("cannot read the index: {0}")]
    Unreadable(#[from] io::Error),
    #[error("the index is no such file: it begins otherwise")]
    NoIndex,
    #[error("the index is of version {found}, expected {expected}")]
    OtherVersion { found: u32, expected: u32 },
    #[error("the index has {found} bytes, expected {expected}: it was cut off, or its writing was")]
    CutOff { found: u64, expected: u64 },
    #[error("{what} at byte {at} does not fit its checksum: the index was altered")]
    Altered { what: &'static str, at: u64 },
    #[error("{what} at byte {at} is no such thing: {found}")]
    Nonsense { what: &'static str, at: u64, found: String },
    #[error("the index is larger than its numbers can count ({what})")]
    TooLarge { what: &'static str },
}
