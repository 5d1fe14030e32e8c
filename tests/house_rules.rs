//! What the house says of itself: its size, its plan, and that nothing outside tests can end the program.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

fn files_of(folders: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    folders.iter().for_each(|folder| rust_files(&root().join(folder), &mut found));
    found.sort();
    assert!(found.len() > 10, "{found:?}");
    found
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// What stands between backticks in a text and looks like a file or folder.
fn paths_named(text: &str) -> BTreeSet<String> {
    let pieces = text.split('`').skip(1).step_by(2);
    let is_name = |name: &&str| {
        let letters = name.chars().all(|c| c.is_ascii_alphanumeric() || "_./".contains(c));
        letters && (name.ends_with(".rs") || name.ends_with(".md") || name.ends_with('/'))
    };
    pieces.filter(is_name).map(str::to_owned).collect()
}

/// The tails of all paths below some folders: of `src/city/units.rs` also `city/units.rs` and `units.rs`; a folder with a slash behind.
fn tails(folders: &[&str]) -> BTreeSet<String> {
    let mut tails = BTreeSet::new();
    let mut files = Vec::new();
    folders.iter().for_each(|folder| rust_files(&root().join(folder), &mut files));
    for file in files {
        let path = file.strip_prefix(root()).unwrap().to_str().unwrap().to_owned();
        let parts: Vec<&str> = path.split('/').collect();
        for from in 0..parts.len() {
            tails.insert(parts[from..].join("/"));
            tails.extend((from + 1..parts.len()).map(|to| parts[from..to].join("/") + "/"));
        }
    }
    tails
}

/// Whether a name is that of a path from the project's folder or from the source.
fn is_path(name: &str) -> bool {
    root().join(name).exists() || root().join("src").join(name).exists()
}

#[test]
fn every_file_and_folder_that_the_plan_names_is_there() {
    let tails = tails(&["src", "tests", "fuzz/src", "benches", "examples"]);
    let named = paths_named(&read(&root().join("ARCHITECTURE.md")));
    assert!(named.len() > 150, "only {} names were found", named.len());
    let missing: Vec<_> = named.iter().filter(|name| !tails.contains(*name) && !is_path(name)).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md names what is not there: {missing:?}");
}

#[test]
fn what_the_plan_names_of_a_room_is_in_that_room() {
    let text = read(&root().join("ARCHITECTURE.md"));
    let rooms = text.split("\n## ").find(|part| part.starts_with("Rooms")).unwrap();
    let mut missing = Vec::new();
    let mut told = 0;
    for paragraph in rooms.split("\n* **").skip(1) {
        let (room, rest) = paragraph.split_once("**").unwrap();
        let folder = format!("src/{room}");
        let own = if is_path(&folder) { tails(&[&folder]) } else { BTreeSet::new() };
        told += 1;
        let elsewhere = |name: &String| !own.contains(name) && !is_path(name);
        missing.extend(paths_named(rest).into_iter().filter(elsewhere).map(|name| format!("{room}: {name}")));
    }
    assert!(told > 20, "only {told} rooms were found");
    assert!(missing.is_empty(), "ARCHITECTURE.md names in a room what is not in it: {missing:?}");
}

#[test]
fn every_room_of_the_source_is_in_the_plan() {
    let text = read(&root().join("ARCHITECTURE.md"));
    for entry in std::fs::read_dir(root().join("src")).unwrap() {
        let name = entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned();
        let is_named = [format!("**{name}**"), format!("`{name}.rs`"), format!("`{name}/"), format!("`src/{name}")];
        let is_table = ["lib", "main", "error", "align", "merge"].contains(&name.as_str()) && text.contains(&name);
        assert!(is_table || is_named.iter().any(|way| text.contains(way)), "ARCHITECTURE.md does not name src/{name}");
    }
}

#[test]
fn names_of_files_are_told_from_other_words() {
    let found = paths_named("`read.rs` reads (`city/`, `x = y.rs`, `--lod`), see `docs/golden.md` and `city.obj`");
    assert_eq!(found, ["read.rs", "city/", "docs/golden.md"].map(str::to_owned).into());
}

#[test]
fn no_file_is_longer_than_a_person_keeps_in_view() {
    let mut lengths = Vec::new();
    for file in files_of(&["src", "tests", "benches", "examples"]) {
        let length = read(&file).lines().count();
        assert!(length <= 450, "{} has {length} lines; it answers more than one question", file.display());
        lengths.push(length);
    }
    lengths.sort_unstable();
    let nine_in_ten = lengths[lengths.len() * 9 / 10];
    assert!(nine_in_ten <= 250, "nine in ten files have up to {nine_in_ten} lines");
}

/// First line and length of each function: from `fn` to the brace that closes it at the same depth.
fn functions(text: &str) -> Vec<(usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let indent = |line: &str| line.len() - line.trim_start().len();
    let begins = |line: &str| {
        let words = line.trim_start().trim_start_matches("pub ").trim_start_matches("const ");
        words.starts_with("fn ") || (line.trim_start().starts_with("pub(") && line.contains(") fn "))
    };
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate().filter(|(_, line)| begins(line)) {
        // rustfmt puts what closes a function where it began: a brace, or the semicolon of one without a body.
        let is_end = |other: &str| other.trim_start().starts_with('}') || other.ends_with(';') || other.ends_with("{}");
        let closes = |other: &&str| indent(other) == indent(line) && (is_end(other) || other.ends_with(" }"));
        if let Some(length) = lines[at..].iter().position(closes) {
            found.push((at + 1, length + 1));
        }
    }
    found
}

#[test]
fn no_function_is_longer_than_a_page() {
    for file in files_of(&["src"]) {
        for (line, length) in functions(&read(&file)) {
            assert!(length <= 60, "{}:{line}: a function of {length} lines", file.display());
        }
    }
}

#[test]
fn functions_are_measured_from_their_first_line_to_their_brace() {
    let text = "fn one() {\n    two();\n}\n\nimpl A {\n    pub(super) fn two(\n        a: u8,\n    ) -> u8 {\n        a\n    }\n\n    fn three();\n}\n";
    assert_eq!(functions(text), [(1, 3), (6, 5), (12, 1)]);
}
