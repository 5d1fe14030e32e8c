//! An index as a file: opened by its header and directory, blocks read by their places.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use zerocopy::{FromBytes, FromZeros, IntoBytes};

use super::fault::IndexFault;
use super::records::{BlockEntry, Header, MAGIC, Piece, VERSION};
use super::sight::BlockSight;
use crate::format::file::open_regular;

/// An index that is open.
pub struct IndexFile {
    file: Mutex<File>,
    pub entries: Vec<BlockEntry>,
    /// What the directory says of the city as a whole, JSON.
    pub words: Vec<u8>,
}

/// Whether bytes are those of an index, by the first of them.
pub fn is_city_index(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

impl IndexFile {
    /// Reads header and directory and holds every length in them against the file's.
    pub fn open(path: &Path) -> Result<IndexFile, IndexFault> {
        let mut file = open_regular(path)?;
        let length = file.metadata()?.len();
        let mut header = Header::new_zeroed();
        let expected = size_of::<Header>() as u64;
        file.read_exact(header.as_mut_bytes()).map_err(|_| IndexFault::CutOff { found: length, expected })?;
        header.check(length)?;
        let (at, words) = (header.directory_at.get(), header.words_length.get() as usize);
        file.seek(SeekFrom::Start(at))?;
        let mut directory = vec![0; (length - at) as usize];
        file.read_exact(&mut directory)?;
        if crc32fast::hash(&directory) != header.directory_checksum.get() {
            return Err(IndexFault::Altered { what: "the directory", at });
        }
        let entries = directory.split_off(words);
        let entries = <[BlockEntry]>::ref_from_bytes(&entries).map_or(Vec::new(), <[BlockEntry]>::to_vec);
        check_places(&entries, at)?;
        Ok(IndexFile { file: Mutex::new(file), entries, words: directory })
    }

    pub(super) fn growing(file: File, entries: Vec<BlockEntry>) -> IndexFile {
        IndexFile { file: Mutex::new(file), entries, words: Vec::new() }
    }

    /// The bytes of a block.
    pub fn block_bytes(&self, entry: &BlockEntry) -> Result<Vec<u8>, IndexFault> {
        self.piece(&entry.model, "a block")
    }

    /// What can be seen of a block; nothing where that is not found out yet.
    pub fn sight(&self, entry: &BlockEntry) -> Result<BlockSight, IndexFault> {
        if entry.sight.length.get() == 0 {
            return Ok(BlockSight::default());
        }
        let bytes = self.piece(&entry.sight, "what is seen of a block")?;
        BlockSight::read(&bytes, entry.triangles.get() as usize, entry.sight.at.get())
    }

    fn piece(&self, piece: &Piece, what: &'static str) -> Result<Vec<u8>, IndexFault> {
        let mut bytes = vec![0; piece.length.get() as usize];
        {
            let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            file.seek(SeekFrom::Start(piece.at.get()))?;
            file.read_exact(&mut bytes)?;
        }
        match crc32fast::hash(&bytes) == piece.checksum.get() {
            true => Ok(bytes),
            false => Err(IndexFault::Altered { what, at: piece.at.get() }),
        }
    }
}

impl Header {
    /// Everything that a header can say of a file of this length.
    fn check(&self, length: u64) -> Result<(), IndexFault> {
        if self.magic != MAGIC {
            return Err(IndexFault::NoIndex);
        }
        let (found, expected) = (self.version.get(), VERSION);
        if found != expected {
            return Err(IndexFault::OtherVersion { found, expected });
        }
        if self.checksum.get() != self.own_checksum() {
            return Err(IndexFault::Altered { what: "the header", at: 0 });
        }
        let expected = self.file_length.get();
        if length != expected {
            return Err(IndexFault::CutOff { found: length, expected });
        }
        let entries = u64::from(self.block_count.get()) * size_of::<BlockEntry>() as u64;
        let ends = [self.directory_at.get(), self.words_length.get(), entries];
        let end = ends.into_iter().try_fold(0_u64, u64::checked_add);
        let is_after_header = self.directory_at.get() >= size_of::<Header>() as u64;
        match end == Some(length) && is_after_header {
            true => Ok(()),
            false => Err(IndexFault::Nonsense { what: "the header", at: 0, found: "a directory elsewhere".into() }),
        }
    }
}

/// Pieces lie one after the other before the directory: nothing is read twice, and all of it is no more than the file.
fn check_places(entries: &[BlockEntry], directory_at: u64) -> Result<(), IndexFault> {
    let mut pieces: Vec<(u64, u64)> =
        entries.iter().flat_map(|entry| [entry.model, entry.sight]).map(|p| (p.at.get(), p.length.get())).collect();
    pieces.sort_unstable();
    let mut free = 0;
    for (at, length) in pieces.into_iter().filter(|piece| piece.1 > 0) {
        let end = at.checked_add(length).filter(|&end| at >= free && end <= directory_at);
        free = end.ok_or_else(|| {
            let found = "blocks overlap, or lie beyond the file".to_owned();
            IndexFault::Nonsense { what: "the directory", at: directory_at, found }
        })?;
    }
    Ok(())
}
