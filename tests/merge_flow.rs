//! `cityweld merge` from files to files, on a scene that the test makes itself: a room's corner seen by five cameras, the
//! third of which is in both parts.

mod json_schema;
mod pieces;

use std::path::Path;
use std::process::Command;

use cityweld::internals::{Matrix7, MotionParameters};
use cityweld::steps::{JoinOptions, Part, join, merge_report};
use cityweld::types::{Anchor, Camera, CameraIndex, CameraModel, ImageIndex, PointIndex, Support};
use cityweld::{
    Freedom, Image, MergeVerdict, Observation, Point3, Reconstruction, Rotation3, Similarity, Vector3, Verdict,
    read_reconstruction, write_colmap,
};
use json_schema::keeps;
use pieces::mirrored;
use serde_json::Value;

fn camera() -> Camera {
    Camera { model: CameraModel::SimplePinhole, width_px: 1000, height_px: 800, params: vec![900.0, 500.0, 400.0] }
}

/// Points on a floor and two walls.
fn world_points() -> Vec<Point3<f64>> {
    let wave = |i: usize, step: f64| (i as f64 * step).fract();
    (0..600)
        .map(|i| {
            let (u, v) = (6.0 * wave(i, 0.754_877_666), 4.0 * wave(i, 0.569_840_291));
            match i % 3 {
                0 => Point3::new(u - 3.0, 2.0, 8.0 + v),
                1 => Point3::new(u - 3.0, v - 2.0, 12.0),
                _ => Point3::new(3.0, v - 2.0, 8.0 + 0.66 * u),
            }
        })
        .collect()
}

/// What the cameras `views` see, in a frame of the part's own.
fn part(
    views: std::ops::Range<usize>,
    part_from_world: &Similarity,
    photo_name: impl Fn(usize) -> String,
) -> Reconstruction {
    let world = world_points();
    let mut r = Reconstruction { cameras: vec![camera()], camera_ids: vec![7], ..Reconstruction::default() };
    let mut tracks: Vec<Vec<(ImageIndex, u32)>> = vec![Vec::new(); world.len()];
    for view in views {
        let rotation = Rotation3::from_euler_angles(0.0, 0.06 * (view as f64 - 2.0), 0.0);
        let center = Point3::new(1.2 * view as f64 - 2.4, 0.1 * view as f64, 0.0);
        let index = ImageIndex(r.images.len() as u32);
        let mut image = Image {
            id: 10 + index.0,
            camera: CameraIndex(0),
            name: photo_name(view),
            cam_from_sfm_rotation: rotation,
            cam_from_sfm_translation: -(rotation * center.coords),
            ..Image::default()
        };
        for (p, x) in world.iter().enumerate() {
            let Some([x_px, y_px]) = camera().project(&image.cam_from_sfm(x)) else { continue };
            if (0.0..1000.0).contains(&x_px) && (0.0..800.0).contains(&y_px) {
                tracks[p].push((index, image.observations.len() as u32));
                image.observations.push(Observation { x_px, y_px, point: Some(PointIndex(p as u32)) });
            }
        }
        r.images.push(image);
    }
    keep_seen_twice(&mut r, &world, tracks);
    r.transformed(part_from_world)
}

fn keep_seen_twice(r: &mut Reconstruction, world: &[Point3<f64>], tracks: Vec<Vec<(ImageIndex, u32)>>) {
    r.track_starts.push(0);
    let mut number_of = vec![None; world.len()];
    for (p, track) in tracks.into_iter().enumerate().filter(|(_, track)| track.len() > 1) {
        number_of[p] = Some(PointIndex(r.points.len() as u32));
        r.points.push(world[p]);
        r.point_ids.push(100 + p as u64);
        r.point_errors_px.push(0.5);
        r.colors.push([90, 120, 30]);
        r.track_elements.extend(track);
        r.track_starts.push(r.track_elements.len() as u32);
    }
    for o in r.images.iter_mut().flat_map(|image| &mut image.observations) {
        o.point = o.point.and_then(|p| number_of[p.0 as usize]);
    }
}

