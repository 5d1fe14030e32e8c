//! An index of a city takes the place of the city: the same answers, of a part as of the whole.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/sample");

fn cityweld(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_cityweld");
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

/// A folder with the sample's city and its index.
fn room() -> tempfile::TempDir {
    let room = tempfile::tempdir().unwrap();
    fs::copy(Path::new(SAMPLE).join("city.obj"), room.path().join("city.obj")).unwrap();
    let made = cityweld(room.path(), &["index", "city.obj", "-o", "city.cwi"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    room
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files_of(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

#[test]
fn align_gives_the_same_bytes_from_an_index_as_from_the_text() {
    let room = room();
    let (sfm, start) = (format!("{SAMPLE}/sfm"), format!("{SAMPLE}/start.json"));
    for (out, city) in [("text", "city.obj"), ("index", "city.cwi")] {
        let done = cityweld(room.path(), &["align", city, &sfm, "--start", &start, "-o", out]);
        assert!(done.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let [text, index] = ["text", "index"].map(|out| files_of(&room.path().join(out)));
    assert!(text.len() > 3 && text.len() == index.len());
    for (one, other) in text.iter().zip(&index) {
        let [one_bytes, other_bytes] = [one, other].map(|path| fs::read(path).unwrap());
        // The name of the city is the one thing that may differ.
        if one.ends_with("alignment.json") {
            let [one_text, other_text] = [one_bytes, other_bytes].map(|bytes| String::from_utf8(bytes).unwrap());
            assert_eq!(one_text, other_text.replace("city.cwi", "city.obj"));
        } else {
            assert!(one_bytes == other_bytes, "{} differs", one.display());
        }
    }
}

#[test]
fn an_index_stands_wherever_a_city_does() {
    let room = room();
    for arguments in [&["planes", "city.cwi"][..], &["inspect", "city.cwi"]] {
        let done = cityweld(room.path(), arguments);
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    }
    let again = cityweld(room.path(), &["index", "city.cwi", "-o", "other.cwi"]);
    assert!(String::from_utf8_lossy(&again.stderr).contains("an index already"));
    // One that stands there is replaced when that is wished, and only then.
    assert_eq!(cityweld(room.path(), &["index", "city.obj", "-o", "city.cwi"]).status.code(), Some(2));
    assert!(cityweld(room.path(), &["index", "city.obj", "-o", "city.cwi", "--force"]).status.success());
}

#[test]
fn an_index_of_a_city_that_has_changed_is_refused_in_one_line() {
    let room = room();
    let city = room.path().join("city.obj");
    let text = fs::read_to_string(&city).unwrap();
    fs::write(&city, format!("{text}# changed\n")).unwrap();
    let refused = cityweld(room.path(), &["planes", "city.cwi"]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(message.lines().count() == 1 && message.contains("has changed since"), "{message}");
}
