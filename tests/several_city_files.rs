//! A city that is given as several files: one city in every command that takes one, as a folder of tiles is.

use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use tempfile::TempDir;

fn repository(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).to_string_lossy().into_owned()
}

fn cityweld(room: &TempDir, args: &[&str]) -> Output {
    cargo_bin_cmd!("cityweld").current_dir(room.path()).args(args).output().unwrap()
}

/// A folder `tiles` with the sample's city as two files, every other object in each.
fn room_with_halves() -> TempDir {
    let room = tempfile::tempdir().unwrap();
    let whole = std::fs::read_to_string(repository("assets/sample/city.obj")).unwrap();
    std::fs::create_dir(room.path().join("tiles")).unwrap();
    for half in [0, 1] {
        let mut object = 0;
        let is_of_half = |line: &&str| {
            object += usize::from(line.starts_with("o "));
            // Faces count all vertices before them.
            line.starts_with("v ") || object % 2 == half
        };
        let lines: Vec<&str> = whole.lines().filter(is_of_half).collect();
        std::fs::write(room.path().join(format!("tiles/half_{half}.obj")), lines.join("\n")).unwrap();
    }
    room
}

const HALVES: [&str; 2] = ["tiles/half_0.obj", "tiles/half_1.obj"];

fn report(room: &TempDir, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(room.path().join(name)).unwrap()).unwrap()
}

/// Aligns the sample with that city.
fn aligned(room: &TempDir, city: &[&str]) -> Value {
    let [sfm, start] = ["sfm", "start.json"].map(|name| repository(&format!("assets/sample/{name}")));
    let args = [&["align"], city, &[&sfm, "--start", &start, "-o", "out", "--force"]].concat();
    let output = cityweld(room, &args);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    report(room, "out/alignment.json")
}

#[test]
fn two_files_are_aligned_with_as_the_folder_that_holds_them() {
    let room = room_with_halves();
    let [mut of_files, mut of_folder] = [aligned(&room, &HALVES), aligned(&room, &["tiles"])];
    assert_eq!(of_files["input"]["city"]["files"], serde_json::json!(["half_0.obj", "half_1.obj"]));
    for report in [&mut of_files, &mut of_folder] {
        report["input"]["city"]["files"].take();
    }
    assert_eq!(of_files, of_folder);
}

#[test]
fn an_index_of_two_files_and_an_export_into_them_hold_the_objects_of_both() {
    let room = room_with_halves();
    let objects = |city: &[&str]| {
        let output = cityweld(&room, &[&["planes", "--json"], city].concat());
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["objects"].clone()
    };
    let whole = objects(&[&repository("assets/sample/city.obj")]);
    assert_eq!(objects(&HALVES), whole);
    let indexed = cityweld(&room, &[&["index"], &HALVES[..], &["-o", "city.cwi"]].concat());
    assert_eq!(indexed.status.code(), Some(0));
    assert_eq!(objects(&["city.cwi"]), whole);

    let start = r#"{"transform": {"scale": 1, "rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [0,0,0]}}"#;
    std::fs::write(room.path().join("edited.json"), start).unwrap();
    let cloud = repository("tests/data/cli/three_points.ply");
    let rest = [&cloud, "--alignment", "edited.json", "--format", "glb"];
    for (city, out) in [(&HALVES[..], "of_files"), (&["tiles"], "of_folder")] {
        let written = cityweld(&room, &[&["export"], city, &rest, &["-o", out]].concat());
        assert_eq!(written.status.code(), Some(0), "{}", String::from_utf8_lossy(&written.stderr));
    }
    let scene = |out: &str| std::fs::read(room.path().join(out).join("scene.glb")).unwrap();
    assert!(scene("of_files") == scene("of_folder"));
}

#[test]
fn parts_meet_in_a_city_whose_files_are_named_one_by_one() {
    let room = room_with_halves();
    let [sfm, start] = ["sfm", "start.json"].map(|name| repository(&format!("assets/sample/{name}")));
    let merged = |city: &[&str]| {
        let rest = ["--start", &start, "--start", &start, "-o", "out", "--force"];
        cityweld(&room, &[&["merge", &sfm, &sfm], city, &rest].concat());
        let mut report = report(&room, "out/merge.json");
        report["warnings"].take();
        report
    };
    let of_files = merged(&["--city", HALVES[0], "--city", HALVES[1]]);
    assert_eq!(of_files["frame"], "the city's");
    assert_eq!(of_files, merged(&["--city", "tiles"]));
}

#[test]
fn a_file_that_is_given_twice_or_in_the_wrong_place_is_refused() {
    let room = room_with_halves();
    let sfm = repository("assets/sample/sfm");
    let [first, second] = HALVES;
    // Either of them may come first.
    let line = format!("give: cityweld align {second} {first} {sfm}");
    let once = "a file of the city is given twice, leave one out";
    for (args, says) in [
        (&["align", first, first, &sfm, "-o", "out"][..], once),
        (&["align", "tiles", second, &sfm, "-o", "out"], once),
        (&["align", second, "tiles", &sfm, "-o", "out"], once),
        (&["index", first, "tiles/../tiles/half_0.obj", "-o", "city.cwi"], once),
        (&["planes", first, second, "--terrain", second], "the city is given again as terrain"),
        (&["align", &sfm, first, second, "-o", "out"], &line),
        (&["align", first, second, "-o", "out"], "SFM is a city model"),
        (&["align", first, "none.obj", &sfm, "-o", "out"], "none.obj"),
        (&["align", first, second, &sfm, "-o", "tiles", "--force"], "would replace an input"),
    ] {
        let output = cityweld(&room, args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.starts_with("error: ") && message.contains(says), "{args:?} should say {says}: {message}");
        assert!(!room.path().join("out").exists());
    }
}
