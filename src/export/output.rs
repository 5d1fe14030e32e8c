//! Output that is made whole or not at all: built beside its place under a hidden name, then renamed.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tempfile::TempDir;

/// A folder that another thread is still filling may need several attempts to go away.
const REMOVAL_ATTEMPTS: u32 = 100;
const REMOVAL_PAUSE: Duration = Duration::from_millis(5);

/// What is made at the place that the user named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    Folder,
    File,
}

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error("the output exists already; name another place or give --force to replace it: {}", path.display())]
    Exists { path: PathBuf },
    #[error("the output needs a name of its own, not a root, \".\" or \"..\": {}", path.display())]
    NoName { path: PathBuf },
    #[error("the folder that shall hold the output does not exist; make it first: {}", path.display())]
    NoParent { path: PathBuf },
    #[error("the output would lie inside a file, expected a folder: {}", path.display())]
    ParentIsAFile { path: PathBuf },
    #[error("cannot write the output: {source}: {}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("interrupted, nothing was written: {}", path.display())]
    Interrupted { path: PathBuf },
}

/// Output under way. Dropped before [`Output::commit`], it leaves nothing behind.
pub struct Output {
    target: PathBuf,
    kind: OutputKind,
    replace: bool,
    name: OsString,
    building: PathBuf,
    /// `None` once committed or discarded.
    folder: Arc<Mutex<Option<TempDir>>>,
}

/// Removes output under way from another thread; without effect once it is committed.
#[derive(Clone)]
pub struct Discard(Arc<Mutex<Option<TempDir>>>);

impl Output {
    /// Makes the hidden folder beside `target`, so that a place that cannot be written to is found out at once.
    pub fn begin(target: &Path, kind: OutputKind, replace: bool) -> Result<Output, OutputError> {
        let path = || target.to_path_buf();
        let name = target.file_name().ok_or_else(|| OutputError::NoName { path: path() })?.to_owned();
        if exists(target) && !replace {
            return Err(OutputError::Exists { path: path() });
        }
        let parent = parent_of(target);
        if !parent.exists() {
            return Err(OutputError::NoParent { path: parent });
        }
        if !parent.is_dir() {
            return Err(OutputError::ParentIsAFile { path: parent });
        }
        let folder =
            hidden_folder(&parent, &name, "partial").map_err(|source| OutputError::Io { path: path(), source })?;
        let building = folder.path().to_path_buf();
        Ok(Output { target: path(), kind, replace, name, building, folder: Arc::new(Mutex::new(Some(folder))) })
    }

    /// Where to write: the folder under way, or the file in it.
    pub fn path(&self) -> PathBuf {
        match self.kind {
            OutputKind::Folder => self.building.clone(),
            OutputKind::File => self.building.join(&self.name),
        }
    }

    pub fn discard(&self) -> Discard {
        Discard(Arc::clone(&self.folder))
    }

    /// Puts the finished output in its place. What stood there goes only now, and comes back if the last step fails.
    pub fn commit(self) -> Result<(), OutputError> {
        let io = |source| OutputError::Io { path: self.target.clone(), source };
        // The lock is held to the end: an interruption comes before all of this or after all of it.
        let mut folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        if folder.is_none() {
            return Err(OutputError::Interrupted { path: self.target.clone() });
        }
        let old = self.set_old_aside()?;
        if let Err(source) = std::fs::rename(self.path(), &self.target) {
            if let Some(old) = &old {
                std::fs::rename(old.path().join(&self.name), &self.target).map_err(io)?;
            }
            return Err(io(source));
        }
        // The folder's hidden name is gone with the rename, so it must not be removed any more.
        if let (Some(folder), OutputKind::Folder) = (folder.take(), self.kind) {
            let _ = folder.keep();
        }
        Ok(())
    }

    fn set_old_aside(&self) -> Result<Option<TempDir>, OutputError> {
        if !exists(&self.target) {
            return Ok(None);
        }
        if !self.replace {
            return Err(OutputError::Exists { path: self.target.clone() });
        }
        let io = |source| OutputError::Io { path: self.target.clone(), source };
        let aside = hidden_folder(&parent_of(&self.target), &self.name, "old").map_err(io)?;
        std::fs::rename(&self.target, aside.path().join(&self.name)).map_err(io)?;
        Ok(Some(aside))
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        // Without effect once committed. Whoever else knows of the folder does not keep it alive.
        self.discard().discard();
    }
}

