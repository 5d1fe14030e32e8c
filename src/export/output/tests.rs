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
