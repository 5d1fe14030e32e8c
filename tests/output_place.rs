//! Where output goes, from outside: what `--force` replaces, what a killed run leaves, what cannot be written.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

fn sample(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample").join(path).to_string_lossy().into_owned()
}

fn command(room: &TempDir, args: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("cityweld"));
    command.current_dir(room.path()).args(args);
    command
}

fn cityweld(room: &TempDir, args: &[&str]) -> Output {
    command(room, args).output().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// `export` writes every kind of file quickly.
fn export(room: &TempDir, out: &str, more: &[&str]) -> Output {
    let alignment = room.path().join("placed.json");
    let transform = r#"{"scale": 2, "rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [10,20,30]}"#;
    std::fs::write(&alignment, format!(r#"{{"transform": {transform}}}"#)).unwrap();
    let (city, sfm) = (sample("city.obj"), sample("sfm"));
    let args = ["export", &city, &sfm, "--alignment", "placed.json", "-o", out];
    cityweld(room, &[&args[..], more].concat())
}

fn assert_status(output: &Output, expected: i32) {
    assert_eq!(output.status.code(), Some(expected), "{}", stderr(output));
}

#[test]
fn force_replaces_what_every_command_made() {
    let room = tempfile::tempdir().unwrap();
    let (city, sfm) = (sample("city.obj"), sample("sfm"));
    for command in [
        &["demo", "-o", "out"][..],
        &["planes", &city, "-o", "planes.json"],
        &["planes", &city, "-o", "planes.glb"],
        &["merge", &sfm, &sfm, "-o", "merged"],
    ] {
        let first = cityweld(&room, command);
        assert!(matches!(first.status.code(), Some(0 | 1)), "{}", stderr(&first));
        assert_status(&cityweld(&room, command), 2);
        let again = cityweld(&room, &[command, &["--force"]].concat());
        assert_eq!(again.status.code(), first.status.code(), "{command:?}: {}", stderr(&again));
    }
    for formats in ["glb,colmap,ply", "glb", "ply"] {
        assert_status(&export(&room, "exported", &["--force", "--format", formats]), 0);
    }
    // A folder of the demo holds the sample; an export has no such thing.
    assert_status(&export(&room, "out", &["--force"]), 0);
    assert_eq!(names(&room.path().join("out")), ["points.ply", "scene.glb", "sfm"]);
    assert_eq!(names(room.path()), ["exported", "merged", "out", "placed.json", "planes.glb", "planes.json"]);
}

#[test]
fn force_names_what_would_be_lost() {
    let room = tempfile::tempdir().unwrap();
    assert_status(&export(&room, "out", &[]), 0);
    let notes = room.path().join("out/sfm/notes.txt");
    std::fs::write(&notes, "mine").unwrap();
    let refused = export(&room, "out", &["--force"]);
    assert_status(&refused, 2);
    assert!(stderr(&refused).contains("out/sfm/notes.txt would be lost"), "{}", stderr(&refused));
    assert_eq!(std::fs::read_to_string(notes).unwrap(), "mine");
    let refused = cityweld(&room, &["planes", &sample("city.obj"), "-o", "placed.json", "--force"]);
    assert_status(&refused, 2);
    assert!(stderr(&refused).contains("placed.json would be lost"), "{}", stderr(&refused));
}

#[cfg(unix)]
#[test]
fn what_a_killed_run_leaves_is_gone_after_the_next() {
    let room = tempfile::tempdir().unwrap();
    let (city, sfm, start, labels) = (sample("city.obj"), sample("sfm"), sample("start.json"), sample("labels"));
    let args = ["align", &city, &sfm, "--start", &start, "--labels", &labels, "-o", "out"];
    let mut child = command(&room, &args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let work = room.path().join(".out.partial-cityweld");
    while !work.join("new").exists() {
        assert!(child.try_wait().unwrap().is_none(), "the program ended before it could be killed");
        std::thread::yield_now();
    }
    // While it lives, it has the place to itself.
    let second = export(&room, "out", &[]);
    assert_status(&second, 2);
    assert!(stderr(&second).contains("another run is making this output"), "{}", stderr(&second));
    assert!(child.try_wait().unwrap().is_none(), "the program ended before it could be killed");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(work.exists());
    assert_status(&export(&room, "out", &[]), 0);
    assert_eq!(names(room.path()), ["out", "placed.json"]);
}

/// `/dev/full` takes no byte, as a full disk.
#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_cannot_be_written_is_told() {
    let room = tempfile::tempdir().unwrap();
    let problem = r#"{"kind": "rigid", "points": [], "planes": [], "pairs": []}"#;
    std::fs::write(room.path().join("problem.json"), problem).unwrap();
    let (city, sfm) = (sample("city.obj"), sample("sfm"));
    for (args, written) in [
        (&["--help"][..], false),
        (&["align", "--help"], false),
        (&["--version"], false),
        (&["solve", "problem.json"], false),
        (&["planes", &city], false),
        (&["planes", &city, "--json"], false),
        (&["planes", &city, "-o", "planes.json", "--quiet"], true),
        (&["merge", &sfm, &sfm, "-o", "merged", "--quiet"], true),
        (&["demo", "-o", "out", "--json"], true),
    ] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command(&room, args).stdout(full).stderr(Stdio::piped()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let message = stderr(&output);
        assert!(message.contains("error: ") && message.contains("standard output"), "{args:?}: {message}");
        assert_eq!(message.contains("is written"), written, "{args:?}: {message}");
    }
    assert_eq!(names(room.path()), ["merged", "out", "planes.json", "problem.json"]);
}

#[cfg(unix)]
#[test]
fn output_that_does_not_fit_is_an_error_and_leaves_nothing() {
    let room = tempfile::tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin!("cityweld").to_string_lossy().into_owned();
    let script = format!("ulimit -f 64; exec '{program}' demo -o out");
    let output = Command::new("sh").args(["-c", &script]).current_dir(room.path()).output().unwrap();
    assert_status(&output, 2);
    assert!(stderr(&output).starts_with("error: cannot "), "{}", stderr(&output));
    assert_eq!(names(room.path()), Vec::<String>::new());

    // Before any command is carried out.
    let script = format!("ulimit -f 1; exec '{program}' align --help > help.txt");
    let output = Command::new("sh").args(["-c", &script]).current_dir(room.path()).output().unwrap();
    assert_status(&output, 2);
    assert!(stderr(&output).starts_with("error: cannot write to standard output"), "{}", stderr(&output));
}
