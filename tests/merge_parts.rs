//! `cityweld merge` over several parts: neither the order of the arguments, nor the number of threads, nor the names of folders
//! change anything but the frame. On pieces of the sample, and on the chain of `../shared/data/merge` where it is there.

mod needs;
mod pieces;

use std::path::{Path, PathBuf};
use std::process::Command;

use cityweld::{Point3, Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction};
use needs::shared;
use pieces::{blurred, piece, sample, share_off, similarity, write_part};
use serde_json::Value;

/// Rounding alone, as a share of the scene: sums are taken in another order.
const ROUNDING: f64 = 1e-6;
/// Keypoints of two points that lie within the tolerance of each other are taken for one, which pulls the places a little.
const WRONG_PAIRS: f64 = 1e-3;
/// As a share of the extent, what noise may leave of a chain; 0.00007 was measured.
const REACH: f64 = 5e-4;

/// Every part in a gauge of its own.
fn gauge(k: usize) -> Similarity {
    let t = k as f64;
    Similarity {
        scale: 1.0 + 0.7 * t,
        rotation: Rotation3::from_euler_angles(0.4 * t, -0.9 * t, 1.7 * t),
        translation: Vector3::new(5.0 * t, -3.0 * t, t),
    }
}

/// Pieces of the sample with noise of their own.
fn write_sample_parts(room: &Path, views: [std::ops::Range<usize>; 3], names: [&str; 3], noise: f64) -> Vec<PathBuf> {
    let whole = sample();
    let part = |(k, views): (usize, std::ops::Range<usize>)| {
        blurred(piece(&whole, views, &gauge(k)), noise * gauge(k).scale, k as u64)
    };
    let parts = views.into_iter().enumerate().map(part);
    parts.zip(names).map(|(part, name)| write_part(room, name, &part)).collect()
}

/// Every two share photographs.
const TRIANGLE: [std::ops::Range<usize>; 3] = [0..11, 6..18, 9..24];
/// The first and the second share one photograph, the second and the third another, the first and the third none.
const CHAIN: [std::ops::Range<usize>; 3] = [0..9, 8..17, 16..24];
/// 3 cm on the walls of the sample, which has 6.5 m to its unit.
const NOISE: f64 = 0.03 / 6.5;

fn real_chain(room: &Path, names: [&str; 3]) -> Option<Vec<PathBuf>> {
    let scene = shared("data/merge/castle-chain")?;
    let read = |part: &str| read_reconstruction(&scene.join(part)).unwrap();
    let parts = ["part_a", "part_b", "part_c"].into_iter().zip(names);
    Some(parts.map(|(part, name)| write_part(room, name, &read(part))).collect())
}

/// The files of a merge, by name.
fn merged(parts: &[&PathBuf], out: &Path, threads: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
    let ended = command.arg("merge").args(parts).arg("-o").arg(out).args(["--quiet", "--threads", threads]).output();
    let ended = ended.unwrap();
    assert_eq!(ended.status.code(), Some(0), "{}", String::from_utf8_lossy(&ended.stdout));
    let files = |folder: &Path| {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        entries.filter(|path| path.is_file()).collect::<Vec<_>>()
    };
    let mut all: Vec<PathBuf> = files(out).into_iter().chain(files(&out.join("sfm"))).collect();
    all.sort();
    all.into_iter().map(|path| (path.strip_prefix(out).unwrap().into(), std::fs::read(&path).unwrap())).collect()
}

fn report(files: &[(PathBuf, Vec<u8>)]) -> Value {
    let (_, text) = files.iter().find(|(path, _)| path.ends_with("merge.json")).unwrap();
    serde_json::from_slice(text).unwrap()
}

/// The place of every part as seen from the part `names[0]`.
fn places(report: &Value, names: [&str; 3]) -> [Similarity; 3] {
    let of = |name: &str| {
        let part = report["parts"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap();
        similarity(&part["transform"])
    };
    names.map(|name| of(names[0]).inverse() * of(name))
}

fn assert_same_places(one: [Similarity; 3], other: [Similarity; 3], tolerance: f64) {
    for (one, other) in one.iter().zip(&other) {
        for x in [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 10.0, -10.0]].map(Point3::from) {
            let (p, q) = (one.apply(&x), other.apply(&x));
            assert!((p - q).norm() < tolerance * (1.0 + p.coords.norm()), "{p} {q}");
        }
    }
}