fn second_from_world() -> Similarity {
    Similarity {
        scale: 0.4,
        rotation: Rotation3::from_euler_angles(1.0, -0.5, 2.0),
        translation: Vector3::new(9.0, -4.0, 2.0),
    }
}

fn given(name: &str, sfm: Reconstruction) -> Part {
    Part { name: name.into(), sfm, superpixels: None, anchor: None }
}

fn photo(view: usize) -> String {
    format!("street/{view}.jpg")
}

fn two_parts() -> [Part; 2] {
    let first = part(0..3, &Similarity::identity(), photo);
    let second = part(2..5, &second_from_world(), photo);
    [given("first", first), given("second", second)]
}

#[test]
fn joins_two_parts_over_one_photograph_in_both_orders() {
    let [first, second] = two_parts();
    let x = Point3::new(1.0, -1.0, 9.0);
    for (parts, frame_from_world) in
        [([first.clone(), second.clone()], Similarity::identity()), ([second, first], second_from_world())]
    {
        let found = join(&parts, &JoinOptions::default(), &()).unwrap();
        assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
        for (part, place) in parts.iter().zip(&found.parts) {
            let part_from_world = if part.name == "first" { Similarity::identity() } else { second_from_world() };
            let moved = place.merged_from_part.unwrap().apply(&part_from_world.apply(&x));
            assert!((moved - frame_from_world.apply(&x)).norm() < 1e-4, "{}", part.name);
        }
        let model = found.model.unwrap();
        assert_eq!(model.sfm.images.len(), 5);
        assert_eq!(model.sfm.cameras.len(), 1, "equal intrinsics become one camera");
        assert_eq!((found.ledger.images.given, found.ledger.images.fused), (6, 1));
        // Every point that both parts see in the shared photograph becomes one.
        assert!(found.ledger.points.fused > 100, "{:?}", found.ledger);
        assert_eq!(found.ledger.points.given, found.ledger.points.kept + found.ledger.points.fused);
    }
}

#[test]
fn leaves_a_part_out_that_shares_nothing() {
    let [first, second] = two_parts();
    let stranger = part(0..3, &second_from_world(), |view| format!("elsewhere/{view}.jpg"));
    let found = join(&[first, second, given("stranger", stranger)], &JoinOptions::default(), &()).unwrap();
    assert_eq!(found.verdict, MergeVerdict::Partial);
    assert!(found.parts[2].merged_from_part.is_none() && found.parts[2].reason.is_some());
    assert_eq!(found.ledger.images.dropped.values().sum::<usize>(), 3);
}

#[test]
fn does_not_join_photographs_that_only_share_their_name() {
    let [first, second] = two_parts();
    // The same name on another view: other keypoints.
    let mut other = second;
    other.sfm.images[0].name = "none.jpg".into();
    other.sfm.images[2].name = photo(2);
    let found = join(&[first, other], &JoinOptions::default(), &()).unwrap();
    assert_eq!(found.verdict, MergeVerdict::Failed, "{}", found.reason);
    assert!(found.model.is_none());
}

#[test]
fn does_not_join_a_part_that_is_stretched_along_one_axis() {
    let [first, mut second] = two_parts();
    let stretch = |p: &Point3<f64>| Point3::new(p.x, p.y, 1.3 * p.z);
    for p in &mut second.sfm.points {
        *p = stretch(p);
    }
    for image in &mut second.sfm.images {
        image.cam_from_sfm_translation = -(image.cam_from_sfm_rotation * stretch(&image.center()).coords);
    }
    let found = join(&[first, second], &JoinOptions::default(), &()).unwrap();
    assert_eq!(found.verdict, MergeVerdict::Failed, "{}", found.reason);
}

