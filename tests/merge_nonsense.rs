//! `cityweld merge` over what must not be joined: parts of places that have nothing to do with each other, of mirrored
//! photographs, with names that collide, stretched along one axis. Once on the real parts of `../shared/data/merge`, and
//! once on pieces of the sample and made-up places.

mod needs;
mod pieces;

use std::path::{Path, PathBuf};
use std::process::Command;

use cityweld::{Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction};
use needs::shared;
use pieces::{another_place, mirrored, piece, sample, stretched, write_part};
use serde_json::Value;
use tempfile::TempDir;

const SEEDS: std::ops::Range<u64> = 0..3;
const STRETCH: f64 = 1.3;

/// The exit status and the report, of every seed.
fn merged(parts: &[&Path]) -> Vec<(Option<i32>, Value)> {
    let one = |seed: u64| {
        let room = tempfile::tempdir().unwrap();
        let out = room.path().join("out");
        let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
        command.arg("merge").args(parts).arg("-o").arg(&out).args(["--quiet", "--seed", &seed.to_string()]);
        let status = command.output().unwrap().status.code();
        (status, serde_json::from_slice(&std::fs::read(out.join("merge.json")).unwrap()).unwrap())
    };
    SEEDS.map(one).collect()
}

/// Parts as a test makes them, in files.
struct Made {
    folders: Vec<PathBuf>,
    _room: TempDir,
}

impl Made {
    fn new(parts: &[&Reconstruction]) -> Made {
        let room = tempfile::tempdir().unwrap();
        let write = |(k, part): (usize, &&Reconstruction)| write_part(room.path(), &format!("part_{k}"), part);
        Made { folders: parts.iter().enumerate().map(write).collect(), _room: room }
    }

    fn paths(&self) -> Vec<&Path> {
        self.folders.iter().map(PathBuf::as_path).collect()
    }
}

/// Two pieces of the sample that share one photograph, the second in a frame of its own.
fn pieces_of_sample() -> [Reconstruction; 2] {
    let b_from_a = Similarity {
        scale: 3.0,
        rotation: Rotation3::from_euler_angles(-0.5, 0.2, 2.5),
        translation: Vector3::new(-7.0, 1.0, 12.0),
    };
    let whole = sample();
    [piece(&whole, 0..11, &Similarity::identity()), piece(&whole, 10..24, &b_from_a)]
}

/// Nothing is placed, and the reason says why.
fn assert_refused(parts: &[&Path], why: &str) {
    for (status, report) in merged(parts) {
        assert_eq!(status, Some(1), "{report:#}");
        assert!(report["parts"].as_array().unwrap().iter().all(|p| p["placed"] == false), "{report:#}");
        assert!(report["reason"].as_str().unwrap().contains(why), "{}", report["reason"]);
    }
}

#[test]
fn two_places_with_one_name_in_common_stay_apart() {
    let Some(scene) = shared("data/merge/collide") else { return };
    assert_refused(&[&scene.join("part_a"), &scene.join("part_b")], "different photographs with the same name");
}

#[test]
fn a_made_up_place_with_a_name_of_the_sample_stays_apart() {
    let [one, _] = pieces_of_sample();
    let other = another_place(&[&one.images[3].name]);
    assert_refused(&Made::new(&[&one, &other]).paths(), "different photographs with the same name");
}

#[test]
fn a_name_that_collides_with_another_place_joins_nothing() {
    let Some(one) = shared("data/merge/fountain-one/part_a") else { return };
    let Some(other) = shared("data/merge/boruszyn-one/part_b") else { return };
    let (one, mut other) = (read_reconstruction(&one).unwrap(), read_reconstruction(&other).unwrap());
    other.images[3].name.clone_from(&one.images[2].name);
    assert_refused(&Made::new(&[&one, &other]).paths(), "different photographs with the same name");
}

#[test]
fn names_that_collide_within_one_place_join_nothing() {
    // Both parts show the block of the sample, but not in the photograph of one name.
    let whole = sample();
    let one = piece(&whole, 0..10, &Similarity::identity());
    let mut other = piece(&whole, 12..24, &Similarity::identity());
    other.images[6].name.clone_from(&one.images[2].name);
    assert_refused(&Made::new(&[&one, &other]).paths(), "different photographs with the same name");
}

