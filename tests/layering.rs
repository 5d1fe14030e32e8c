//! Each room imports only from rooms that its line here allows; the lines leave no way round in a circle.
//! `ARCHITECTURE.md` says why.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A room, and the rooms it may import. Every room stands below all rooms that it names.
const ALLOWED: &[(&str, &[&str])] = &[
    ("limits", &[]),
    ("observer", &[]),
    ("geometry", &[]),
    ("random", &["geometry"]),
    ("format", &["geometry"]),
    ("city", &["geometry", "format"]),
    ("reconstruction", &["geometry", "format"]),
    ("imagery", &["observer", "geometry", "format", "reconstruction"]),
    ("solvers", &["geometry", "random"]),
    ("problem", &["geometry", "format", "solvers"]),
    ("robust", &["geometry", "random", "solvers"]),
    ("planes", &["limits", "geometry", "city", "reconstruction", "imagery", "robust"]),
    ("georeference", &["limits", "geometry", "format", "city", "reconstruction", "robust", "planes"]),
    ("place_search", &["limits", "observer", "geometry", "robust", "planes"]),
    ("correspondence", &["limits", "observer", "geometry", "city", "planes", "solvers", "robust"]),
    ("evidence", &["limits", "geometry", "planes", "correspondence"]),
    ("uncertainty", &["limits", "geometry", "city", "planes", "correspondence", "robust"]),
    ("verdict", &["limits", "geometry", "robust"]),
    ("city_index", &["limits", "observer", "format", "city", "planes", "place_search"]),
    (
        "merging",
        &[
            "limits",
            "observer",
            "geometry",
            "format",
            "reconstruction",
            "imagery",
            "solvers",
            "robust",
            "planes",
            "verdict",
        ],
    ),
    ("export", &["geometry", "format", "city", "reconstruction", "planes", "georeference", "verdict", "merging"]),
    (
        "align",
        &[
            "limits",
            "observer",
            "geometry",
            "format",
            "city",
            "reconstruction",
            "imagery",
            "robust",
            "planes",
            "place_search",
            "correspondence",
            "evidence",
            "uncertainty",
            "verdict",
        ],
    ),
    ("merge", &["limits", "observer", "geometry", "imagery", "reconstruction", "planes", "merging", "align"]),
    (
        "error",
        &[
            "observer",
            "geometry",
            "format",
            "city",
            "reconstruction",
            "imagery",
            "georeference",
            "city_index",
            "merging",
            "export",
        ],
    ),
    ("inspect", &["limits", "geometry", "format", "city", "reconstruction", "planes", "error"]),
    // Parses, reads, writes and prints: it neither searches nor estimates.
    (
        "cli",
        &[
            "limits",
            "observer",
            "geometry",
            "format",
            "city",
            "reconstruction",
            "imagery",
            "solvers",
            "problem",
            "planes",
            "georeference",
            "place_search",
            "city_index",
            "verdict",
            "merging",
            "export",
            "align",
            "merge",
            "inspect",
        ],
    ),
    // For tests, examples and benchmarks: no room may import it.
    ("synthetic", &["geometry", "city", "reconstruction", "imagery", "solvers", "verdict"]),
];

fn source(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(path)
}

fn rust_files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_file() {
        found.extend(path.extension().filter(|ending| *ending == "rs").map(|_| path.to_path_buf()));
        return;
    }
    for entry in std::fs::read_dir(path).unwrap() {
        rust_files(&entry.unwrap().path(), found);
    }
}

/// A file's own code: without comments, and without its tests, which may build their scenes from any room. Tests in a file of
/// their own (`tests.rs`, or below a folder `tests`), and the scenes that tests share (`test_scene.rs`), are nothing else.
fn code_of(path: &Path) -> String {
    let is_test = path.file_name().is_some_and(|name| name == "tests.rs" || name == "test_scene.rs")
        || path.parent().is_some_and(|folder| folder.ends_with("tests"));
    if is_test {
        return String::new();
    }
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// The first names after every `crate::`, those in braces included.
fn rooms_named_in(code: &str) -> BTreeSet<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut found = BTreeSet::new();
    for (place, _) in code.match_indices("crate::") {
        // `$crate::` and `othercrate::` are something else.
        if code[..place].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[place + "crate::".len()..];
        match rest.strip_prefix('{') {
            None => {
                found.insert(word(rest));
            }
            Some(list) => found.extend(top_level_items(list).iter().map(|item| word(item.trim()))),
        }
    }
    found
}

