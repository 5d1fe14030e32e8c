//! Where the reconstruction stands, without a matrix: the program run on what people have.

mod json_schema;

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use tempfile::TempDir;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn data(name: &str) -> String {
    repository("tests/data/positions").join(name).to_string_lossy().into_owned()
}

/// A folder with the sample's city in the Dutch grid, as `city.obj`, and a few photographs with positions.
fn room() -> TempDir {
    let room = tempfile::tempdir().unwrap();
    let city = std::fs::read_to_string(repository("assets/sample/city.obj")).unwrap();
    let shifted = city.lines().map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z] => {
                let [x, y] = [x, y].map(|v| v.parse::<f64>().unwrap());
                format!("v {:.3} {:.3} {z}\n", x + 90_400.0, y + 435_400.0)
            }
            _ => format!("{line}\n"),
        }
    });
    std::fs::write(room.path().join("city.obj"), shifted.collect::<String>()).unwrap();
    room
}

fn cityweld(room: &TempDir, args: &[&str]) -> Output {
    cargo_bin_cmd!("cityweld").current_dir(room.path()).args(args).output().unwrap()
}

fn align(room: &TempDir, more: &[&str]) -> Output {
    let sfm = repository("assets/sample/sfm");
    cityweld(room, &[&["align", "city.obj", sfm.to_str().unwrap()], more].concat())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Exit status 2 and one message that says all of these; nothing is written.
fn refused(room: &TempDir, more: &[&str], says: &[&str]) {
    let output = align(room, &[more, &["-o", "out"]].concat());
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{more:?}: {message}");
    says.iter().for_each(|words| assert!(message.contains(words), "{more:?} should say {words}: {message}"));
    assert!(!room.path().join("out").exists());
}

/// Where the sample stands: the middle of the reconstruction, to a metre.
const MIDDLE: [f64; 3] = [90_860.0, 435_665.0, 5.0];

#[test]
fn degrees_and_control_points_align_the_sample_and_check_points_are_reported() {
    let room = room();
    let (geo, couples) = (data("geo.txt"), data("couples.txt"));
    let output =
        align(&room, &["--positions", &geo, "--points", &couples, "--crs", "EPSG:28992", "-o", "out", "--json"]);
    let report = json(&output);
    assert_eq!(report["verdict"], "aligned", "{}", report["reason"]);
    let source = report["prior"]["source"].as_str().unwrap();
    assert!(
        source.contains("24 photographs (geo.txt") && source.contains("5 control points (couples.txt)"),
        "{source}"
    );
    assert_eq!(report["control_points"].as_array().unwrap().len(), 5);
    let check = &report["check_points"][0];
    assert_eq!((check["name"].as_str(), check["role"].as_str()), (Some("gcp6"), Some("check")));
    assert!(check["distance"].as_f64().unwrap() < 0.15, "{check}");
    let schema: Value =
        serde_json::from_str(&std::fs::read_to_string(repository("assets/alignment.schema.json")).unwrap()).unwrap();
    assert!(json_schema::keeps(&report, &schema, &schema), "the report keeps to its schema");
    // The prior is a start by itself.
    std::fs::write(room.path().join("prior.json"), report["prior"].to_string()).unwrap();
    let again = json(&align(&room, &["--start", "prior.json", "--dry-run", "--json"]));
    assert_eq!(again["translation"], report["prior"]["translation"]);
}

#[test]
fn every_source_puts_the_sample_in_its_place_and_a_dry_run_writes_nothing() {
    let room = room();
    for (option, file, reach_m) in [
        ("--positions", "geo.txt", 4.0),
        ("--positions", "reference.csv", 4.0),
        ("--positions", "name_x_y_z.txt", 4.0),
        ("--positions", "exif", 6.0),
        ("--photos", "exif", 6.0),
        ("--points", "gcp_list.txt", 0.3),
        ("--points", "couples.txt", 0.1),
    ] {
        let found = json(&align(&room, &[option, &data(file), "--crs", "EPSG:28992", "--dry-run", "--json"]));
        let truth = json(&align(&room, &["--points", &data("couples.txt"), "--dry-run", "--json"]));
        let place = |start: &Value, k: usize| start["middle"][k].as_f64().unwrap();
        let off: f64 = (0..3).map(|k| (place(&found, k) - place(&truth, k)).powi(2)).sum::<f64>().sqrt();
        assert!(off < reach_m, "{file}: {off} m");
        assert!((0..2).all(|k| (place(&found, k) - MIDDLE[k]).abs() < 60.0), "{}", found["middle"]);
        assert!(found["distance"].as_f64().unwrap() < 60.0 && found["position_sigma"].as_f64().unwrap() < 6.0);
    }
    let table = text(&align(&room, &["--positions", &data("name_x_y_z.txt"), "--dry-run"]).stdout);
    assert!(
        table.starts_with("start: positions of 24 photographs") && table.contains("m from the city's nearest facet")
    );
    let names: Vec<_> = std::fs::read_dir(room.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["city.obj"]);
}

#[test]
fn sources_that_place_nothing_are_refused_with_what_to_do() {
    let room = room();
    let geo = data("geo.txt");
    refused(&room, &["--positions", &geo], &["geo.txt holds longitudes and latitudes", "--crs EPSG:"]);
    refused(&room, &["--positions", &geo, "--crs", "EPSG:25832"], &["km from the city's nearest facet", "--crs"]);
    refused(&room, &["--positions", &geo, "--crs", "RD"], &["--crs", "EPSG:<code>"]);
    refused(&room, &["--positions", "none.txt"], &["cannot read the positions", "none.txt"]);
    refused(&room, &["--positions", "city.obj"], &["--positions is a city model"]);
    refused(&room, &["--points", &geo], &["line 2"]);
    refused(&room, &["--photos", &data("exif")], &["exif", "--crs EPSG:<code>"]);
    let words = std::fs::read_to_string(data("name_x_y_z.txt")).unwrap();
    let swapped = words.lines().map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        format!("{} {} {} {}\n", words[0], words[2], words[1], words[3])
    });
    std::fs::write(room.path().join("swapped.txt"), swapped.collect::<String>()).unwrap();
    refused(&room, &["--positions", "swapped.txt"], &["mirror image", "east and north are exchanged", "swapped.txt"]);
}

