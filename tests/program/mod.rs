//! The built program, run from outside in a folder of its own.
#![allow(dead_code, reason = "no test file needs all of it")]

use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use tempfile::TempDir;

pub fn repository(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).to_string_lossy().into_owned()
}

pub fn sample(path: &str) -> String {
    repository(&format!("assets/sample/{path}"))
}

pub fn data(path: &str) -> String {
    repository(&format!("tests/data/cli/{path}"))
}

pub fn room() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub fn cityweld(room: &TempDir, args: &[&str]) -> Output {
    cargo_bin_cmd!("cityweld").current_dir(room.path()).args(args).output().unwrap()
}

pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Asserts exit status 2, one message with every one of `says`, and an untouched folder.
pub fn refused(room: &TempDir, args: &[&str], says: &[&str]) {
    let before = names(room.path());
    let output = cityweld(room, args);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    assert!(message.starts_with("error: ") && !message.contains("panicked"), "{args:?}: {message}");
    for word in says {
        assert!(message.contains(word), "{args:?} should say \"{word}\": {message}");
    }
    assert!(output.stdout.is_empty(), "{args:?} printed {}", stdout(&output));
    assert_eq!(names(room.path()), before, "{args:?}");
}

/// `align` on the sample with one argument after another replaced.
pub struct Align {
    pub city: String,
    pub sfm: String,
    pub start: Option<String>,
    pub out: &'static str,
    pub more: Vec<String>,
}

impl Align {
    pub fn sample() -> Align {
        Align {
            city: sample("city.obj"),
            sfm: sample("sfm"),
            start: Some(sample("start.json")),
            out: "out",
            more: Vec::new(),
        }
    }

    pub fn with(more: &[&str]) -> Align {
        Align { more: more.iter().map(|word| (*word).to_owned()).collect(), ..Align::sample() }
    }

    pub fn args(&self) -> Vec<&str> {
        let mut args = vec!["align", &self.city, &self.sfm, "-o", self.out];
        if let Some(start) = &self.start {
            args.extend(["--start", start]);
        }
        args.extend(self.more.iter().map(String::as_str));
        args
    }

    pub fn refused(&self, room: &TempDir, says: &[&str]) {
        refused(room, &self.args(), says);
    }
}
