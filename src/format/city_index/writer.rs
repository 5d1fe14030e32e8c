//! An index in the making: blocks one after the other, then what can be seen of each, then the directory.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use zerocopy::IntoBytes;
use zerocopy::little_endian::{U32, U64};

use super::fault::IndexFault;
use super::file::IndexFile;
use super::records::{BlockEntry, Header, MAGIC, Piece, VERSION};
use super::sight::BlockSight;

/// A file that grows; it is no index until [`IndexWriter::finish`].
pub struct IndexWriter {
    out: BufWriter<File>,
    at: u64,
    pub entries: Vec<BlockEntry>,
}

/// Bytes gathered before each write to a file.
const WRITE_BYTES: usize = 1 << 20;

impl IndexWriter {
    pub fn create(path: &Path) -> io::Result<IndexWriter> {
        // Read again while it grows, for what blocks see of each other.
        let file = File::options().read(true).write(true).create(true).truncate(true).open(path)?;
        let mut out = BufWriter::with_capacity(WRITE_BYTES, file);
        out.write_all(&[0; size_of::<Header>()])?;
        Ok(IndexWriter { out, at: size_of::<Header>() as u64, entries: Vec::new() })
    }

    /// Adds a block; the entry's box and counts are the caller's, its place is filled in.
    pub fn add_block(&mut self, bytes: &[u8], entry: BlockEntry) -> io::Result<()> {
        let model = self.add(bytes)?;
        self.entries.push(BlockEntry { model, ..entry });
        Ok(())
    }

    /// Where the next block will be, and its number.
    pub fn position(&self) -> (u64, usize) {
        (self.at, self.entries.len())
    }

    /// Takes back what was added since.
    pub fn rewind(&mut self, (at, entries): (u64, usize)) -> io::Result<()> {
        self.out.flush()?;
        self.out.get_ref().set_len(at)?;
        self.at = at;
        self.entries.truncate(entries);
        Ok(())
    }

    pub fn add_sight(&mut self, block: usize, sight: &BlockSight) -> io::Result<()> {
        self.entries[block].sight = self.add(&sight.to_bytes())?;
        Ok(())
    }

    /// What is there so far, to be read.
    pub fn so_far(&mut self) -> io::Result<IndexFile> {
        self.out.flush()?;
        Ok(IndexFile::growing(self.out.get_ref().try_clone()?, self.entries.clone()))
    }

    /// Adds the directory and makes the file an index.
    pub fn finish(mut self, words: &[u8]) -> Result<(), IndexFault> {
        let directory = [words, self.entries.as_bytes()].concat();
        let piece = self.add(&directory)?;
        let count = u32::try_from(self.entries.len()).map_err(|_| IndexFault::TooLarge { what: "blocks" })?;
        let mut header = Header {
            magic: MAGIC,
            version: U32::new(VERSION),
            block_count: U32::new(count),
            file_length: U64::new(self.at),
            directory_at: piece.at,
            words_length: U64::new(words.len() as u64),
            directory_checksum: piece.checksum,
            reserved: [0; 16],
            checksum: U32::new(0),
        };
        header.checksum = U32::new(header.own_checksum());
        self.out.seek(SeekFrom::Start(0))?;
        self.out.write_all(header.as_bytes())?;
        Ok(self.out.flush()?)
    }

    fn add(&mut self, bytes: &[u8]) -> io::Result<Piece> {
        // Whoever reads what is there so far moves the place of the file that both share.
        self.out.seek(SeekFrom::Start(self.at))?;
        self.out.write_all(bytes)?;
        let (at, length) = (U64::new(self.at), U64::new(bytes.len() as u64));
        self.at += bytes.len() as u64;
        Ok(Piece { at, length, checksum: U32::new(crc32fast::hash(bytes)) })
    }
}

impl Header {
    pub fn own_checksum(&self) -> u32 {
        let bytes = self.as_bytes();
        crc32fast::hash(&bytes[..bytes.len() - size_of::<U32>()])
    }
}
