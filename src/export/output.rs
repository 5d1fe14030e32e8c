//! Output that is made whole or not at all: it grows in a hidden folder beside its place and takes the place in one step.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use super::earlier::{UnpackedFile, foreign_file};
use super::output_error::OutputError;
use super::work::{WorkFolder, exists};

/// What is made at the place that the user named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    Folder,
    File,
}

/// What may be replaced.
#[derive(Clone, Copy, Debug)]
pub enum Replace {
    Nothing,
    /// What an earlier run made; these files count as made by it where they stand as they were unpacked.
    EarlierRun(&'static [UnpackedFile]),
}

/// Output under way. Dropped before [`Output::commit`], it leaves nothing behind.
pub struct Output {
    target: PathBuf,
    replace: Replace,
    growing: PathBuf,
    /// `None` once committed or discarded.
    work: Arc<Mutex<Option<WorkFolder>>>,
}

/// Removes output under way from another thread; without effect once it is committed.
#[derive(Clone)]
pub struct Discard(Arc<Mutex<Option<WorkFolder>>>);

impl Output {
    /// Makes the hidden folder beside `target`, so that a place that cannot be written to is found out at once.
    pub fn begin(target: &Path, kind: OutputKind, replace: Replace) -> Result<Output, OutputError> {
        let name = target.file_name().ok_or_else(|| OutputError::NoName { path: target.into() })?;
        let parent = parent_of(target);
        if !parent.exists() {
            return Err(OutputError::NoParent { path: parent });
        }
        if !parent.is_dir() {
            return Err(OutputError::ParentIsAFile { path: parent });
        }
        // Without a slash at its end, behind which a link would be followed.
        let target = target.with_file_name(name);
        let work = WorkFolder::claim(&target)?;
        may_replace(&target, replace)?;
        let growing = work.new_output();
        if kind == OutputKind::Folder {
            std::fs::create_dir(&growing).map_err(|source| OutputError::Io { path: target.clone(), source })?;
        }
        Ok(Output { target, replace, growing, work: Arc::new(Mutex::new(Some(work))) })
    }

    /// Where to write: the folder under way, or the file.
    pub fn path(&self) -> &Path {
        &self.growing
    }

    pub fn discard(&self) -> Discard {
        Discard(Arc::clone(&self.work))
    }

    /// Puts the finished output in its place. What stood there goes only now, and stays if that fails.
    pub fn commit(self) -> Result<(), OutputError> {
        // The lock is held to the end: an interruption comes before all of this or after all of it.
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(work) = work.take() else { return Err(OutputError::Interrupted { path: self.target.clone() }) };
        // Looked at again: the run may have taken hours.
        may_replace(&self.target, self.replace)?;
        let placed = if exists(&self.target) {
            exchange(&self.growing, &self.target).or_else(|error| match is_unsupported(&error) {
                true => replace_in_two_steps(&self.growing, &self.target, &work.old_output()),
                false => Err(error),
            })
        } else {
            rename_to_free_place(&self.growing, &self.target)
        };
        placed.map_err(|source| match source.kind() {
            ErrorKind::AlreadyExists => OutputError::Exists { path: self.target.clone() },
            _ => OutputError::Io { path: self.target.clone(), source },
        })
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
        drop(self.0.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
}

/// Refuses a place where something would be lost.
fn may_replace(target: &Path, replace: Replace) -> Result<(), OutputError> {
    let path = || target.to_path_buf();
    let unpacked = match replace {
        _ if !exists(target) => return Ok(()),
        Replace::Nothing => return Err(OutputError::Exists { path: path() }),
        Replace::EarlierRun(unpacked) => unpacked,
    };
    match foreign_file(target, unpacked) {
        Ok(None) => Ok(()),
        Ok(Some(foreign)) => Err(OutputError::Foreign { path: path(), foreign }),
        Err(source) => Err(OutputError::Io { path: path(), source }),
    }
}

fn parent_of(target: &Path) -> PathBuf {
    match target.parent() {
        Some(parent) if parent != Path::new("") => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Exchanges two names in one step: a run that is killed leaves the one or the other in `target`, never nothing.
#[cfg(target_os = "linux")]
fn exchange(new: &Path, target: &Path) -> Result<(), Error> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, new, CWD, target, RenameFlags::EXCHANGE)?)
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> Result<(), Error> {
    Err(ErrorKind::Unsupported.into())
}

/// Renames, and never onto something that has come there meanwhile.
fn rename_to_free_place(new: &Path, target: &Path) -> Result<(), Error> {
    #[cfg(target_os = "linux")]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        let renamed = renameat_with(CWD, new, CWD, target, RenameFlags::NOREPLACE).map_err(Error::from);
        if !renamed.as_ref().is_err_and(is_unsupported) {
            return renamed;
        }
    }
    if exists(target) { Err(ErrorKind::AlreadyExists.into()) } else { std::fs::rename(new, target) }
}

/// Where names cannot be exchanged. A run that is killed between the steps leaves `old`, which the next one puts back.
fn replace_in_two_steps(new: &Path, target: &Path, old: &Path) -> Result<(), Error> {
    std::fs::rename(target, old)?;
    std::fs::rename(new, target).inspect_err(|_| {
        let _ = std::fs::rename(old, target);
    })
}

/// What file systems and kernels answer that do not know these flags.
fn is_unsupported(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::Unsupported | ErrorKind::InvalidInput)
}

#[cfg(test)]
mod tests;
