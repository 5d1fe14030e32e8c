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

#[test]
fn a_reconstruction_of_which_nothing_is_known_is_found_by_the_walls_in_the_index_where_the_text_finds_it() {
    let room = room();
    let sfm = format!("{SAMPLE}/sfm");
    let told = |city: &str, out: &str| -> serde_json::Value {
        let done = cityweld(room.path(), &["align", city, &sfm, "-o", out]);
        assert!(done.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&done.stderr));
        serde_json::from_slice(&fs::read(room.path().join(out).join("alignment.json")).unwrap()).unwrap()
    };
    let (text, index) = (told("city.obj", "text"), told("city.cwi", "index"));
    for key in ["verdict", "best_candidate", "covariance"] {
        assert_eq!(text[key], index[key], "{key}");
    }
    assert_eq!(text["certainty"]["search_bits"], index["certainty"]["search_bits"]);
}

#[test]
fn a_search_without_time_ends_in_a_failure_that_says_what_share_was_searched() {
    let room = room();
    let sfm = format!("{SAMPLE}/sfm");
    for city in ["city.obj", "city.cwi"] {
        let done = cityweld(room.path(), &["align", city, &sfm, "-o", "out", "--budget", "1e-9", "--json", "--force"]);
        let told = String::from_utf8_lossy(&done.stdout).into_owned();
        assert_eq!(done.status.code(), Some(1), "{told}");
        assert!(told.contains("\"failed\"") && told.contains("0.0 % of the city"), "{told}");
    }
    let start = format!("{SAMPLE}/start.json");
    for arguments in [&["--budget", "0"][..], &["--budget", "5", "--start", &start], &["--scale-range", "3,2"]] {
        let given = [&["align", "city.obj", &sfm, "-o", "no"][..], arguments].concat();
        assert_eq!(cityweld(room.path(), &given).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn a_search_with_time_enough_answers_as_without_a_budget() {
    let room = room();
    let sfm = format!("{SAMPLE}/sfm");
    for (out, more) in [("without", &[][..]), ("with", &["--budget", "100000"])] {
        let done = cityweld(room.path(), &[&["align", "city.obj", &sfm, "-o", out][..], more].concat());
        assert!(done.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let [without, with] =
        ["without", "with"].map(|out| fs::read(room.path().join(out).join("alignment.json")).unwrap());
    assert!(without == with);
}
