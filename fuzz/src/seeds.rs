//! Sound files that are damaged: small ones of the repository, and, where they lie beside it, the real files of users' programs.

use std::path::{Path, PathBuf};

use crate::case::Case;

/// Where a seed lies, and what of it the reader is given.
pub enum Source {
    /// A file of the repository.
    File(&'static str),
    /// All files of a folder of the repository; the reader is given the named one, or the folder itself.
    Folder(&'static str, &'static str),
    /// Every file of a folder of the repository by itself.
    Each(&'static str),
    /// As `File` and `Folder`, of the folder of formats beside the repository, which need not be there.
    Beside(&'static str),
    BesideFolder(&'static str, &'static str),
}

/// Larger seeds are left out, bytes: a damaged place matters more than how many sound ones stand about it.
const LARGEST_BYTES: usize = 64 << 10;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn beside() -> PathBuf {
    std::env::var_os("CITYWELD_SHARED").map_or(repository().join("../shared"), PathBuf::from).join("data/formats")
}

/// All seeds of these sources, in their order. A file of the repository that is missing is an error, one beside it is not.
pub fn cases(sources: &[Source]) -> Result<Vec<Case>, String> {
    let mut cases = Vec::new();
    for source in sources {
        match source {
            Source::File(path) => cases.push(file(&repository().join(path))?),
            Source::Folder(path, entry) => cases.push(folder(&repository().join(path), entry)?),
            Source::Each(path) => {
                for (name, _) in folder(&repository().join(path), "")?.files {
                    cases.push(file(&repository().join(path).join(name))?);
                }
            }
            Source::Beside(path) => cases.extend(file(&beside().join(path)).ok()),
            Source::BesideFolder(path, entry) => cases.extend(folder(&beside().join(path), entry).ok()),
        }
    }
    cases.retain(|case| case.bytes() <= LARGEST_BYTES);
    Ok(cases)
}

fn file(path: &Path) -> Result<Case, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read the seed {}: {error}", path.display()))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Case { files: vec![(name.clone(), bytes)], entry: name })
}

fn folder(path: &Path, entry: &str) -> Result<Case, String> {
    let unreadable = |error| format!("cannot read the seeds in {}: {error}", path.display());
    let mut paths: Vec<PathBuf> = Vec::new();
    for found in std::fs::read_dir(path).map_err(unreadable)? {
        paths.push(found.map_err(unreadable)?.path());
    }
    paths.retain(|path| path.is_file());
    paths.sort();
    let mut files = Vec::new();
    for path in paths {
        files.extend(file(&path)?.files);
    }
    Ok(Case { files, entry: entry.to_owned() })
}
