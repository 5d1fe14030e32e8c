//! Joining with what is around: `cityweld merge --city`, where parts that share no photograph meet in the city, and label images that
//! are not there. On pieces of the sample.

mod pieces;

use std::path::Path;
use std::process::Command;

use cityweld::{
    MergeOptions, MergePart, MergeVerdict, Place, Reconstruction, Rotation3, Similarity, SuperpixelSource, Vector3,
    read_start,
};
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

/// Two parts of the sample that share no photograph, each in a frame of its own, and how they were merged in its city.
struct Parts {
    room: tempfile::TempDir,
    a: Reconstruction,
    b: Reconstruction,
    b_from_whole: Similarity,
    city_from_whole: Similarity,
}

impl Parts {
    fn new() -> Parts {
        let whole = sample();
        let b_from_whole = Similarity {
            scale: 0.4,
            rotation: Rotation3::from_euler_angles(1.0, -0.5, 2.0),
            translation: Vector3::new(9.0, -4.0, 2.0),
        };
        let a = blurred(piece(&whole, 0..12, &Similarity::identity()), NOISE, 1);
        let b = blurred(piece(&whole, 12..24, &b_from_whole), NOISE * b_from_whole.scale, 2);
        let city_from_whole = *read_start(&of_sample("start.json")).unwrap().city_from_sfm();
        let room = tempfile::tempdir().unwrap();
        for (name, part) in [("a", &a), ("b", &b)] {
            write_part(room.path(), name, part);
        }
        Parts { room, a, b, b_from_whole, city_from_whole }
    }

    fn merged(&self, places: &[&Path]) -> (Option<i32>, Value) {
        let out = self.room.path().join("out");
        let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
        command.arg("merge").args([self.room.path().join("a"), self.room.path().join("b")]);
        command.arg("--city").arg(of_sample("city.obj")).args(places);
        let ended =
            command.arg("--labels").arg(of_sample("labels")).arg("-o").arg(&out).arg("--quiet").output().unwrap();
        let report = std::fs::read(out.join("merge.json"));
        let report = report.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&ended.stderr)));
        (ended.status.code(), serde_json::from_slice(&report).unwrap())
    }

    /// Both stand in the city, and where they do in the whole.
    fn stand_in_the_city(&self, (status, report): (Option<i32>, Value)) {
        assert_eq!(status, Some(0), "{report:#}");
        assert_eq!((&report["verdict"], &report["frame"]), (&Value::from("merged"), &Value::from("the city's")));
        assert_eq!(report["ledger"]["images"]["kept"], 24);
        assert_eq!(report["edges"][0]["source"], "city");
        let [city_from_a, city_from_b] = [0, 1].map(|part| similarity(&report["parts"][part]["transform"]));
        let a_from_b = city_from_a.inverse() * city_from_b;
        let off = share_off([&self.a.points, &self.b.points], &a_from_b, &self.b_from_whole.inverse());
        println!("{off} of the extent off");
        assert!(off < REACH, "{off}");
    }
}

#[test]
fn parts_that_share_no_photograph_meet_in_the_city() {
    let parts = Parts::new();
    let start_b = parts.room.path().join("start_b.json");
    write_start(&start_b, &(parts.city_from_whole * parts.b_from_whole.inverse()));
    let places = ["--start".as_ref(), &*of_sample("start.json"), "--start".as_ref(), &*start_b];
    parts.stand_in_the_city(parts.merged(&places));
}

#[test]
fn parts_of_which_nothing_is_known_are_searched_in_the_city() {
    let parts = Parts::new();
    parts.stand_in_the_city(parts.merged(&[]));
}

#[test]
fn positions_of_all_photographs_start_every_part() {
    let parts = Parts::new();
    let lines = sample()
        .images
        .iter()
        .map(|image| {
            let place = parts.city_from_whole.apply(&image.center());
            format!("{} {} {} {}\n", image.name, place.x, place.y, place.z)
        })
        .collect::<String>();
    let positions = parts.room.path().join("positions.txt");
    std::fs::write(&positions, lines).unwrap();
    parts.stand_in_the_city(parts.merged(&["--positions".as_ref(), &*positions]));
}

#[test]
fn a_part_that_the_city_does_not_hold_has_no_anchor_and_the_reason_is_told() {
    let parts = Parts::new();
    // A cloud of nothing but the points of another shape: a bowl.
    let bowl = |at: usize| {
        let (s, c) = (at as f64 * 2.399_963).sin_cos();
        let r = (at as f64 / 2000.0).sqrt();
        format!("{} {} {}\n", r * c, r * s, r * r)
    };
    let mut ply = "ply\nformat ascii 1.0\nelement vertex 2000\nproperty float x\nproperty float y\nproperty float z\nend_header\n".to_owned();
    ply.extend((0..2000).map(bowl));
    std::fs::remove_dir_all(parts.room.path().join("b")).unwrap();
    std::fs::write(parts.room.path().join("b"), ply).unwrap();
    let (status, report) = parts.merged(&[]);
    assert_eq!(status, Some(1), "{report:#}");
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("b: in the city failed") && report["parts"][1]["placed"] == false, "{report:#}");
}

#[test]
fn that_no_label_image_is_that_of_a_shared_photograph_is_told() {
    let (whole, nothing) = (sample(), tempfile::tempdir().unwrap());
    let part = |name: &str, images| {
        let sfm = piece(&whole, images, &Similarity::identity());
        MergePart { name: name.to_owned(), sfm, place: Place::default() }
    };
    let labels = SuperpixelSource::Labels(nothing.path().to_owned());
    let options = MergeOptions { superpixels: Some(labels), ..MergeOptions::default() };
    let merged = cityweld::merge(vec![part("a", 0..13), part("b", 12..24)], None, &options, &()).unwrap();
    assert_eq!(merged.verdict, MergeVerdict::Merged, "{}", merged.reason);
    assert!(matches!(&merged.warnings[..], [told] if told.contains("no file there")), "{:?}", merged.warnings);
}
