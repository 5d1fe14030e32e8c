//! `cityweld merge` with superpixels, on real parts: planes alone and beside the other evidence. Needs `../shared/data/merge`.

use std::path::{Path, PathBuf};
use std::process::Command;

use cityweld::geometry::{Matrix3, Similarity, Vector3};
use cityweld::reconstruction::read_reconstruction;
use serde_json::Value;

/// A scene of the data, `None` (and said so) where the data are not there.
fn shared(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/merge").join(name);
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn similarity(t: &Value) -> Similarity {
    let number = |v: &Value| v.as_f64().unwrap();
    let rotation = Matrix3::from_fn(|row, column| number(&t["rotation"][row][column]));
    let translation = Vector3::from_fn(|k, _| number(&t["translation"][k]));
    Similarity::try_new(number(&t["scale"]), rotation, translation).unwrap()
}

/// Exit status and report of parts a and b of a scene.
fn merged(scene: &Path, options: &[&str]) -> (Option<i32>, Value) {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
    command.arg("merge").arg(scene.join("part_a")).arg(scene.join("part_b")).arg("-o").arg(&out).arg("--quiet");
    let labels = scene.join("labels");
    let photos = scene.join("photos");
    for option in options {
        match *option {
            "--labels" => command.arg("--labels").arg(&labels),
            "--photos" => command.arg("--photos").arg(&photos),
            other => command.arg(other),
        };
    }
    let status = command.output().unwrap().status.code();
    let report = out.join("merge.json");
    (status, if report.is_file() { json(&report) } else { Value::Null })
}

/// Root mean square error of part b's points in part a's frame, a share of the extent of part a.
fn error(scene: &Path, report: &Value) -> f64 {
    let truth = json(&scene.join("truth.json"));
    let [joint_from_a, joint_from_b] = ["part_a", "part_b"].map(|part| similarity(&truth["parts"][part]));
    let [merged_from_a, merged_from_b] = [0, 1].map(|part| similarity(&report["parts"][part]["transform"]));
    let true_a_from_b = joint_from_a.inverse() * joint_from_b;
    let a_from_b = merged_from_a.inverse() * merged_from_b;
    let points = |part: &str| read_reconstruction(&scene.join(part)).unwrap().points;
    let (of_a, of_b) = (points("part_a"), points("part_b"));
    let mut from_center: Vec<f64> = {
        let center = of_a.iter().map(|p| p.coords).sum::<Vector3<f64>>() / of_a.len() as f64;
        of_a.iter().map(|p| (p.coords - center).norm()).collect()
    };
    from_center.sort_by(f64::total_cmp);
    let radius = from_center[from_center.len() * 98 / 100];
    let mut off: Vec<f64> = of_b.iter().map(|p| (a_from_b.apply(p) - true_a_from_b.apply(p)).norm()).collect();
    off.sort_by(f64::total_cmp);
    // Sky and far mismatches are left out.
    off.truncate(off.len() * 98 / 100);
    (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt() / (2.0 * radius)
}

/// 0.3 % of the extent, the reach of these scenes.
const REACH: f64 = 0.003;

#[test]
fn planes_alone_join_real_parts_with_labels_and_with_photographs() {
    for scene in ["fountain-one", "boruszyn-one"] {
        let Some(scene) = shared(scene) else { return };
        for source in ["--labels", "--photos"] {
            let (status, report) = merged(&scene, &["--evidence", "planes", source]);
            assert_eq!(status, Some(0), "{}", report["reason"]);
            assert_eq!(report["edges"][0]["source"], "superpixels");
            let error = error(&scene, &report);
            assert!(error < REACH, "{source}: {error}");
        }
    }
}

#[test]
fn all_evidence_joins_real_parts() {
    let Some(scene) = shared("fountain-one") else { return };
    let (status, report) = merged(&scene, &["--labels"]);
    assert_eq!(status, Some(0), "{}", report["reason"]);
    assert!(error(&scene, &report) < REACH);
}

#[test]
fn planes_alone_refuse_another_place_and_a_mirrored_one() {
    for scene in ["collide", "mirror"] {
        let Some(scene) = shared(scene) else { return };
        for source in ["--labels", "--photos"] {
            let (status, report) = merged(&scene, &["--evidence", "planes", source]);
            assert_eq!(status, Some(1), "{report:#}");
            assert!(report["parts"].as_array().unwrap().iter().all(|p| p["placed"] == false), "{report:#}");
        }
    }
}

#[test]
fn planes_without_superpixels_are_an_error_that_says_what_to_give() {
    let Some(scene) = shared("fountain-one") else { return };
    let (status, report) = merged(&scene, &["--evidence", "planes"]);
    assert_eq!((status, report), (Some(2), Value::Null));
}
