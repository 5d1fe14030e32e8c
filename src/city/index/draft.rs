//! An index in the making: the blocks of a model are written; what can be seen of each is asked of them and their neighbours, and comes after.

use std::path::{Path, PathBuf};

use super::assemble::Assembled;
use super::open::{box_of, names_of_cities, read_blocks};
use super::pack::{SAME, packed};
use super::plan::{BLOCK_M, block_plans};
use super::sequence::Sequence;
use super::stamp::{FileStamp, FolderStamp, with_companions};
use super::words::Words;
use crate::city::files::CityFiles;
use crate::city::read::read_city_files;
use crate::city::{CityError, CityOptions, PlanBox};
use crate::format::city_index::{BlockEntry, BlockSight, IndexFault, IndexWriter};

/// An index whose blocks are written.
pub struct IndexDraft {
    path: PathBuf,
    writer: IndexWriter,
    words: Words,
}

/// A model around some blocks of a draft.
pub struct Surroundings {
    pub city: Assembled,
    /// The blocks in it, in the order of `city`'s lists.
    pub blocks: Vec<usize>,
}

impl IndexDraft {
    /// Reads a city and writes its blocks to a file that grows at `path`.
    pub fn of_city(
        city: &[PathBuf],
        terrain: &[PathBuf],
        options: &CityOptions,
        path: &Path,
    ) -> Result<IndexDraft, CityError> {
        IndexDraft::of_long_city(city, terrain, options, path, STREAMED_BYTES)
    }

    /// The same, where a sequence of at least so many bytes is not held in memory.
    pub(super) fn of_long_city(
        city: &[PathBuf],
        terrain: &[PathBuf],
        options: &CityOptions,
        path: &Path,
        streamed_bytes: u64,
    ) -> Result<IndexDraft, CityError> {
        let (files, folders) = stamps(city, terrain)?;
        let of_path = |fault| CityError::Index { path: path.to_owned(), fault };
        let mut writer = written(IndexWriter::create(path), path)?;
        if let ([only], []) = (city, terrain)
            && let Some(sequence) = Sequence::of(only, options, streamed_bytes)?
        {
            let words = sequence.write(&mut writer, Words::of_files(files, folders))?;
            return Ok(IndexDraft { path: path.to_owned(), writer, words });
        }
        let model = read_city_files(city, terrain, options)?;
        for plan in block_plans(&model) {
            let (parts, entry) = packed(&model, &plan, &SAME);
            let bytes = parts.to_bytes().map_err(of_path)?;
            written(writer.add_block(&bytes, entry), path)?;
        }
        Ok(IndexDraft { path: path.to_owned(), writer, words: Words::of(&model, files, folders) })
    }

    /// The box of each block, metres about the city's origin.
    pub fn boxes(&self) -> Vec<PlanBox> {
        self.writer.entries.iter().map(box_of).collect()
    }

    /// Side of a block, metres.
    pub fn block_m(&self) -> f64 {
        BLOCK_M
    }

    /// Puts together the blocks that come within `reach_m` of some.
    pub fn around(&mut self, blocks: &[usize], reach_m: f64) -> Result<Surroundings, CityError> {
        let boxes: Vec<PlanBox> = blocks.iter().map(|&block| box_of(&self.writer.entries[block])).collect();
        let entries = self.writer.entries.clone();
        let is_near = |entry: &BlockEntry| boxes.iter().any(|own| own.gap_m(&box_of(entry)) <= reach_m);
        let near: Vec<usize> = (0..entries.len()).filter(|&block| is_near(&entries[block])).collect();
        let read = self.writer.so_far().map_err(IndexFault::from).and_then(|file| {
            let entries: Vec<&BlockEntry> = near.iter().map(|&block| &entries[block]).collect();
            read_blocks(&file, &self.words, &entries)
        });
        Ok(Surroundings { city: read.map_err(|fault| self.fault(fault))?, blocks: near })
    }

    /// Adds what can be seen of a block.
    pub fn add_sight(&mut self, block: usize, sight: &BlockSight) -> Result<(), CityError> {
        self.writer.add_sight(block, sight).map_err(|error| self.fault(error.into()))
    }

    /// Makes the file an index.
    pub fn finish(self) -> Result<(), CityError> {
        let of_path = |fault| CityError::Index { path: self.path.clone(), fault };
        let words = serde_json::to_vec(&self.words).map_err(|error| of_path(std::io::Error::from(error).into()))?;
        self.writer.finish(&words).map_err(of_path)
    }

    fn fault(&self, fault: IndexFault) -> CityError {
        CityError::Index { path: self.path.clone(), fault }
    }
}

/// A CityJSONSeq from this length on is read a square kilometre at a time. Chosen: what is shorter comes to half a gigabyte of memory.
const STREAMED_BYTES: u64 = 64 << 20;

/// What became of writing to an index.
pub(super) fn written<T>(result: std::io::Result<T>, path: &Path) -> Result<T, CityError> {
    result.map_err(|error| CityError::Index { path: path.to_owned(), fault: error.into() })
}

/// What the files of a city are now.
fn stamps(city: &[PathBuf], terrain: &[PathBuf]) -> Result<(Vec<FileStamp>, Vec<FolderStamp>), CityError> {
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for path in city.iter().chain(terrain) {
        let unreadable = |reason| CityError::Unreadable { path: path.clone(), reason };
        if path.is_dir() {
            folders.push(FolderStamp { path: path.canonicalize().map_err(unreadable)?, names: names_of_cities(path) });
        }
        for file in CityFiles::at(path)?.paths.iter().flat_map(|path| with_companions(path)) {
            files.push(FileStamp::of(&file).map_err(unreadable)?);
        }
    }
    Ok((files, folders))
}