/// Items between commas up to the brace that closes the list.
fn top_level_items(list: &str) -> Vec<String> {
    let (mut depth, mut items) = (0, vec![String::new()]);
    for c in list.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => items.push(String::new()),
            _ => {}
        }
        if let Some(item) = items.last_mut() {
            item.push(c);
        }
    }
    items.iter().map(|item| item.trim_start_matches(',').to_owned()).filter(|item| !item.trim().is_empty()).collect()
}

#[test]
fn every_room_imports_only_what_it_may() {
    let names: BTreeSet<_> = ALLOWED.iter().map(|(room, _)| *room).collect();
    let mut wrong = Vec::new();
    for (room, allowed) in ALLOWED {
        let mut files = Vec::new();
        let folder = source(room);
        rust_files(&if folder.is_dir() { folder } else { source(&format!("{room}.rs")) }, &mut files);
        for file in files {
            for named in rooms_named_in(&code_of(&file)) {
                if names.contains(named.as_str()) && named != *room && !allowed.contains(&named.as_str()) {
                    wrong.push(format!("{} imports {named}", file.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn no_room_stands_above_one_that_it_imports() {
    let place: BTreeMap<_, _> = ALLOWED.iter().enumerate().map(|(place, (room, _))| (*room, place)).collect();
    for (room, allowed) in ALLOWED {
        for other in *allowed {
            assert!(place[other] < place[room], "{room} may import {other}, which stands below it");
        }
    }
}

#[test]
fn every_room_is_on_the_list() {
    for entry in std::fs::read_dir(source("")).unwrap() {
        let name = entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned();
        // The table of contents and the start of the program stand above all rooms.
        let known = ["lib", "main"].contains(&name.as_str()) || ALLOWED.iter().any(|(room, _)| *room == name);
        assert!(known, "src/{name} is not on the list of rooms");
    }
}

#[test]
fn only_the_command_line_knows_the_crates_of_the_command_line() {
    let mut files = Vec::new();
    rust_files(&source(""), &mut files);
    for file in files.iter().filter(|file| !file.starts_with(source("cli"))) {
        let code = code_of(file);
        for of_program in ["clap::", "anyhow::", "indicatif::", "ctrlc::", "signal_hook::", "crate::cli"] {
            assert!(!code.contains(of_program), "{} names {of_program}", file.display());
        }
        assert!(!code.contains("#[path"), "{} takes in a file from elsewhere", file.display());
    }
}

#[test]
fn tests_reach_the_data_beside_the_project_through_one_door() {
    // That door (tests/needs) is what makes missing data fail under CITYWELD_REQUIRE_DATA.
    let path = ["join(\"..", "/shared"].concat();
    let mut files = Vec::new();
    for folder in ["tests", "src", "benches", "examples"] {
        rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut files);
    }
    let own_way = |file: &&PathBuf| std::fs::read_to_string(file).unwrap().contains(&path);
    let found: Vec<_> = files.iter().filter(own_way).collect();
    assert!(matches!(found[..], [door] if door.ends_with("tests/needs/mod.rs")), "{found:?}");
}

#[test]
fn imports_are_read_in_every_form() {
    let code = "use crate::geometry::{Plane, Point3};\nuse crate::{city::{CityModel, Facet}, planes as p,\n  align};\n\
                fn f(x: crate::robust::Loss) { $crate::no!(); other_crate::no() }";
    let expected = ["align", "city", "geometry", "planes", "robust"].map(str::to_owned);
    assert_eq!(rooms_named_in(code), BTreeSet::from(expected));
}
