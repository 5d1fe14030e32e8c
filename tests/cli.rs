//! The built program from outside: exit statuses, what is written and what is not, what is said.

use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use assert_cmd::cargo::cargo_bin_cmd;
use tempfile::TempDir;

fn repository(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).to_string_lossy().into_owned()
}

fn sample(path: &str) -> String {
    repository(&format!("assets/sample/{path}"))
}

fn data(path: &str) -> String {
    repository(&format!("tests/data/cli/{path}"))
}

/// Runs the program in a folder of its own.
fn cityweld(room: &TempDir, args: &[&str]) -> Output {
    cargo_bin_cmd!("cityweld").current_dir(room.path()).args(args).output().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Asserts exit status 2, one message with every one of `says`, and an untouched folder.
fn refused(room: &TempDir, args: &[&str], says: &[&str]) {
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
struct Align {
    city: String,
    sfm: String,
    start: Option<String>,
    out: &'static str,
    more: Vec<String>,
}

impl Align {
    fn sample() -> Align {
        Align {
            city: sample("city.obj"),
            sfm: sample("sfm"),
            start: Some(sample("start.json")),
            out: "out",
            more: Vec::new(),
        }
    }

    fn with(more: &[&str]) -> Align {
        Align { more: more.iter().map(|word| (*word).to_owned()).collect(), ..Align::sample() }
    }

    fn args(&self) -> Vec<&str> {
        let mut args = vec!["align", &self.city, &self.sfm, "-o", self.out];
        if let Some(start) = &self.start {
            args.extend(["--start", start]);
        }
        args.extend(self.more.iter().map(String::as_str));
        args
    }

    fn refused(&self, room: &TempDir, says: &[&str]) {
        refused(room, &self.args(), says);
    }
}

fn room() -> TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn demo_is_aligned_and_writes_what_it_names() {
    let room = room();
    let output = cityweld(&room, &["demo", "-o", "out"]);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{text}{}", stderr(&output));
    assert!(text.starts_with("aligned: ") && text.contains("out/scene.glb"), "{text}");
    assert_eq!(names(room.path()), ["out"]);
    assert_eq!(names(&room.path().join("out")), ["alignment.json", "points.ply", "sample", "scene.glb", "sfm"]);
    assert_eq!(
        names(&room.path().join("out/sfm")),
        ["cameras.txt", "frames.txt", "images.txt", "points3D.txt", "rigs.txt"]
    );
    let again: Vec<&str> = text.lines().last().unwrap().split_whitespace().skip(1).collect();
    let repeated = cityweld(&room, &again);
    assert_eq!(repeated.status.code(), Some(0), "{}", stderr(&repeated));
    let report = |folder: &str| std::fs::read(room.path().join(folder).join("alignment.json")).unwrap();
    assert_eq!(report("out"), report("again"));
}

#[test]
fn same_bytes_come_out_for_any_number_of_threads() {
    let room = room();
    for threads in ["1", "2", "5"] {
        let labels = sample("labels");
        let align = Align { out: "out", ..Align::with(&["--labels", &labels, "--threads", threads, "--seed", "7"]) };
        let mut args = align.args();
        args[4] = threads;
        let output = cityweld(&room, &args);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", stderr(&output));
    }
    for file in ["alignment.json", "scene.glb", "points.ply", "sfm/images.txt"] {
        let bytes = |threads: &str| std::fs::read(room.path().join(threads).join(file)).unwrap();
        assert!(bytes("1") == bytes("2") && bytes("1") == bytes("5"), "{file} differs");
    }
}

#[test]
fn json_on_standard_output_is_the_report() {
    let room = room();
    let labels = sample("labels");
    let output = cityweld(&room, &Align::with(&["--labels", &labels, "--json", "--quiet"]).args());
    let written = std::fs::read_to_string(room.path().join("out/alignment.json")).unwrap();
    assert_eq!(stdout(&output), written);
    assert_eq!(stderr(&output), "");
    let report: serde_json::Value = serde_json::from_str(&written).unwrap();
    assert_eq!(report["schema"], "cityweld.alignment/1");
    assert_eq!(report["input"]["sfm"]["images"], 24);
    assert_eq!(report["input"]["city"]["files"][0], "city.obj");
}

#[test]
fn refuses_starts_that_are_none() {
    let room = room();
    let table = [
        ("unknown_key.json", "unknown field `position_sigmas`"),
        ("nan.json", "line 1"),
        ("infinite.json", "out of range"),
        ("scale_zero.json", "scale is 0"),
        ("scale_negative.json", "scale is -2"),
        ("reflection.json", "reflection"),
        ("sheared.json", "not orthonormal"),
        ("two_rows.json", "length 2"),
        ("negative_sigma.json", "height_sigma"),
        ("no_rotation.json", "missing field `rotation`"),
        ("truncated.json", "EOF"),
        ("list.json", "3 numbers; expected four rows of four numbers"),
    ];
    assert_eq!(names(Path::new(&data("start"))).len(), table.len());
    for (file, says) in table {
        let start = data(&format!("start/{file}"));
        Align { start: Some(start.clone()), ..Align::sample() }.refused(&room, &[says, &start]);
    }
    let missing = data("start/none.json");
    Align { start: Some(missing.clone()), ..Align::sample() }.refused(&room, &["cannot read the start", &missing]);
    let folder = data("start");
    Align { start: Some(folder.clone()), ..Align::sample() }.refused(&room, &[&folder]);
}

#[test]
fn says_that_a_search_without_a_start_is_not_built_yet() {
    let room = room();
    Align { start: None, ..Align::sample() }.refused(&room, &["--start"]);
}

#[test]
fn refuses_cities_and_reconstructions_that_are_none() {
    let room = room();
    let city = |city: String| Align { city, ..Align::sample() };
    city(data("none.obj")).refused(&room, &["cannot read the city", "none.obj"]);
    city(data("city")).refused(&room, &["no faces", "no_faces.obj"]);
    city(data("start")).refused(&room, &["start"]);
    city(data("city/no_faces.obj")).refused(&room, &["no faces", "no_faces.obj"]);
    city(sample("photos/p001.jpg")).refused(&room, &["p001.jpg"]);
    city(data("three_points.ply")).refused(&room, &["three_points.ply"]);
    let sfm = |sfm: String| Align { sfm, ..Align::sample() };
    sfm(data("none")).refused(&room, &["cannot read the reconstruction", "none"]);
    sfm(data("start")).refused(&room, &["cameras", "start"]);
    sfm(data("no_points.ply")).refused(&room, &["point", "no_points.ply"]);
    sfm(data("sfm_empty")).refused(&room, &["point", "sfm_empty"]);
    sfm(sample("start.json")).refused(&room, &["start.json"]);
    sfm(sample("city.obj")).refused(&room, &["same file", "city.obj"]);
    let terrain = |path: &str| Align::with(&["--terrain", path]);
    terrain(&data("none.obj")).refused(&room, &["terrain", "none.obj"]);
    terrain(&sample("city.obj")).refused(&room, &["given again", "city.obj"]);
}

#[test]
fn refuses_labels_and_photos_that_do_not_fit() {
    let room = room();
    std::fs::create_dir(room.path().join("empty")).unwrap();
    let start = room.path().join("start.json");
    std::fs::write(&start, r#"{"scale": 1, "rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [420, 270, 5]}"#)
        .unwrap();
    let start = start.to_str().unwrap().to_owned();
    for option in ["--labels", "--photos"] {
        Align::with(&[option, "empty"]).refused(&room, &["empty", option]);
        Align::with(&[option, "none"]).refused(&room, &["none", option]);
        Align::with(&[option, &sample("city.obj")]).refused(&room, &["city.obj", option]);
        Align::with(&[option, &data("start")]).refused(&room, &["p024", &data("start")]);
        let labels = sample("labels");
        let given = Align::with(&[option, &labels]);
        let cloud = Align { sfm: data("three_points.ply"), start: Some(start.clone()), ..given };
        cloud.refused(&room, &["no images"]);
    }
    Align::with(&["--labels", &data("labels_in_color")]).refused(&room, &["grey", "p001.png"]);
}

#[test]
fn refuses_places_that_it_cannot_or_should_not_write() {
    let room = room();
    std::fs::write(room.path().join("file"), "mine").unwrap();
    std::fs::create_dir(room.path().join("taken")).unwrap();
    let out = |out, more: &[&str]| Align { out, ..Align::with(more) };
    out("taken", &[]).refused(&room, &["taken", "--force"]);
    out("file", &[]).refused(&room, &["file", "--force"]);
    out("none/out", &[]).refused(&room, &["none", "does not exist"]);
    out("file/out", &[]).refused(&room, &["file", "expected a folder"]);
    out("..", &["--force"]).refused(&room, &[".."]);
    out("/", &["--force"]).refused(&room, &["/"]);
    assert_eq!(std::fs::read_to_string(room.path().join("file")).unwrap(), "mine");
}

#[test]
fn never_replaces_what_it_reads() {
    let room = room();
    let inputs = room.path().join("inputs");
    std::fs::create_dir(&inputs).unwrap();
    std::fs::copy(sample("city.obj"), inputs.join("city.obj")).unwrap();
    std::fs::copy(sample("start.json"), inputs.join("start.json")).unwrap();
    let city = "inputs/city.obj".to_owned();
    let align = |out| Align { city: city.clone(), out, ..Align::with(&["--force"]) };
    align("inputs").refused(&room, &["would replace an input", "inputs/city.obj"]);
    align("inputs/city.obj").refused(&room, &["would replace an input"]);
    align("inputs/../inputs").refused(&room, &["would replace an input"]);
    let start =
        Align { start: Some("inputs/start.json".into()), out: "inputs/start.json", ..Align::with(&["--force"]) };
    start.refused(&room, &["would replace an input"]);
    refused(&room, &["planes", &city, "-o", &city, "--force"], &["neither .glb nor .json"]);
    assert_eq!(names(&inputs), ["city.obj", "start.json"]);
}

#[test]
fn refuses_numbers_that_make_no_sense() {
    let room = room();
    for wrong in [
        ["--threads", "0"],
        ["--threads", "-1"],
        ["--seed", "x"],
        ["--seed", "-1"],
        ["--scale", "0"],
        ["--scale", "-3"],
        ["--scale", "NaN"],
        ["--up", "0,0,0"],
        ["--up", "sideways"],
        ["--city-up", "x"],
        ["--city-unit", "inch"],
        ["--city-origin", "1,2"],
        ["--city-origin", "1,2,NaN"],
        ["--lod", "0"],
        ["--lod", "two"],
    ] {
        Align::with(&wrong).refused(&room, &[wrong[0]]);
    }
    refused(&room, &["align"], &["<CITY>"]);
    refused(&room, &["weld"], &["weld"]);
}

#[test]
fn planes_are_counted_and_written() {
    let room = room();
    let city = sample("city.obj");
    let output = cityweld(&room, &["planes", &city]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).starts_with("city.obj: 527 objects"), "{}", stdout(&output));
    for file in ["planes.json", "planes.glb"] {
        assert_eq!(cityweld(&room, &["planes", &city, "-o", file]).status.code(), Some(0));
    }
    let text = std::fs::read_to_string(room.path().join("planes.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(report["planes"].as_array().unwrap().len() > 5000);
    assert_eq!(stdout(&cityweld(&room, &["planes", &city, "--json"])), text);
    assert!(std::fs::read(room.path().join("planes.glb")).unwrap().starts_with(b"glTF"));
    refused(&room, &["planes", &city, "-o", "planes.json"], &["--force"]);
    refused(&room, &["planes", &city, "-o", "planes.txt"], &[".glb", "planes.txt"]);
    refused(&room, &["planes", "none.obj"], &["none.obj"]);
    refused(&room, &["planes", &data("city/no_faces.obj"), "-o", "p.glb"], &["no faces"]);
}

#[test]
fn planes_of_a_cityjson_file_tell_its_levels_and_its_reference_system() {
    let room = room();
    let city = repository("tests/data/formats/city/small.city.jsonl");
    let said = stdout(&cityweld(&room, &["planes", &city]));
    for line in [
        "small.city.jsonl: 3 objects, 33 facets",
        "CityJSON 2.0 Seq: 3 objects, 3 parts, 0 polygons with holes",
        "2.2: 33 polygons (3 ground, 6 roof, 24 wall)",
        "EPSG:7415, NAP height, https://www.opengis.net/def/crs/EPSG/0/7415",
    ] {
        assert!(said.contains(line), "{said}");
    }
    let said =
        stdout(&cityweld(&room, &["planes", &city, "--lod", "1.2", "--city-unit", "cm", "--city-origin", "1,2,3"]));
    assert!(said.contains("3 objects, 22 facets") && said.contains("x           846."), "{said}");
    // Objects without polygons are no city to align with, but there is nothing wrong with the file.
    let bare = cityweld(&room, &["planes", &repository("tests/data/formats/city/geometry_instance.city.json")]);
    assert_eq!(bare.status.code(), Some(0));
    assert!(stderr(&bare).contains("2 points and lines, passed over"), "{}", stderr(&bare));
    let report: serde_json::Value =
        serde_json::from_str(&stdout(&cityweld(&room, &["planes", &city, "--json"]))).unwrap();
    assert_eq!(report["crs"]["epsg"], 7415);
    assert_eq!(report["contents"][0]["polygons"]["1.3"]["wall"], 21);
}

#[test]
fn a_folder_of_tiles_is_a_city_and_options_of_a_city_need_one() {
    let room = room();
    let tiles = repository("tests/data/formats/city");
    std::fs::create_dir(room.path().join("tiles")).unwrap();
    for name in ["small.city.jsonl", "3dbag_b2.city.jsonl"] {
        std::fs::copy(Path::new(&tiles).join(name), room.path().join("tiles").join(name)).unwrap();
    }
    let said = stdout(&cityweld(&room, &["planes", "tiles"]));
    assert!(said.starts_with("tiles: 5 objects, 110 facets"), "{said}");
    refused(&room, &["merge", "a.ply", "b.ply", "--crs", "EPSG:28992", "-o", "out"], &["a.ply"]);
}

#[test]
fn export_writes_an_edited_alignment_in_the_formats_asked_for() {
    let room = room();
    let alignment = room.path().join("edited.json");
    let transform = r#"{"scale": 2, "rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [10,20,30]}"#;
    std::fs::write(&alignment, format!(r#"{{"transform": {transform}}}"#)).unwrap();
    let (city, cloud) = (sample("city.obj"), data("three_points.ply"));
    let args = ["export", &city, &cloud, "--alignment", "edited.json", "-o", "out"];
    let output = cityweld(&room, &args);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(names(&room.path().join("out")), ["points.ply", "scene.glb"]);
    let ply = std::fs::read(room.path().join("out/points.ply")).unwrap();
    let (x, y): (Vec<u8>, Vec<u8>) = (12f64.to_le_bytes().into(), 20f64.to_le_bytes().into());
    assert!(ply.windows(16).any(|w| w[..8] == x && w[8..] == y), "the second point, (1, 0, 0), is not at (12, 20, 30)");

    let sfm = sample("sfm");
    let args = ["export", &city, &sfm, "--alignment", "edited.json", "-o", "again", "--format", "colmap,ply"];
    assert_eq!(cityweld(&room, &args).status.code(), Some(0));
    assert_eq!(names(&room.path().join("again")), ["points.ply", "sfm"]);
    std::fs::remove_dir_all(room.path().join("again")).unwrap();

    let colmap = ["export", &city, &cloud, "--alignment", "edited.json", "-o", "again", "--format", "colmap"];
    refused(&room, &colmap, &["without images", "three_points.ply"]);
    std::fs::write(&alignment, r#"{"transform": null, "best_candidate": null}"#).unwrap();
    refused(&room, &["export", &city, &cloud, "--alignment", "edited.json", "-o", "b"], &["neither", "edited.json"]);
}

#[test]
fn solve_answers_on_standard_output() {
    let room = room();
    refused(&room, &["solve", "none.json"], &["cannot read the problem", "none.json"]);
    std::fs::write(room.path().join("problem.json"), "{").unwrap();
    let output = cityweld(&room, &["solve", "problem.json"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(serde_json::from_str::<serde_json::Value>(&stdout(&output)).is_ok(), "{}", stdout(&output));
}

#[test]
fn says_what_it_is() {
    let room = room();
    let version = cityweld(&room, &["--version"]);
    assert!(
        stdout(&version).starts_with(concat!("cityweld ", env!("CARGO_PKG_VERSION"), " (")),
        "{}",
        stdout(&version)
    );
    for command in ["align", "planes", "export", "demo", "solve"] {
        let help = cityweld(&room, &[command, "--help"]);
        assert_eq!(help.status.code(), Some(0));
        assert!(stdout(&help).contains("Usage: cityweld"), "{command}");
    }
}

#[test]
fn an_option_that_does_not_exist_is_unexpected_and_nothing_else_is_proposed() {
    let room = room();
    for unknown in ["--nearby", "--foo"] {
        let output = cityweld(&room, &[&Align::sample().args()[..], &[unknown, "100,200,50"]].concat());
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(
            message.contains(&format!("unexpected argument '{unknown}'")) && !message.contains("tip:"),
            "{message}"
        );
    }
}

#[test]
fn arguments_in_each_others_place_are_told_with_the_right_line() {
    let room = room();
    let (city, sfm, start) = (sample("city.obj"), sample("sfm"), sample("start.json"));
    let line =
        format!("CITY and SFM are exchanged (the city comes first); give: cityweld align {city} {sfm} --start {start}");
    Align { city: sfm.clone(), sfm: city.clone(), ..Align::sample() }.refused(&room, &[&line]);
    let line = format!("give: cityweld export {city} {sfm} --alignment {start}");
    refused(&room, &["export", &sfm, &city, "--alignment", &start, "-o", "out"], &[&line]);
    refused(&room, &["merge", &sfm, &city, "-o", "out"], &["PART is a city model", "--city"]);
    let line = format!("give: cityweld merge {sfm} {sfm} --city {city} --start {start} --start {start}");
    let args = ["merge", &sfm, &city, "--city", &sfm, "--start", &start, "--start", &start, "-o", "out"];
    refused(&room, &args, &[&line]);
    refused(&room, &["planes", &sfm], &["CITY is a COLMAP model"]);
    Align { city: start.clone(), ..Align::sample() }.refused(&room, &["CITY is a start", "--start"]);
    Align { start: Some(sfm.clone()), ..Align::sample() }.refused(&room, &["--start is a COLMAP model"]);
    let (labels, photos) = (sample("labels"), sample("photos"));
    let line = format!("--labels {labels} --photos {photos}");
    Align::with(&["--labels", &photos, "--photos", &labels]).refused(&room, &["exchanged", &line]);
    refused(&room, &["solve", &start], &["this is a start", "expected a problem"]);
}

#[test]
fn json_is_read_as_windows_saves_it() {
    let room = room();
    let problem = r#"{"kind": "rigid", "points": [], "planes": [], "pairs": []}"#;
    let plain =
        std::fs::write(room.path().join("plain.json"), problem).map(|()| cityweld(&room, &["solve", "plain.json"]));
    let plain = stdout(&plain.unwrap());
    assert!(plain.contains("refused"), "{plain}");
    let little: Vec<u8> = format!("\u{feff}{problem}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [format!("\u{feff}{problem}").into_bytes(), little] {
        std::fs::write(room.path().join("problem.json"), bytes).unwrap();
        assert_eq!(stdout(&cityweld(&room, &["solve", "problem.json"])), plain);
    }
    let start = std::fs::read_to_string(sample("start.json")).unwrap();
    let marked: Vec<u8> = format!("\u{feff}{start}").encode_utf16().flat_map(u16::to_be_bytes).collect();
    std::fs::write(room.path().join("start.json"), marked).unwrap();
    let align = Align { start: Some("start.json".into()), sfm: data("no_points.ply"), ..Align::sample() };
    // The start is read before the reconstruction, so it is this one that is at fault.
    align.refused(&room, &["no_points.ply"]);
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_instead_of_waited_for() {
    let room = room();
    assert!(std::process::Command::new("mkfifo").arg(room.path().join("pipe")).status().unwrap().success());
    let (city, sfm, start) = (sample("city.obj"), sample("sfm"), sample("start.json"));
    for (endless, what) in [("pipe", "a pipe"), ("/dev/zero", "a device")] {
        let says: &[&str] = &[what, endless];
        Align { city: endless.into(), ..Align::sample() }.refused(&room, says);
        Align { sfm: endless.into(), ..Align::sample() }.refused(&room, says);
        Align { start: Some(endless.into()), ..Align::sample() }.refused(&room, says);
        Align::with(&["--terrain", endless]).refused(&room, says);
        refused(&room, &["planes", endless], says);
        refused(&room, &["export", &city, &sfm, "--alignment", endless, "-o", "out"], says);
        refused(&room, &["merge", &sfm, endless, "-o", "out"], says);
        refused(
            &room,
            &["merge", &sfm, &sfm, "--city", endless, "--start", &start, "--start", &start, "-o", "out"],
            says,
        );
        refused(&room, &["solve", endless], says);
    }
}

#[test]
fn an_alignment_is_a_start() {
    let room = room();
    let labels = sample("labels");
    let first = cityweld(&room, &Align::with(&["--labels", &labels]).args());
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    let again = Align { start: Some("out/alignment.json".into()), out: "again", ..Align::with(&["--labels", &labels]) };
    let second = cityweld(&room, &again.args());
    assert_eq!(second.status.code(), Some(0), "{}{}", stdout(&second), stderr(&second));
    let merge = r#"{"schema": "cityweld.merge/1", "parts": []}"#;
    std::fs::write(room.path().join("merge.json"), merge).unwrap();
    let align = Align { start: Some("merge.json".into()), ..Align::with(&["--force"]) };
    align.refused(&room, &["the report of a merge", "merge.json"]);
}

#[test]
fn a_closed_standard_output_is_no_panic() {
    let room = room();
    let city = sample("city.obj");
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("cityweld"))
        .current_dir(room.path())
        .args(["planes", &city, "--json", "--quiet"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
}

#[cfg(unix)]
#[test]
fn an_interruption_leaves_nothing_behind() {
    let room = room();
    let align = Align::with(&["--labels", &sample("labels")]);
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("cityweld"))
        .current_dir(room.path())
        .args(align.args())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The folder under way appears before anything is read.
    let partial = || names(room.path()).into_iter().any(|name| name.contains("partial"));
    while !partial() {
        assert!(child.try_wait().unwrap().is_none(), "the program ended before it could be interrupted");
        std::thread::yield_now();
    }
    let interrupt = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(130), ""));
    assert_eq!(names(room.path()), Vec::<String>::new());
}

#[test]
fn damaged_copies_of_the_sample_are_refused_with_their_name() {
    let copy = |room: &TempDir| -> PathBuf {
        let folder = room.path().join("sfm");
        std::fs::create_dir(&folder).unwrap();
        for name in names(Path::new(&sample("sfm"))) {
            std::fs::copy(sample(&format!("sfm/{name}")), folder.join(name)).unwrap();
        }
        folder
    };
    for (file, find, replace) in [
        ("points3D.txt", "\n1 ", "\n1 nan "),
        ("images.txt", " 1 p024.jpg", " 9 p024.jpg"),
        ("cameras.txt", "SIMPLE_RADIAL", "SIMPLE_RADISH"),
    ] {
        let room = room();
        let path = copy(&room).join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(find));
        std::fs::write(&path, text.replacen(find, replace, 1)).unwrap();
        Align { sfm: "sfm".into(), ..Align::sample() }.refused(&room, &[file]);
    }
}

#[test]
fn align_turns_freely_where_up_is_not_used_and_names_its_solver() {
    let room = room();
    for (more, solver) in
        [(&["--up", "none"][..], "similarity (3,2,1,1)"), (&["--up", "auto"][..], "upright similarity (2,1,1,1)")]
    {
        let output = cityweld(&room, &[&Align::with(more).args()[..], &["--force"]].concat());
        assert_eq!(output.status.code(), Some(0), "{more:?}: {}{}", stdout(&output), stderr(&output));
        let report = std::fs::read_to_string(room.path().join("out/alignment.json")).unwrap();
        assert!(report.contains(&format!("\"solver\": \"{solver}\"")), "{more:?}: {report}");
    }
}

#[test]
fn superpixels_of_parts_that_share_no_photograph_are_not_missed() {
    let room = tempfile::tempdir().unwrap();
    let [sample, labels] = ["sfm", "labels"].map(|name| repository(&format!("assets/sample/{name}")));
    let other = repository("tests/data/reconstruction/rig_bin");
    let output = cityweld(&room, &["merge", &sample, &other, "--labels", &labels, "-o", "out"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(!stderr(&output).contains("no plane joins them"), "{}", stderr(&output));
}
