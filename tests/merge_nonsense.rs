//! `cityweld merge` over what must not be joined: real parts of places that have nothing to do with each other, of mirrored
//! photographs, with names that collide, stretched along one axis. Needs `../shared/data/merge`.

use std::path::{Path, PathBuf};
use std::process::Command;

use cityweld::export::colmap::write_colmap;
use cityweld::reconstruction::{Reconstruction, read_reconstruction};
use serde_json::Value;

const SEEDS: std::ops::Range<u64> = 0..3;
const STRETCH: f64 = 1.3;

/// A folder of the data, `None` (and said so) where the data are not there.
fn shared(path: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/merge").join(path);
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

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

/// Nothing is placed, and the reason says why.
fn assert_refused(parts: &[&Path], why: &str) {
    for (status, report) in merged(parts) {
        assert_eq!(status, Some(1), "{report:#}");
        assert!(report["parts"].as_array().unwrap().iter().all(|p| p["placed"] == false), "{report:#}");
        assert!(report["reason"].as_str().unwrap().contains(why), "{}", report["reason"]);
    }
}

fn with_changed(part: &Path, change: impl Fn(&mut Reconstruction)) -> tempfile::TempDir {
    let mut sfm = read_reconstruction(part).unwrap();
    change(&mut sfm);
    let room = tempfile::tempdir().unwrap();
    write_colmap(room.path(), &sfm).unwrap();
    room
}

#[test]
fn two_places_with_one_name_in_common_stay_apart() {
    let Some(scene) = shared("collide") else { return };
    assert_refused(&[&scene.join("part_a"), &scene.join("part_b")], "different photographs with the same name");
}

#[test]
fn a_name_that_collides_with_another_place_joins_nothing() {
    let (Some(one), Some(other)) = (shared("fountain-one/part_a"), shared("boruszyn-one/part_b")) else { return };
    let name = read_reconstruction(&one).unwrap().images[2].name.clone();
    let renamed = with_changed(&other, |sfm| sfm.images[3].name.clone_from(&name));
    assert_refused(&[&one, renamed.path()], "different photographs with the same name");
}

#[test]
fn parts_of_two_places_share_nothing() {
    let (Some(one), Some(other)) = (shared("fountain-one/part_a"), shared("boruszyn-one/part_b")) else { return };
    assert_refused(&[&one, &other], "shares no photograph");
}

#[test]
fn a_mirrored_part_stays_apart() {
    let Some(scene) = shared("mirror") else { return };
    assert_refused(&[&scene.join("part_a"), &scene.join("part_b")], "different keypoints");
}

#[test]
fn a_part_that_is_stretched_along_one_axis_stays_apart() {
    let Some(scene) = shared("fountain-one") else { return };
    let stretched = with_changed(&scene.join("part_b"), |sfm| {
        sfm.points.iter_mut().for_each(|p| p.x *= STRETCH);
        for image in &mut sfm.images {
            let mut center = image.center();
            center.x *= STRETCH;
            image.cam_from_sfm_translation = -(image.cam_from_sfm_rotation * center.coords);
        }
        // Frames would hold the old places of the cameras.
        if let Some(colmap) = &mut sfm.colmap {
            (colmap.rigs, colmap.frames) = (None, None);
        }
    });
    assert_refused(&[&scene.join("part_a"), stretched.path()], "contradicts itself");
}

#[test]
fn a_stranger_is_left_out_and_the_others_are_joined() {
    let Some(scene) = shared("stranger") else { return };
    let parts = ["part_a", "part_b", "part_c"].map(|name| scene.join(name));
    for (status, report) in merged(&[&parts[0], &parts[1], &parts[2]]) {
        assert_eq!((status, &report["verdict"]), (Some(1), &Value::from("partial")));
        let placed: Vec<bool> =
            report["parts"].as_array().unwrap().iter().map(|p| p["placed"].as_bool().unwrap()).collect();
        assert_eq!(placed, [true, true, false]);
    }
}

#[test]
fn a_part_given_again_in_another_frame_is_the_identity() {
    let Some(scene) = shared("identity") else { return };
    for (status, report) in merged(&[&scene.join("part_a"), &scene.join("part_b")]) {
        assert_eq!(status, Some(0), "{}", report["reason"]);
        assert_eq!(report["ledger"]["images"]["fused"], report["ledger"]["images"]["kept"]);
        // Detectors give one spot a keypoint for each of its orientations; where both parts have all of them, none is lost.
        let observations = &report["ledger"]["observations"];
        let lost: u64 = observations["dropped"].as_object().unwrap().values().map(|v| v.as_u64().unwrap()).sum();
        assert!(200 * lost < observations["in"].as_u64().unwrap(), "{observations}");
    }
}
