//! The hidden folder beside an output in which it grows. A run holds a lock in it for as long as it lives, so that the
//! next run with the same output can tell what a dead one left, and puts it right.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::output_error::OutputError;

/// What may stand in the folder; anything else there was put by somebody else.
const LOCK: &str = "lock";
const NEW: &str = "new";
const OLD: &str = "old";

/// The owner before may remove the folder while it is claimed; by the next attempt it is gone.
const CLAIM_ATTEMPTS: u32 = 20;

/// A folder that another thread is still filling may need several attempts to go away.
const REMOVAL_ATTEMPTS: u32 = 100;
const REMOVAL_PAUSE: Duration = Duration::from_millis(5);

/// A claimed work folder; removed when dropped.
pub(super) struct WorkFolder {
    folder: PathBuf,
    /// Held, not read. `None` on file systems without locks.
    _lock: Option<File>,
}

impl WorkFolder {
    /// Makes the work folder of `target`, or takes over that of a dead run: what it had set aside comes back, what it
    /// had begun goes.
    pub fn claim(target: &Path) -> Result<WorkFolder, OutputError> {
        let io = |source| OutputError::Io { path: target.into(), source };
        let folder = target.with_file_name(hidden_name(target.file_name().unwrap_or_default()));
        for _ in 0..CLAIM_ATTEMPTS {
            let is_new = match fs::create_dir(&folder) {
                Ok(()) => true,
                Err(error) if error.kind() == ErrorKind::AlreadyExists => false,
                Err(error) => return Err(io(error)),
            };
            if !is_work_folder(&folder) {
                return Err(OutputError::InTheWay { path: folder });
            }
            let lock = match File::options().create(true).truncate(false).write(true).open(folder.join(LOCK)) {
                Ok(lock) => lock,
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                Err(error) => {
                    // Without effect unless it is empty.
                    let _ = fs::remove_dir(&folder);
                    return Err(io(error));
                }
            };
            let lock = match lock.try_lock() {
                Ok(()) if was_removed(&lock) => continue,
                Ok(()) => Some(lock),
                Err(TryLockError::WouldBlock) => return Err(OutputError::Busy { path: target.into() }),
                // A file system without locks: a folder that stood there may be that of a living run.
                Err(TryLockError::Error(_)) if is_new => None,
                Err(TryLockError::Error(_)) => return Err(OutputError::InTheWay { path: folder }),
            };
            let work = WorkFolder { folder, _lock: lock };
            work.mend(target).map_err(io)?;
            return Ok(work);
        }
        Err(OutputError::Busy { path: target.into() })
    }

    /// Where the output grows.
    pub fn new_output(&self) -> PathBuf {
        self.folder.join(NEW)
    }

    /// Where what stood in the output's place waits until the new one stands there.
    pub fn old_output(&self) -> PathBuf {
        self.folder.join(OLD)
    }

    /// A run that died between its two steps had set the old output aside and put nothing in its place.
    fn mend(&self, target: &Path) -> io::Result<()> {
        let old = self.old_output();
        if exists(&old) && !exists(target) {
            fs::rename(&old, target)?;
        }
        [self.new_output(), old].iter().try_for_each(|path| remove(path))
    }
}

impl Drop for WorkFolder {
    fn drop(&mut self) {
        // The lock goes last: what cannot be removed stays with it, and the next run knows it for ours.
        for path in [self.new_output(), self.old_output(), self.folder.join(LOCK)] {
            let mut attempts = 0;
            while remove(&path).is_err() || exists(&path) {
                attempts += 1;
                if attempts == REMOVAL_ATTEMPTS {
                    return;
                }
                std::thread::sleep(REMOVAL_PAUSE);
            }
        }
        // Without effect where another run has claimed the folder already.
        let _ = fs::remove_dir(&self.folder);
    }
}

/// True for a link that leads nowhere, too: it would be in the way.
pub(super) fn exists(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

fn hidden_name(name: &OsStr) -> OsString {
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(".partial-cityweld");
    hidden
}

/// An empty folder is one that a run has just made.
fn is_work_folder(folder: &Path) -> bool {
    if !folder.symlink_metadata().is_ok_and(|found| found.is_dir()) {
        return !exists(folder);
    }
    let Ok(entries) = fs::read_dir(folder) else { return !exists(folder) };
    let names: Vec<OsString> = entries.flatten().map(|entry| entry.file_name()).collect();
    let is_known = |name: &OsString| [LOCK, NEW, OLD].iter().any(|known| name == known);
    names.is_empty() || (names.iter().all(is_known) && names.iter().any(|name| name == LOCK))
}

/// True where the lock was that of a run that has removed its folder meanwhile.
fn was_removed(lock: &File) -> bool {
    #[cfg(unix)]
    return lock.metadata().is_ok_and(|found| std::os::unix::fs::MetadataExt::nlink(&found) == 0);
    // Elsewhere a file that is open keeps its name.
    #[cfg(not(unix))]
    return lock.metadata().is_err();
}

fn remove(path: &Path) -> io::Result<()> {
    let removed = match path.symlink_metadata() {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    removed.or_else(|error| if error.kind() == ErrorKind::NotFound { Ok(()) } else { Err(error) })
}
