//! Whether the files of a city are those that an index was made of.
//!
//! Length and time of the last change tell it at once; where the time alone differs (a copy, another checkout) the content is looked at, all of it:
//! a change that leaves length and beginning as they were is a change.

use std::fs::Metadata;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};

use crate::city::warning::as_text;
use crate::format::file::open_regular;

/// What a file was when it was read.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(super) struct FileStamp {
    /// From the root; one that was moved together with the index is found beside it.
    #[serde(serialize_with = "as_text")]
    pub path: PathBuf,
    length: u64,
    /// Seconds and nanoseconds since 1970.
    modified: Option<(u64, u32)>,
    /// CRC-32.
    checksum: u32,
}

/// The city files that a folder held.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(super) struct FolderStamp {
    #[serde(serialize_with = "as_text")]
    pub path: PathBuf,
    pub names: Vec<String>,
}

/// How a city is no longer the one that an index was made of.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CityChange {
    #[error("{} had {was} bytes, and has {is}", path.display())]
    Length { path: PathBuf, was: u64, is: u64 },
    #[error("what is in {} is another", path.display())]
    Content { path: PathBuf },
    #[error("{name} came into the folder {}, or went out of it", path.display())]
    Folder { path: PathBuf, name: String },
}

/// Files that others point at, by the ending of what does: they belong to the city as well.
const COMPANIONS: [(&str, &[&str]); 2] = [("shp", &["dbf", "shx", "prj", "cpg"]), ("gltf", &["bin"])];

impl FileStamp {
    pub fn of(path: &Path) -> io::Result<FileStamp> {
        let path = path.canonicalize()?;
        let found = path.metadata()?;
        Ok(FileStamp { length: found.len(), modified: modified(&found), checksum: checksum(&path)?, path })
    }

    /// Where the file is now; `None` where it is not to be found.
    fn place(&self, index: &Path) -> Option<PathBuf> {
        let beside = index.parent().map(|folder| folder.join(self.path.file_name().unwrap_or_default()));
        [Some(self.path.clone()), beside].into_iter().flatten().find(|path| path.is_file())
    }

    /// What has changed of it; nothing where it cannot be found.
    fn change(&self, index: &Path) -> io::Result<Option<CityChange>> {
        let Some(path) = self.place(index) else { return Ok(None) };
        let found = path.metadata()?;
        if found.len() != self.length {
            return Ok(Some(CityChange::Length { path, was: self.length, is: found.len() }));
        }
        let is_same_time = self.modified.is_some() && modified(&found) == self.modified;
        let is_same = is_same_time || checksum(&path)? == self.checksum;
        Ok((!is_same).then_some(CityChange::Content { path }))
    }
}

/// The files that belong to one that is read, itself first.
pub(super) fn with_companions(path: &Path) -> Vec<PathBuf> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let endings = COMPANIONS.iter().find(|(of, _)| *of == ending).map_or(&[][..], |(_, endings)| endings);
    let others = endings.iter().map(|ending| path.with_extension(ending)).filter(|path| path.is_file());
    std::iter::once(path.to_owned()).chain(others).collect()
}

/// What has changed first, and how many of the files are not to be found.
pub(super) fn change(
    files: &[FileStamp],
    folders: &[FolderStamp],
    index: &Path,
    list: impl Fn(&Path) -> Vec<String>,
) -> io::Result<(Option<CityChange>, usize)> {
    for file in files {
        if let Some(change) = file.change(index)? {
            return Ok((Some(change), 0));
        }
    }
    for folder in folders.iter().filter(|folder| folder.path.is_dir()) {
        let names = list(&folder.path);
        let only_in = |one: &[String], other: &[String]| one.iter().find(|name| !other.contains(name)).cloned();
        if let Some(name) = only_in(&names, &folder.names).or_else(|| only_in(&folder.names, &names)) {
            return Ok((Some(CityChange::Folder { path: folder.path.clone(), name }), 0));
        }
    }
    Ok((None, files.iter().filter(|file| file.place(index).is_none()).count()))
}

fn modified(found: &Metadata) -> Option<(u64, u32)> {
    let since = found.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Some((since.as_secs(), since.subsec_nanos()))
}

fn checksum(path: &Path) -> io::Result<u32> {
    let mut file = open_regular(path)?;
    let mut hasher = crc32fast::Hasher::new();
    let mut buffer = vec![0; 1 << 18];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hasher.finalize()),
            read => hasher.update(&buffer[..read]),
        }
    }
}