impl Discard {
    pub fn discard(&self) {
        let Some(folder) = self.0.lock().unwrap_or_else(PoisonError::into_inner).take() else { return };
        let path = folder.keep();
        for _ in 0..REMOVAL_ATTEMPTS {
            let _ = std::fs::remove_dir_all(&path);
            if !exists(&path) {
                return;
            }
            std::thread::sleep(REMOVAL_PAUSE);
        }
    }
}

/// True for a link that leads nowhere, too: it would be in the way.
fn exists(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

fn parent_of(target: &Path) -> PathBuf {
    match target.parent() {
        Some(parent) if parent != Path::new("") => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

fn hidden_folder(parent: &Path, name: &OsString, role: &str) -> std::io::Result<TempDir> {
    let mut prefix = OsString::from(".");
    prefix.push(name);
    prefix.push(format!(".{role}-"));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    // A temporary folder is closed to other users by default; this one becomes the output, as open as any new folder.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.tempdir_in(parent)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn appears_only_when_it_is_whole() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        let output = Output::begin(&target, OutputKind::Folder, false).unwrap();
        std::fs::write(output.path().join("a"), "1").unwrap();
        assert!(!target.exists());
        output.commit().unwrap();
        assert_eq!(names(room.path()), ["out"]);
        assert_eq!(names(&target), ["a"]);
    }

    #[test]
    fn leaves_nothing_behind_when_dropped_or_discarded() {
        let room = tempfile::tempdir().unwrap();
        let output = Output::begin(&room.path().join("out"), OutputKind::Folder, false).unwrap();
        let known_elsewhere = output.discard();
        drop(output);
        assert!(names(room.path()).is_empty());
        known_elsewhere.discard();
        let output = Output::begin(&room.path().join("out"), OutputKind::File, false).unwrap();
        std::fs::write(output.path(), "1").unwrap();
        output.discard().discard();
        assert!(matches!(output.commit(), Err(OutputError::Interrupted { .. })));
        assert!(names(room.path()).is_empty());
    }

    #[test]
    fn keeps_what_stands_there_until_the_new_is_whole() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        std::fs::create_dir(&target).unwrap();
        std::fs::write(target.join("old"), "1").unwrap();
        assert!(matches!(Output::begin(&target, OutputKind::Folder, false), Err(OutputError::Exists { .. })));
        let output = Output::begin(&target, OutputKind::Folder, true).unwrap();
        assert_eq!(names(&target), ["old"]);
        std::fs::write(output.path().join("new"), "1").unwrap();
        output.commit().unwrap();
        assert_eq!(names(room.path()), ["out"]);
        assert_eq!(names(&target), ["new"]);
    }

    #[test]
    fn refuses_places_that_cannot_hold_it() {
        let room = tempfile::tempdir().unwrap();
        let file = room.path().join("file");
        std::fs::write(&file, "1").unwrap();
        let begin = |path: &Path| Output::begin(path, OutputKind::Folder, true).err().unwrap();
        assert!(matches!(begin(&file.join("out")), OutputError::ParentIsAFile { .. }));
        assert!(matches!(begin(&room.path().join("none/out")), OutputError::NoParent { .. }));
        assert!(matches!(begin(Path::new("..")), OutputError::NoName { .. }));
        assert_eq!(names(room.path()), ["file"]);
    }

    #[cfg(unix)]
    #[test]
    fn is_as_open_to_others_as_any_new_folder() {
        use std::os::unix::fs::PermissionsExt;
        let room = tempfile::tempdir().unwrap();
        let plain = room.path().join("plain");
        std::fs::create_dir(&plain).unwrap();
        let output = Output::begin(&room.path().join("out"), OutputKind::Folder, false).unwrap();
        output.commit().unwrap();
        let mode = |name: &str| room.path().join(name).metadata().unwrap().permissions().mode();
        assert_eq!(mode("out"), mode("plain"));
    }
}
