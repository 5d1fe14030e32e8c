//! The files of one case, in memory and in a folder.

use std::io::Result;
use std::path::{Path, PathBuf};

/// Files as they are given to a reader.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Names, with `/` between folders, and what the files hold.
    pub files: Vec<(String, Vec<u8>)>,
    /// The file that the reader is given; empty for the folder.
    pub entry: String,
}

impl Case {
    pub fn bytes(&self) -> usize {
        self.files.iter().map(|(_, bytes)| bytes.len()).sum()
    }

    /// Writes the files into a folder, which is emptied first, and gives the path that is to be read.
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        if folder.exists() {
            std::fs::remove_dir_all(folder)?;
        }
        std::fs::create_dir_all(folder)?;
        for (name, bytes) in &self.files {
            let path = folder.join(name);
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent)?;
            }
            std::fs::write(path, bytes)?;
        }
        Ok(if self.entry.is_empty() { folder.to_owned() } else { folder.join(&self.entry) })
    }
}