fn assert_only_the_frame_changes(write: impl Fn(&Path, [&'static str; 3]) -> Option<Vec<PathBuf>>) {
    let room = tempfile::tempdir().unwrap();
    let names = ["first", "second", "third"];
    let Some(parts) = write(&room.path().join("one"), names) else { return };
    let [a, b, c] = [&parts[0], &parts[1], &parts[2]];
    let before = merged(&[a, b, c], &room.path().join("before"), "1");
    let told = report(&before);

    assert!(before == merged(&[a, b, c], &room.path().join("threads"), "3"), "the number of threads changes the files");

    for (k, order) in [[a, c, b], [c, b, a], [b, a, c]].into_iter().enumerate() {
        let again = report(&merged(&order, &room.path().join(format!("order{k}")), "2"));
        assert_eq!(told["ledger"], again["ledger"]);
        assert_eq!(again["parts"][0]["transform"]["scale"], 1.0, "the first part gives the frame");
        assert_same_places(places(&told, names), places(&again, names), ROUNDING);
    }

    // Other names, which sort the other way round.
    let other_names = ["zz", "m m", "a"];
    let renamed = write(&room.path().join("other"), other_names).unwrap();
    let again = merged(&renamed.iter().collect::<Vec<_>>(), &room.path().join("renamed"), "2");
    for ((path, one), (_, other)) in before.iter().zip(&again) {
        if !path.ends_with("merge.json") {
            assert!(one == other, "names of folders change {}", path.display());
        }
    }
    for (one, other) in told["parts"].as_array().unwrap().iter().zip(report(&again)["parts"].as_array().unwrap()) {
        assert_eq!(one["transform"], other["transform"]);
    }
}

#[test]
fn order_threads_and_names_change_nothing_but_the_frame() {
    assert_only_the_frame_changes(|room, names| Some(write_sample_parts(room, TRIANGLE, names, 0.0)));
}

#[test]
fn order_threads_and_names_change_nothing_but_the_frame_of_a_chain() {
    assert_only_the_frame_changes(|room, names| Some(write_sample_parts(room, CHAIN, names, NOISE)));
}

#[test]
fn order_threads_and_names_change_nothing_but_the_frame_of_a_real_chain() {
    assert_only_the_frame_changes(real_chain);
}

#[test]
fn pieces_of_one_reconstruction_come_together_as_they_were() {
    let (found, truth, _) = merged_pieces(TRIANGLE, 0.0);
    assert_same_places(found, truth, WRONG_PAIRS);
}

#[test]
fn a_chain_of_pieces_with_noise_comes_together_over_one_photograph_each() {
    let (found, truth, parts) = merged_pieces(CHAIN, NOISE);
    for k in [1, 2] {
        let off = share_off([&parts[0].points, &parts[k].points], &found[k], &truth[k]);
        println!("part {k}: {off} of the extent off");
        assert!(off < REACH, "part {k}: {off}");
    }
}

/// Places of the pieces of the sample as seen from the first: merged, and in truth; and the pieces.
fn merged_pieces(
    views: [std::ops::Range<usize>; 3],
    noise: f64,
) -> ([Similarity; 3], [Similarity; 3], Vec<Reconstruction>) {
    let room = tempfile::tempdir().unwrap();
    let names = ["first", "second", "third"];
    let parts = write_sample_parts(room.path(), views, names, noise);
    let told = report(&merged(&parts.iter().collect::<Vec<_>>(), &room.path().join("out"), "2"));
    assert_eq!(told["ledger"]["images"]["kept"], 24);
    let truth = [0, 1, 2].map(|k| gauge(0) * gauge(k).inverse());
    (places(&told, names), truth, parts.iter().map(|part| read_reconstruction(part).unwrap()).collect())
}
