//! An index that is read: opened in milliseconds, the city put together of all its blocks or of those that a box of plan touches.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Serialize;

use super::assemble::{Assembled, assembled};
use super::stamp::change;
use super::words::Words;
use crate::city::files::CityFiles;
use crate::city::{CityContents, CityDefect, CityError, CityModel, CityPlace, CitySize, CityWarning, PlanBox};
use crate::format::city_index::{Block, BlockEntry, BlockSight, IndexFault, IndexFile, WallRecord};

/// What is told of an index.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IndexOverview {
    pub objects: usize,
    pub facets: usize,
    pub triangles: usize,
    /// Stretches of wall that somebody could have seen.
    pub walls: usize,
    pub blocks: usize,
    /// Box of the plan, metres of the city.
    pub low: [f64; 2],
    pub high: [f64; 2],
    pub warnings: Vec<String>,
}

/// The index of a city, open.
pub struct CityIndex {
    path: PathBuf,
    file: IndexFile,
    words: Words,
}

impl CityIndex {
    /// Opens an index; refused where the city's files are no longer those that it was made of.
    pub fn open(path: &Path) -> Result<CityIndex, CityError> {
        let of_path = |fault| CityError::Index { path: path.to_owned(), fault };
        let file = IndexFile::open(path).map_err(of_path)?;
        let mut words = Words::read(&file.words).map_err(of_path)?;
        let (change, missing) = change(&words.files, &words.folders, path, names_of_cities)
            .map_err(|reason| CityError::Unreadable { path: path.to_owned(), reason })?;
        if let Some(change) = change {
            return Err(CityError::IndexOfOther { path: path.to_owned(), change });
        }
        if missing > 0 {
            let example = CityPlace { path: path.to_owned(), line: None, object: String::new() };
            words.warnings.push(CityWarning { defect: CityDefect::IndexAlone, count: missing as u64, example });
        }
        Ok(CityIndex { path: path.to_owned(), file, words })
    }

    /// The whole city.
    pub fn read_all(&self) -> Result<CityModel, CityError> {
        self.read(&self.file.entries.iter().collect::<Vec<_>>())
    }

    /// Origin and reference system, without anything that stands there.
    pub fn read_frame(&self) -> Result<CityModel, CityError> {
        self.read(&[])
    }

    /// What stands in the blocks that a box of plan touches; where it touches none, in the nearest, so that whoever asks can tell how
    /// far off the city is.
    pub fn read_within(&self, within: &PlanBox) -> Result<CityModel, CityError> {
        self.read(&self.touched(within))
    }

    /// What stands in the blocks that any of some boxes of plan touches.
    pub fn read_about(&self, boxes: &[PlanBox]) -> Result<CityModel, CityError> {
        let local: Vec<PlanBox> = boxes.iter().map(|own| own.relative_to(self.words.origin)).collect();
        let is_touched = |entry: &&BlockEntry| local.iter().any(|own| own.gap_m(&box_of(entry)) == 0.0);
        self.read(&self.file.entries.iter().filter(is_touched).collect::<Vec<_>>())
    }

    /// The walls of the blocks that a box touches, which somebody could have seen; metres about the city's origin.
    pub fn walls_within(&self, within: &PlanBox) -> Result<Vec<WallRecord>, CityError> {
        let sights: Result<Vec<BlockSight>, IndexFault> =
            self.touched(within).par_iter().map(|entry| self.file.sight(entry)).collect();
        Ok(sights.map_err(|fault| self.fault(fault))?.into_iter().flat_map(|sight| sight.walls).collect())
    }

    /// Blocks that a box touches, of how many.
    pub fn blocks_within(&self, within: &PlanBox) -> (usize, usize) {
        (self.touched(within).len(), self.file.entries.len())
    }

    /// What is told of an index.
    pub fn overview(&self) -> IndexOverview {
        let entries = &self.file.entries;
        let boxes: Vec<PlanBox> = entries.iter().map(box_of).collect();
        let bound = |k: usize, pick: fn(f64, f64) -> f64, of: fn(&PlanBox) -> [f64; 2]| {
            boxes.iter().map(|own| of(own)[k]).reduce(pick).unwrap_or_default() + self.words.origin[k]
        };
        let CitySize { objects, facets, triangles } = self.words.size;
        IndexOverview {
            objects,
            facets,
            triangles,
            walls: entries.iter().map(BlockEntry::walls).sum(),
            blocks: entries.len(),
            low: [0, 1].map(|k| bound(k, f64::min, |own| own.low)),
            high: [0, 1].map(|k| bound(k, f64::max, |own| own.high)),
            warnings: self.words.warnings.iter().map(ToString::to_string).collect(),
        }
    }

    /// What each file holds.
    pub fn contents(&self) -> Vec<(PathBuf, CityContents)> {
        self.words.sources.iter().map(|source| (PathBuf::from(&source.path), source.contents.clone())).collect()
    }

    fn touched(&self, within: &PlanBox) -> Vec<&BlockEntry> {
        let local = within.relative_to(self.words.origin);
        let gap = |entry: &&BlockEntry| local.gap_m(&box_of(entry));
        let touched: Vec<&BlockEntry> = self.file.entries.iter().filter(|entry| gap(entry) == 0.0).collect();
        match touched.is_empty() {
            true => self.file.entries.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).into_iter().collect(),
            false => touched,
        }
    }

    fn read(&self, entries: &[&BlockEntry]) -> Result<CityModel, CityError> {
        let mut model = read_blocks(&self.file, &self.words, entries).map_err(|fault| self.fault(fault))?.model;
        model.part_of = (entries.len() < self.file.entries.len()).then(|| self.words.whole());
        Ok(model)
    }

    fn fault(&self, fault: IndexFault) -> CityError {
        CityError::Index { path: self.path.clone(), fault }
    }
}

/// Reads blocks and what can be seen of them.
pub(super) fn read_blocks(file: &IndexFile, words: &Words, entries: &[&BlockEntry]) -> Result<Assembled, IndexFault> {
    let bytes: Vec<Vec<u8>> = entries.par_iter().map(|entry| file.block_bytes(entry)).collect::<Result<_, _>>()?;
    let block = |(bytes, entry): (&'_ Vec<u8>, &&BlockEntry)| -> Result<(), IndexFault> {
        let block = Block::read(bytes, entry.model.at.get())?;
        let said = (entry.facets.get() as usize, entry.triangles.get() as usize);
        match (block.facets.len(), block.triangles.len()) == said {
            true => Ok(()),
            false => Err(IndexFault::Nonsense {
                what: "a block",
                at: entry.model.at.get(),
                found: "it has other facets than the directory says".into(),
            }),
        }
    };
    bytes.par_iter().zip(entries).map(block).collect::<Result<(), _>>()?;
    let blocks: Vec<Block> = bytes
        .par_iter()
        .zip(entries)
        .map(|(bytes, entry)| Block::read(bytes, entry.model.at.get()))
        .collect::<Result<_, _>>()?;
    let sights: Vec<BlockSight> = entries.par_iter().map(|entry| file.sight(entry)).collect::<Result<_, _>>()?;
    assembled(words, &blocks, &sights)
}

/// The box of a block in plan.
pub(super) fn box_of(entry: &BlockEntry) -> PlanBox {
    PlanBox { low: [0, 1].map(|k| entry.low[k].get()), high: [0, 1].map(|k| entry.high[k].get()) }
}

/// Names of the city files in a folder.
pub(super) fn names_of_cities(folder: &Path) -> Vec<String> {
    let paths = CityFiles::at(folder).map_or(Vec::new(), |files| files.paths);
    paths.iter().map(|path| path.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect()
}