#[test]
fn with_nothing_said_of_the_place_the_city_is_searched() {
    let room = room();
    let report = json(&align(&room, &["-o", "out", "--json"]));
    assert_eq!((&report["verdict"], &report["prior"]), (&Value::from("aligned"), &Value::Null), "{}", report["reason"]);
    assert_eq!(report["search"]["solver"], "walls in plan");
    let dry = align(&room, &["--dry-run"]);
    assert!(
        text(&dry.stderr).contains("the city would be searched")
            || text(&dry.stdout).contains("the city would be searched")
    );
    let far = align(&room, &["--near", "190000,535000,100", "-o", "far"]);
    assert_eq!(far.status.code(), Some(1), "{}", text(&far.stderr));
}

#[test]
fn sources_that_contradict_each_other_are_both_named() {
    let room = room();
    let words = std::fs::read_to_string(data("couples.txt")).unwrap();
    std::fs::write(
        room.path().join("elsewhere.txt"),
        words.replace(" 4357", " 4358").replace(" 4356", " 4357").replace(" 4355", " 4356"),
    )
    .unwrap();
    let says = ["name_x_y_z.txt", "elsewhere.txt", "do not agree: place by"];
    refused(&room, &["--positions", &data("name_x_y_z.txt"), "--points", "elsewhere.txt"], &says);
}

#[test]
fn a_matrix_of_text_is_a_start() {
    let room = room();
    let start = json(&align(&room, &["--points", &data("couples.txt"), "--dry-run", "--json"]));
    let number = |value: &Value| value.as_f64().unwrap();
    let scale = number(&start["scale"]);
    let row = |i: usize| {
        let r = &start["rotation"][i];
        let cells = (0..3).map(|k| scale * number(&r[k])).chain([number(&start["translation"][i])]);
        cells.map(|v| format!("{v:.12}")).collect::<Vec<_>>().join(" ")
    };
    std::fs::write(room.path().join("m.txt"), format!("{}\n{}\n{}\n0 0 0 1\n", row(0), row(1), row(2))).unwrap();
    let found = json(&align(&room, &["--start", "m.txt", "--dry-run", "--json"]));
    assert!((number(&found["middle"][0]) - number(&start["middle"][0])).abs() < 1e-3);
    assert_eq!(found["position_sigma"], 10.0);
    std::fs::write(room.path().join("m.txt"), "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1").unwrap();
    refused(&room, &["--start", "m.txt"], &["mirrors", "m.txt"]);
}

#[test]
fn inspect_tells_every_input_in_one_array() {
    let room = room();
    let sfm = repository("assets/sample/sfm");
    let paths = [sfm.to_string_lossy().into_owned(), data("exif"), data("geo.txt"), data("gcp_list.txt")];
    let mut args = vec!["inspect", "city.obj", "--json"];
    args.extend(paths.iter().map(String::as_str));
    let found = json(&cityweld(&room, &args));
    let kinds: Vec<_> = found.as_array().unwrap().iter().map(|one| one["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["city", "reconstruction", "photographs", "positions", "points"]);
    assert_eq!(
        (&found[0]["objects"], &found[1]["images"], &found[1]["format"]),
        (&527.into(), &24.into(), &"COLMAP".into())
    );
    assert_eq!(
        (&found[2]["images"], &found[3]["crs"]["epsg"], &found[4]["points"]),
        (&3.into(), &4326.into(), &6.into())
    );
    let table = text(&cityweld(&room, &["inspect", "city.obj"]).stdout);
    assert!(table.starts_with("city.obj: OBJ") && table.contains("90"), "{table}");
    let output = cityweld(&room, &["inspect", "none.obj", "--json"]);
    assert!(output.status.code() == Some(2) && output.stdout.is_empty() && text(&output.stderr).contains("none.obj"));
}

#[test]
fn shells_manuals_and_the_version_are_served() {
    let room = room();
    assert!(text(&cityweld(&room, &["completions", "bash"]).stdout).contains("--positions"));
    assert!(text(&cityweld(&room, &["man", "align"]).stdout).contains("positions"));
    assert_eq!(cityweld(&room, &["man", "-o", "pages"]).status.code(), Some(0));
    assert!(room.path().join("pages/cityweld.1").exists() && room.path().join("pages/cityweld-align.1").exists());
    let version = text(&cityweld(&room, &["--version"]).stdout);
    assert!(
        version.starts_with(concat!("cityweld ", env!("CARGO_PKG_VERSION"))) && version.contains("features: cli"),
        "{version}"
    );
    assert_eq!(cityweld(&room, &["man", "nothing"]).status.code(), Some(2));
}
