//! Joining with what is around: `cityweld merge --city`, where parts that share no photograph meet in the city, and label images that
//! are not there. On pieces of the sample.

mod pieces;

use std::path::Path;
use std::process::Command;

use cityweld::{MergeOptions, MergePart, MergeVerdict, Rotation3, Similarity, SuperpixelSource, Vector3, read_start};
use pieces::{blurred, of_sample, piece, sample, share_off, similarity, write_part};
use serde_json::{Value, json};

/// 3 cm on the walls of the sample, which has 6.5 m to its unit.
const NOISE: f64 = 0.03 / 6.5;

/// As a share of the extent, what two parts may be off each other that the city alone holds; 0.00015 was measured.
const REACH: f64 = 1e-3;

fn write_start(path: &Path, city_from_sfm: &Similarity) {
    let rows: Vec<Vec<f64>> = city_from_sfm.rotation.matrix().row_iter().map(|r| r.iter().copied().collect()).collect();
    let start =
        json!({"scale": city_from_sfm.scale, "rotation": rows, "translation": city_from_sfm.translation.as_slice()});
    std::fs::write(path, start.to_string()).unwrap();
}

#[test]
fn parts_that_share_no_photograph_meet_in_the_city() {
    let room = tempfile::tempdir().unwrap();
    let whole = sample();
    let b_from_whole = Similarity {
        scale: 0.4,
        rotation: Rotation3::from_euler_angles(1.0, -0.5, 2.0),
        translation: Vector3::new(9.0, -4.0, 2.0),
    };
    let a = blurred(piece(&whole, 0..12, &Similarity::identity()), NOISE, 1);
    let b = blurred(piece(&whole, 12..24, &b_from_whole), NOISE * b_from_whole.scale, 2);
    let [folder_a, folder_b] = [("a", &a), ("b", &b)].map(|(name, part)| write_part(room.path(), name, part));
    let start = *read_start(&of_sample("start.json")).unwrap().city_from_sfm();
    let start_b = room.path().join("start_b.json");
    write_start(&start_b, &(start * b_from_whole.inverse()));

    let out = room.path().join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
    command.arg("merge").args([&folder_a, &folder_b]).arg("--city").arg(of_sample("city.obj"));
    command.arg("--start").arg(of_sample("start.json")).arg("--start").arg(&start_b);
    let ended = command.arg("--labels").arg(of_sample("labels")).arg("-o").arg(&out).arg("--quiet").output().unwrap();
    assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stdout));
    let report: Value = serde_json::from_slice(&std::fs::read(out.join("merge.json")).unwrap()).unwrap();
    assert_eq!((&report["verdict"], &report["frame"]), (&Value::from("merged"), &Value::from("the city's")));
    assert_eq!(report["ledger"]["images"]["kept"], 24);
    assert_eq!(report["edges"][0]["source"], "city");

    let [city_from_a, city_from_b] = [0, 1].map(|part| similarity(&report["parts"][part]["transform"]));
    let off = share_off([&a.points, &b.points], &(city_from_a.inverse() * city_from_b), &b_from_whole.inverse());
    println!("{off} of the extent off");
    assert!(off < REACH, "{off}");
}

#[test]
fn that_no_label_image_is_that_of_a_shared_photograph_is_told() {
    let (whole, nothing) = (sample(), tempfile::tempdir().unwrap());
    let part = |name: &str, images| {
        let sfm = piece(&whole, images, &Similarity::identity());
        MergePart { name: name.to_owned(), sfm, start: None }
    };
    let labels = SuperpixelSource::Labels(nothing.path().to_owned());
    let options = MergeOptions { superpixels: Some(labels), ..MergeOptions::default() };
    let merged = cityweld::merge(vec![part("a", 0..13), part("b", 12..24)], None, &options, &()).unwrap();
    assert_eq!(merged.verdict, MergeVerdict::Merged, "{}", merged.reason);
    assert!(matches!(&merged.warnings[..], [told] if told.contains("no file there")), "{:?}", merged.warnings);
}
