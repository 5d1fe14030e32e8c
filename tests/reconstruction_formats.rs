//! Reconstructions in the forms that people have them: LAS, E57, OpenSfM, nerfstudio, OpenMVG, Bundler, NVM.

use std::path::PathBuf;

use cityweld::read_reconstruction;
use serde_json::Value;

/// Real files with the answers of a right reader, where they are there.
fn shared() -> Option<PathBuf> {
    let folder = PathBuf::from("/work/shared/data/formats");
    folder.join("expected.json").is_file().then_some(folder)
}

#[test]
fn shared_files_give_the_numbers_that_were_counted_independently() {
    let Some(folder) = shared() else { return };
    let expected: Value = serde_json::from_slice(&std::fs::read(folder.join("expected.json")).unwrap()).unwrap();
    let mut failures = Vec::new();
    for (name, expected) in expected.as_object().unwrap() {
        if expected["kind"] != "reconstruction" {
            continue;
        }
        let read = match read_reconstruction(&folder.join(name)) {
            Ok(read) => read,
            Err(error) => {
                failures.push(format!("{name}: {error}"));
                continue;
            }
        };
        let warnings: String = read.warnings.iter().map(|w| format!("{w}; ")).collect();
        println!("{name}: {}, {} images, {} points, {:?}; {warnings}", read.format, read.images.len(), read.points.len(), read.crs.as_ref().map(|c| c.epsg));
        let mut check = |key: &str, found: Value| {
            if !expected[key].is_null() && expected[key] != found {
                failures.push(format!("{name}: {key} {found}, expected {}", expected[key]));
            }
        };
        check("points", read.points.len().into());
        check("images", read.images.len().into());
        check("epsg", read.crs.as_ref().and_then(|crs| crs.epsg).into());
        if let Some(format) = expected["format"].as_str().filter(|format| !read.format.to_string().starts_with(format)) {
            failures.push(format!("{name}: {}, expected {format}", read.format));
        }
        if let Some(words) = expected["warns"].as_str().filter(|words| !words.split('|').any(|w| warnings.contains(w))) {
            failures.push(format!("{name}: no warning of {words} in {warnings}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}