#[test]
fn gives_the_same_for_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| join(&two_parts(), &JoinOptions::default(), &()).unwrap().model.unwrap().sfm.points)
    };
    assert_eq!(run(1), run(3));
}

fn run(parts: &[&Path], out: &Path) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cityweld"));
    command.arg("merge").args(parts).arg("-o").arg(out).arg("--quiet").output().unwrap()
}

#[test]
fn writes_a_model_that_can_be_read_again_and_says_how_it_ended() {
    let room = tempfile::tempdir().unwrap();
    let folders = ["a", "b"].map(|name| room.path().join(name));
    for (folder, part) in folders.iter().zip(two_parts()) {
        write_colmap(folder, &part.sfm).unwrap();
    }
    let out = room.path().join("out");
    let ended = run(&[&folders[0], &folders[1]], &out);
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    let joined = read_reconstruction(&out.join("sfm")).unwrap();
    assert!(joined.images.len() == 5 && joined.warnings.is_empty(), "{:?}", joined.warnings);
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("merge.json")).unwrap()).unwrap();
    assert_eq!(report["verdict"], "merged");
    for what in ["images", "points", "observations"] {
        let account = &report["ledger"][what];
        let count = |v: &serde_json::Value| v.as_u64().unwrap();
        let dropped: u64 = account["dropped"].as_object().unwrap().values().map(count).sum();
        assert_eq!(count(&account["in"]), count(&account["kept"]) + count(&account["fused"]) + dropped, "{what}");
    }
    assert!(out.join("scene.glb").is_file() && out.join("points.ply").is_file());

    // An output that exists is not touched, and a part that is not there leaves nothing behind.
    assert_eq!(run(&[&folders[0], &folders[1]], &out).status.code(), Some(2));
    let nowhere = room.path().join("nowhere");
    assert_eq!(run(&[&folders[0], &nowhere], &room.path().join("out2")).status.code(), Some(2));
    assert!(!room.path().join("out2").exists());
}

#[test]
fn one_part_given_twice_is_the_identity() {
    let [first, _] = two_parts();
    let found = join(&[given("a", first.sfm.clone()), given("b", first.sfm)], &JoinOptions::default(), &()).unwrap();
    assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
    let pose = found.parts[1].merged_from_part.unwrap();
    assert!((pose.scale - 1.0).abs() < 1e-9 && pose.translation.norm() < 1e-9);
    assert_eq!(found.ledger.images.kept, 3);
}

/// The part in the world's frame, as a city would hold it.
fn anchor(world_from_part: Similarity, verdict: Verdict) -> Anchor {
    let along_up = Freedom {
        name: "along up".into(),
        direction: Vector3::z(),
        sigma: 3.0,
        kind: cityweld::types::FreedomKind::Shift,
        unit: cityweld::types::FreedomUnit::Metre,
        determined: verdict == Verdict::Aligned,
        given: false,
    };
    Anchor {
        common_from_part: world_from_part,
        verdict,
        parameters: MotionParameters::of_similarity(Point3::new(0.0, 0.0, 10.0), 5.0),
        information: Matrix7::identity() * 400.0,
        reason: "in the city undetermined: along up".into(),
        freedoms: vec![along_up],
        support: Support::default(),
    }
}

