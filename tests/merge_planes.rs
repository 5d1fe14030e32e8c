//! `cityweld merge` with superpixels: planes alone and beside the other evidence, on pieces of the sample and on the real parts
//! of `../shared/data/merge`.

mod needs;
mod pieces;

use std::path::{Path, PathBuf};
use std::process::Command;

use cityweld::{Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction};
use needs::shared;
use pieces::{another_place, blurred, mirrored, of_sample, piece, sample, share_off, similarity, write_part};
use serde_json::Value;
use tempfile::TempDir;

/// Two parts, and what is known of their shared photographs.
struct Scene {
    parts: [PathBuf; 2],
    labels: PathBuf,
    photos: PathBuf,
    /// `None` where there is none.
    a_from_b: Option<Similarity>,
    _room: Option<TempDir>,
}

fn real(name: &str) -> Option<Scene> {
    let scene = shared(&format!("data/merge/{name}"))?;
    let parts = ["part_a", "part_b"].map(|part| scene.join(part));
    let truth = &json(&scene.join("truth.json"))["parts"];
    let joint_from = |part: &str| truth.get(part).filter(|t| !t.is_null()).map(similarity);
    let a_from_b = joint_from("part_a").zip(joint_from("part_b")).map(|(a, b)| a.inverse() * b);
    Some(Scene { parts, labels: scene.join("labels"), photos: scene.join("photos"), a_from_b, _room: None })
}

/// The photograph that the pieces of the sample share; it is one of the four that are in the sample.
const SHARED_PHOTO: &str = "p013.jpg";
/// 3 cm on the walls of the sample, which has 6.5 m to its unit.
const NOISE: f64 = 0.03 / 6.5;

fn made(parts: [Reconstruction; 2], a_from_b: Option<Similarity>) -> Scene {
    let room = tempfile::tempdir().unwrap();
    let [a, b] = parts;
    let parts = [("part_a", a), ("part_b", b)].map(|(name, part)| write_part(room.path(), name, &part));
    Scene { parts, labels: of_sample("labels"), photos: of_sample("photos"), a_from_b, _room: Some(room) }
}

/// Pieces of the sample up to its shared photograph and from there on, with noise of their own, in frames of their own.
fn pieces_of_sample() -> ([Reconstruction; 2], Similarity) {
    let whole = sample();
    let middle = whole.images.iter().position(|image| image.name == SHARED_PHOTO).unwrap();
    let b_from_a = Similarity {
        scale: 0.4,
        rotation: Rotation3::from_euler_angles(1.0, -0.5, 2.0),
        translation: Vector3::new(9.0, -4.0, 2.0),
    };
    let a = blurred(piece(&whole, 0..middle + 1, &Similarity::identity()), NOISE, 1);
    let b = blurred(piece(&whole, middle..whole.images.len(), &b_from_a), NOISE * b_from_a.scale, 2);
    ([a, b], b_from_a.inverse())
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Exit status and report.
fn merged(scene: &Scene, options: &[&str]) -> (Option<i32>, Value) {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
    command.arg("merge").args(&scene.parts).arg("-o").arg(&out).arg("--quiet");
    for option in options {
        command.arg(option);
        match *option {
            "--labels" => command.arg(&scene.labels),
            "--photos" => command.arg(&scene.photos),
            _ => &mut command,
        };
    }
    let status = command.output().unwrap().status.code();
    let report = out.join("merge.json");
    (status, if report.is_file() { json(&report) } else { Value::Null })
}

/// Root mean square error of part b in part a's frame, a share of the extent of part a.
fn error(scene: &Scene, report: &Value) -> f64 {
    let [merged_from_a, merged_from_b] = [0, 1].map(|part| similarity(&report["parts"][part]["transform"]));
    let [of_a, of_b] = [0, 1].map(|part| read_reconstruction(&scene.parts[part]).unwrap().points);
    let off = share_off([&of_a, &of_b], &(merged_from_a.inverse() * merged_from_b), &scene.a_from_b.unwrap());
    println!("{}: {off} of the extent off", scene.parts[0].display());
    off
}

/// 0.3 % of the extent, the reach of these scenes.
const REACH: f64 = 0.003;

fn assert_planes_alone_join(scene: &Scene) {
    for source in ["--labels", "--photos"] {
        let (status, report) = merged(scene, &["--evidence", "planes", source]);
        assert_eq!(status, Some(0), "{source}: {}", report["reason"]);
        assert_eq!(report["edges"][0]["source"], "superpixels");
        let error = error(scene, &report);
        assert!(error < REACH, "{source}: {error}");
    }
}

#[test]
fn planes_alone_join_pieces_of_the_sample_with_labels_and_with_photographs() {
    let (parts, a_from_b) = pieces_of_sample();
    assert_planes_alone_join(&made(parts, Some(a_from_b)));
}

#[test]
fn planes_alone_join_real_parts_with_labels_and_with_photographs() {
    for scene in ["fountain-one", "boruszyn-one"] {
        let Some(scene) = real(scene) else { return };
        assert_planes_alone_join(&scene);
    }
}

/// Over one shared photograph, with its superpixels and without.
fn assert_all_evidence_joins(scene: &Scene) {
    for options in [&["--labels"][..], &[]] {
        let (status, report) = merged(scene, options);
        assert_eq!(status, Some(0), "{}", report["reason"]);
        let error = error(scene, &report);
        assert!(error < REACH, "{options:?}: {error}");
    }
}

#[test]
fn all_evidence_joins_pieces_of_the_sample() {
    let (parts, a_from_b) = pieces_of_sample();
    assert_all_evidence_joins(&made(parts, Some(a_from_b)));
}

#[test]
fn all_evidence_joins_real_parts() {
    let Some(scene) = real("fountain-one") else { return };
    assert_all_evidence_joins(&scene);
}

fn assert_planes_alone_refuse(scene: &Scene) {
    for source in ["--labels", "--photos"] {
        let (status, report) = merged(scene, &["--evidence", "planes", source]);
        assert_eq!(status, Some(1), "{report:#}");
        assert!(report["parts"].as_array().unwrap().iter().all(|p| p["placed"] == false), "{report:#}");
    }
}

#[test]
fn planes_alone_refuse_a_made_up_place_under_the_samples_name() {
    let ([a, _], _) = pieces_of_sample();
    assert_planes_alone_refuse(&made([a, another_place(&[SHARED_PHOTO])], None));
}

#[test]
fn planes_alone_refuse_a_mirrored_piece_of_the_sample() {
    let ([a, b], _) = pieces_of_sample();
    assert_planes_alone_refuse(&made([a, mirrored(b)], None));
}

#[test]
fn planes_alone_refuse_another_place_and_a_mirrored_one() {
    for scene in ["collide", "mirror"] {
        let Some(scene) = real(scene) else { return };
        assert_planes_alone_refuse(&scene);
    }
}

#[test]
fn planes_without_superpixels_are_an_error_that_says_what_to_give() {
    let (parts, a_from_b) = pieces_of_sample();
    let (status, report) = merged(&made(parts, Some(a_from_b)), &["--evidence", "planes"]);
    assert_eq!((status, report), (Some(2), Value::Null));
}
