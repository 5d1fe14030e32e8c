//! The files that a path names: itself, or what lies in the folder.

use std::path::{Path, PathBuf};

use super::CityError;
use super::warning::{CityDefect, CityPlace, CityWarning};
use crate::format::file::{LARGEST_MODEL_BYTES, read_regular};

/// The files of a city, in the order of their names.
pub(super) struct CityFiles {
    pub paths: Vec<PathBuf>,
    folder: Option<PathBuf>,
    /// Files of the folder that are no city models.
    others: Vec<PathBuf>,
}

/// Endings of files that are looked into; what else lies in a folder (textures, materials, notes) is passed over unread.
const ENDINGS: [&str; 15] = [
    "obj", "gltf", "glb", "json", "jsonl", "cityjson", "gml", "xml", "b3dm", "cmpt", "stl", "ply", "shp", "gpkg", "fcb",
];

impl CityFiles {
    /// A file as it is, a folder as the city models in it. Folders within are not entered.
    pub fn at(path: &Path) -> Result<CityFiles, CityError> {
        if !path.is_dir() {
            return Ok(CityFiles { paths: vec![path.to_owned()], folder: None, others: Vec::new() });
        }
        let unreadable = |reason| CityError::Unreadable { path: path.to_owned(), reason };
        let entries = std::fs::read_dir(path).map_err(unreadable)?;
        let mut all: Vec<PathBuf> =
            entries.map(|entry| Ok(entry.map_err(unreadable)?.path())).collect::<Result<_, _>>()?;
        all.retain(|path| !name_of(path).starts_with('.') && !path.is_dir());
        all.sort();
        let (paths, others) = all.into_iter().partition(|path| is_named_as_city(path));
        Ok(CityFiles { paths, folder: Some(path.to_owned()), others })
    }

    /// Takes what a file was read to; what is no city model by its content is passed over in a folder, and refused alone.
    pub fn taken<T>(&mut self, path: &Path, read: Result<T, CityError>) -> Result<Option<T>, CityError> {
        match read {
            Err(CityError::OtherFormat { .. } | CityError::UnknownFormat { .. }) if self.folder.is_some() => {
                self.others.push(path.to_owned());
                Ok(None)
            }
            read => read.map(Some),
        }
    }

    /// What was passed over; an error where that was all.
    pub fn rest(mut self, taken: usize) -> Result<Option<CityWarning>, CityError> {
        self.others.sort();
        let count = self.others.len() as u64;
        let first = self.others.into_iter().next();
        if let Some(path) = self.folder.filter(|_| taken == 0) {
            let found = first.map_or_else(
                || "it is empty".to_owned(),
                |first| format!("{count} other files in it, such as {}", name_of(&first)),
            );
            return Err(CityError::EmptyFolder { path, found });
        }
        Ok(first.map(|path| {
            let example = CityPlace { path, line: None, object: String::new() };
            CityWarning { defect: CityDefect::NoCityFile, count, example }
        }))
    }
}

/// Reads a regular file whole.
pub(super) fn open(path: &Path) -> Result<Vec<u8>, CityError> {
    read_regular(path, LARGEST_MODEL_BYTES).map_err(|reason| CityError::Unreadable { path: path.to_owned(), reason })
}

fn is_named_as_city(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