#[test]
fn parts_of_two_places_share_nothing() {
    let Some(one) = shared("data/merge/fountain-one/part_a") else { return };
    let Some(other) = shared("data/merge/boruszyn-one/part_b") else { return };
    assert_refused(&[&one, &other], "shares no photograph");
}

#[test]
fn the_sample_and_a_made_up_place_share_nothing() {
    let [one, _] = pieces_of_sample();
    assert_refused(&Made::new(&[&one, &another_place(&[])]).paths(), "shares no photograph");
}

#[test]
fn a_mirrored_part_stays_apart() {
    let Some(scene) = shared("data/merge/mirror") else { return };
    assert_refused(&[&scene.join("part_a"), &scene.join("part_b")], "different keypoints");
}

#[test]
fn a_mirrored_piece_of_the_sample_stays_apart() {
    let [one, other] = pieces_of_sample();
    assert_refused(&Made::new(&[&one, &mirrored(other)]).paths(), "different keypoints");
}

#[test]
fn a_part_that_is_stretched_along_one_axis_stays_apart() {
    let Some(scene) = shared("data/merge/fountain-one") else { return };
    let [one, other] = ["part_a", "part_b"].map(|part| read_reconstruction(&scene.join(part)).unwrap());
    assert_refused(&Made::new(&[&one, &stretched(other, STRETCH)]).paths(), "contradicts itself");
}

#[test]
fn a_stretched_piece_of_the_sample_stays_apart() {
    let [one, other] = pieces_of_sample();
    assert_refused(&Made::new(&[&one, &stretched(other, STRETCH)]).paths(), "contradicts itself");
}

fn assert_third_is_left_out(parts: &[&Path]) {
    for (status, report) in merged(parts) {
        assert_eq!((status, &report["verdict"]), (Some(1), &Value::from("partial")));
        let placed: Vec<bool> =
            report["parts"].as_array().unwrap().iter().map(|p| p["placed"].as_bool().unwrap()).collect();
        assert_eq!(placed, [true, true, false]);
    }
}

#[test]
fn a_stranger_is_left_out_and_the_others_are_joined() {
    let Some(scene) = shared("data/merge/stranger") else { return };
    let parts = ["part_a", "part_b", "part_c"].map(|name| scene.join(name));
    assert_third_is_left_out(&[&parts[0], &parts[1], &parts[2]]);
}

#[test]
fn a_made_up_stranger_is_left_out_and_the_pieces_of_the_sample_are_joined() {
    let [one, other] = pieces_of_sample();
    assert_third_is_left_out(&Made::new(&[&one, &other, &another_place(&[])]).paths());
}

fn assert_identity(parts: &[&Path]) {
    for (status, report) in merged(parts) {
        assert_eq!(status, Some(0), "{}", report["reason"]);
        assert_eq!(report["ledger"]["images"]["fused"], report["ledger"]["images"]["kept"]);
        // Detectors give one spot a keypoint for each of its orientations; where both parts have all of them, none is lost.
        let observations = &report["ledger"]["observations"];
        let lost: u64 = observations["dropped"].as_object().unwrap().values().map(|v| v.as_u64().unwrap()).sum();
        assert!(200 * lost < observations["in"].as_u64().unwrap(), "{observations}");
    }
}

#[test]
fn a_part_given_again_in_another_frame_is_the_identity() {
    let Some(scene) = shared("data/merge/identity") else { return };
    assert_identity(&[&scene.join("part_a"), &scene.join("part_b")]);
}

#[test]
fn the_sample_given_again_in_another_frame_is_the_identity() {
    let elsewhere = Similarity {
        scale: 0.3,
        rotation: Rotation3::from_euler_angles(2.0, 0.1, -1.0),
        translation: Vector3::new(20.0, -9.0, 3.0),
    };
    assert_identity(&Made::new(&[&sample(), &sample().transformed(&elsewhere)]).paths());
}
