//! The built program from outside: exit statuses, what is written and what is not, what is said.

mod program;

use std::path::Path;
use std::process::Stdio;

use program::{Align, cityweld, data, names, refused, repository, room, sample, stderr, stdout};

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