#[test]
fn every_kind_of_report_keeps_to_the_published_schema() {
    let schema: Value = serde_json::from_str(include_str!("../assets/merge.schema.json")).unwrap();
    let [first, second] = two_parts();
    let stranger = given("stranger", part(0..3, &second_from_world(), |view| format!("elsewhere/{view}.jpg")));
    let anchored = |part: &Part, verdict| {
        let world_from_part =
            if part.name == "second" { second_from_world().inverse() } else { Similarity::identity() };
        Part { anchor: Some(anchor(world_from_part, verdict)), ..part.clone() }
    };
    use Verdict::{Aligned, Ambiguous, Failed, Undetermined};
    for (parts, verdict) in [
        (vec![first.clone(), second.clone()], "merged"),
        (vec![first.clone(), second.clone(), stranger.clone()], "partial"),
        (vec![first.clone(), stranger.clone()], "failed"),
        (vec![anchored(&first, Aligned), anchored(&second, Aligned)], "merged"),
        (vec![anchored(&first, Aligned), anchored(&stranger, Aligned)], "merged"),
        (vec![anchored(&first, Aligned), anchored(&stranger, Undetermined)], "undetermined"),
        (vec![anchored(&first, Aligned), anchored(&stranger, Ambiguous)], "ambiguous"),
        (vec![anchored(&first, Failed), anchored(&stranger, Failed)], "failed"),
    ] {
        let found = join(&parts, &JoinOptions::default(), &()).unwrap();
        let report: Value = serde_json::from_str(&merge_report(&found).unwrap()).unwrap();
        assert_eq!(report["verdict"], verdict, "{report:#}");
        assert!(keeps(&report, &schema, &schema), "{report:#}");
        let mut broken = report.clone();
        broken["parts"][0]["placed"] = Value::from("yes");
        assert!(!keeps(&broken, &schema, &schema), "the schema refuses what is none");
        // A place comes with what holds it; the part that gives the frame is held by nothing.
        let placed = report["parts"].as_array().unwrap().iter().filter(|p| p["placed"] == true);
        let free = placed.filter(|p| p["freedoms"].as_array().unwrap().len() == 7).count();
        let in_city = report["frame"] == "the city's";
        let expected = found.parts.iter().filter(|p| p.merged_from_part.is_some()).count();
        assert_eq!(free, if in_city { expected } else { expected.saturating_sub(1) }, "{report:#}");
    }
}

#[test]
fn a_part_of_mirrored_photographs_stays_apart() {
    let [first, second] = two_parts();
    let mirrored = given("mirrored", mirrored(second.sfm.clone()));
    let x = mirrored.sfm.images[0].cam_from_sfm(&mirrored.sfm.points[0]);
    assert!(x.z > 0.0, "the mirrored model is sound");
    // And one whose depths are turned inside out, at the same pixels.
    let mut inside_out = second;
    inside_out.sfm.points.iter_mut().for_each(|p| *p = Point3::from(-p.coords));
    inside_out.sfm.images.iter_mut().for_each(|i| i.cam_from_sfm_translation *= -1.0);
    for (other, why) in [(mirrored, "different keypoints"), (inside_out, "contradicts itself")] {
        let found = join(&[first.clone(), other], &JoinOptions::default(), &()).unwrap();
        assert_eq!(found.verdict, MergeVerdict::Failed);
        assert!(found.reason.contains(why), "{}", found.reason);
    }
}

#[test]
fn keeps_the_rigs_and_frames_of_both_parts() {
    let rig =
        read_reconstruction(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reconstruction/rig_bin")).unwrap();
    let again = rig.transformed(&second_from_world());
    let found = join(&[given("a", rig.clone()), given("b", again)], &JoinOptions::default(), &()).unwrap();
    assert_eq!(found.verdict, MergeVerdict::Merged, "{}", found.reason);
    let model = found.model.unwrap().sfm;
    let room = tempfile::tempdir().unwrap();
    write_colmap(room.path(), &model).unwrap();
    // Reading tells of images whose poses differ from those by their rig and frame.
    let read = read_reconstruction(room.path()).unwrap();
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    let (before, after) = (rig.colmap.unwrap(), read.colmap.unwrap());
    let cameras_in_rigs = |rigs: &[cityweld::internals::RigRecord]| {
        rigs.iter().filter(|r| !r.others.is_empty()).map(|r| 1 + r.others.len()).max()
    };
    assert_eq!(cameras_in_rigs(&before.rigs.unwrap()), cameras_in_rigs(&after.rigs.unwrap()));
    let seen: usize = after.frames.unwrap().iter().map(|f| f.data.len()).sum();
    assert_eq!(seen, read.images.len());
}
