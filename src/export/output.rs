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
mod tests {
    use super::*;
    use std::fs;
    use tempfile::TempDir;

    const EARLIER: Replace = Replace::EarlierRun(&[("sample/a.txt", b"unpacked")]);
    const REPORT: &str = r#"{"schema": "cityweld.alignment/1", "transform": null}"#;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// A folder with `out` as an earlier run left it.
    fn after_a_run() -> (TempDir, PathBuf) {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        fs::create_dir_all(target.join("sfm")).unwrap();
        fs::create_dir_all(target.join("sample")).unwrap();
        fs::write(target.join("alignment.json"), REPORT).unwrap();
        fs::write(target.join("sfm/cameras.txt"), "").unwrap();
        fs::write(target.join("sample/a.txt"), "unpacked").unwrap();
        (room, target)
    }

    fn begin(target: &Path, replace: Replace) -> Result<Output, OutputError> {
        Output::begin(target, OutputKind::Folder, replace)
    }

    #[test]
    fn appears_only_when_it_is_whole() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        let output = begin(&target, Replace::Nothing).unwrap();
        fs::write(output.path().join("a"), "1").unwrap();
        assert!(!target.exists());
        output.commit().unwrap();
        assert_eq!(names(room.path()), ["out"]);
        assert_eq!(names(&target), ["a"]);
    }

    #[test]
    fn leaves_nothing_behind_when_dropped_or_discarded() {
        let room = tempfile::tempdir().unwrap();
        let output = begin(&room.path().join("out"), Replace::Nothing).unwrap();
        let known_elsewhere = output.discard();
        drop(output);
        assert!(names(room.path()).is_empty());
        known_elsewhere.discard();
        let output = Output::begin(&room.path().join("out"), OutputKind::File, Replace::Nothing).unwrap();
        fs::write(output.path(), "1").unwrap();
        output.discard().discard();
        assert!(matches!(output.commit(), Err(OutputError::Interrupted { .. })));
        assert!(names(room.path()).is_empty());
    }

    #[test]
    fn keeps_what_stands_there_until_the_new_is_whole() {
        let (room, target) = after_a_run();
        assert!(matches!(begin(&target, Replace::Nothing), Err(OutputError::Exists { .. })));
        let output = begin(&target, EARLIER).unwrap();
        assert_eq!(names(&target), ["alignment.json", "sample", "sfm"]);
        fs::write(output.path().join("new"), "1").unwrap();
        output.commit().unwrap();
        assert_eq!(names(room.path()), ["out"]);
        assert_eq!(names(&target), ["new"]);
    }

    #[test]
    fn replaces_nothing_that_no_earlier_run_made() {
        type Change = fn(&Path) -> std::io::Result<()>;
        let changes: [(&str, Change); 10] = [
            ("notes.txt", |out| fs::write(out.join("notes.txt"), "mine")),
            ("sfm/database.db", |out| fs::write(out.join("sfm/database.db"), "mine")),
            ("photos/deep/a.jpg", |out| {
                fs::create_dir_all(out.join("photos/deep"))?;
                fs::write(out.join("photos/deep/a.jpg"), "mine")
            }),
            ("empty", |out| fs::create_dir(out.join("empty"))),
            ("scene.glb", |out| fs::write(out.join("scene.glb"), "glTF mine")),
            ("points.ply", |out| fs::write(out.join("points.ply"), "ply\nformat ascii 1.0\n")),
            ("merge.json", |out| fs::write(out.join("merge.json"), r#"{"schema": "mine"}"#)),
            ("alignment.json", |out| fs::write(out.join("alignment.json"), "{}")),
            ("sample/a.txt", |out| fs::write(out.join("sample/a.txt"), "unpacked and edited")),
            // Without a file that is ours by its content, files that are ours by name may be anybody's.
            ("sample/a.txt", |out| fs::remove_file(out.join("alignment.json"))),
        ];
        for (lost, change) in changes {
            let (room, target) = after_a_run();
            change(&target).unwrap();
            match begin(&target, EARLIER).err() {
                Some(OutputError::Foreign { foreign, .. }) => assert_eq!(foreign, target.join(lost)),
                other => panic!("{lost}: {other:?}"),
            }
            assert_eq!(names(room.path()), ["out"], "{lost}");
        }
    }

    #[test]
    fn sees_what_is_put_there_while_it_grows() {
        let (room, target) = after_a_run();
        let output = begin(&target, EARLIER).unwrap();
        fs::write(target.join("notes.txt"), "mine").unwrap();
        assert!(matches!(output.commit(), Err(OutputError::Foreign { .. })));
        assert_eq!(fs::read_to_string(target.join("notes.txt")).unwrap(), "mine");
        assert_eq!(names(room.path()), ["out"]);

        let target = room.path().join("other");
        let output = begin(&target, Replace::Nothing).unwrap();
        fs::create_dir(&target).unwrap();
        assert!(matches!(output.commit(), Err(OutputError::Exists { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn follows_no_link() {
        let (room, target) = after_a_run();
        let link = room.path().join("link");
        std::os::unix::fs::symlink(&target, &link).unwrap();
        for named in [link.clone(), link.join("")] {
            assert!(matches!(begin(&named, EARLIER), Err(OutputError::Foreign { .. })), "{named:?}");
        }
        std::os::unix::fs::symlink(target.join("sfm"), target.join("points.ply")).unwrap();
        assert!(matches!(begin(&target, EARLIER), Err(OutputError::Foreign { .. })));
        assert_eq!(names(&target), ["alignment.json", "points.ply", "sample", "sfm"]);
    }

    #[test]
    fn one_run_at_a_time_makes_an_output() {
        let (_room, target) = after_a_run();
        let first = begin(&target, EARLIER).unwrap();
        assert!(matches!(begin(&target, EARLIER), Err(OutputError::Busy { .. })));
        first.commit().unwrap();
        assert!(begin(&target, EARLIER).is_ok());
    }

    #[test]
    fn clears_up_after_a_run_that_was_killed() {
        let (room, target) = after_a_run();
        let work = room.path().join(".out.partial-cityweld");
        let begun = || {
            fs::create_dir_all(work.join("new/sfm")).unwrap();
            fs::write(work.join("lock"), "").unwrap();
        };
        begun();
        assert!(matches!(begin(&target, Replace::Nothing), Err(OutputError::Exists { .. })));
        assert_eq!(names(room.path()), ["out"]);
        // Killed after the old output was set aside, before the new one took its place.
        begun();
        fs::rename(&target, work.join("old")).unwrap();
        drop(begin(&target, EARLIER).unwrap());
        assert_eq!(names(room.path()), ["out"]);
        assert_eq!(fs::read_to_string(target.join("alignment.json")).unwrap(), REPORT);
    }

    #[test]
    fn removes_no_hidden_folder_of_somebody_else() {
        let (room, target) = after_a_run();
        let work = room.path().join(".out.partial-cityweld");
        fs::create_dir(&work).unwrap();
        fs::write(work.join("notes.txt"), "mine").unwrap();
        assert!(matches!(begin(&target, EARLIER), Err(OutputError::InTheWay { .. })));
        fs::write(work.join("lock"), "").unwrap();
        assert!(matches!(begin(&target, EARLIER), Err(OutputError::InTheWay { .. })));
        assert_eq!(names(&work), ["lock", "notes.txt"]);
    }

    #[test]
    fn in_two_steps_the_old_comes_back_where_the_new_cannot_take_its_place() {
        let (room, target) = after_a_run();
        let (new, old) = (room.path().join("new"), room.path().join("old"));
        assert!(replace_in_two_steps(&new, &target, &old).is_err());
        assert_eq!(names(room.path()), ["out"]);
        fs::create_dir(&new).unwrap();
        replace_in_two_steps(&new, &target, &old).unwrap();
        assert_eq!(names(room.path()), ["old", "out"]);
        assert!(names(&target).is_empty());
    }

    #[test]
    fn refuses_places_that_cannot_hold_it() {
        let room = tempfile::tempdir().unwrap();
        let file = room.path().join("file");
        fs::write(&file, "1").unwrap();
        let refusal = |path: &Path| begin(path, EARLIER).err().unwrap();
        assert!(matches!(refusal(&file), OutputError::Foreign { .. }));
        assert!(matches!(refusal(&file.join("out")), OutputError::ParentIsAFile { .. }));
        assert!(matches!(refusal(&room.path().join("none/out")), OutputError::NoParent { .. }));
        assert!(matches!(refusal(Path::new("..")), OutputError::NoName { .. }));
        assert_eq!(names(room.path()), ["file"]);
    }

    #[cfg(unix)]
    #[test]
    fn is_as_open_to_others_as_any_new_folder() {
        use std::os::unix::fs::PermissionsExt;
        let room = tempfile::tempdir().unwrap();
        let plain = room.path().join("plain");
        fs::create_dir(&plain).unwrap();
        let output = begin(&room.path().join("out"), Replace::Nothing).unwrap();
        output.commit().unwrap();
        let mode = |name: &str| room.path().join(name).metadata().unwrap().permissions().mode();
        assert_eq!(mode("out"), mode("plain"));
    }
}
