//! What the program refuses: exit status 2, one message that names the place, nothing written.

mod program;

use std::path::{Path, PathBuf};

use program::{Align, cityweld, data, names, refused, room, sample, stderr};
use tempfile::TempDir;

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
fn an_option_that_does_not_exist_is_unexpected_and_nothing_else_is_proposed() {
    let room = room();
    for unknown in ["--frobnicate", "--foo"] {
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
