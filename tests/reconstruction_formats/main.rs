//! Reconstructions in the forms that people have them: LAS, E57, OpenSfM, nerfstudio, OpenMVG, Bundler, NVM.

#[path = "../needs/mod.rs"]
mod needs;
mod refusals;

use std::path::{Path, PathBuf};

use cityweld::types::{PointIndex, SfmFormat, WarningKind};
use cityweld::{Point3, Reconstruction, Rotation3, Vector3, read_reconstruction, write_colmap, write_ply};
use nalgebra::UnitQuaternion;
use needs::shared;
use serde_json::{Value, json};

#[test]
fn shared_files_give_the_numbers_that_were_counted_independently() {
    let Some(folder) = shared("data/formats") else { return };
    let expected: Value = serde_json::from_slice(&std::fs::read(folder.join("expected.json")).unwrap()).unwrap();
    let mut failures = Vec::new();
    for (name, expected) in expected.as_object().unwrap() {
        if expected["kind"] != "reconstruction" {
            continue;
        }
        let read = match read_reconstruction(&folder.join(name)) {
            Ok(read) => read,
            Err(error) => {
                failures.push(format!("{name}: {error}"));
                continue;
            }
        };
        let warnings: String = read.warnings.iter().map(|w| format!("{w}; ")).collect();
        println!(
            "{name}: {}, {} images, {} points, {:?}; {warnings}",
            read.format,
            read.images.len(),
            read.points.len(),
            read.crs.as_ref().map(|c| c.epsg)
        );
        let mut check = |key: &str, found: Value| {
            if !expected[key].is_null() && expected[key] != found {
                failures.push(format!("{name}: {key} {found}, expected {}", expected[key]));
            }
        };
        // The file's count is with the noise.
        let noise = read.warnings.iter().find(|w| w.kind == WarningKind::NoiseLeftOut).map_or(0, |w| w.count);
        check("points", (read.points.len() + noise).into());
        check("images", read.images.len().into());
        check("epsg", read.crs.as_ref().and_then(|crs| crs.epsg).into());
        if let Some(format) = expected["format"].as_str().filter(|format| !read.format.to_string().starts_with(format))
        {
            failures.push(format!("{name}: {}, expected {format}", read.format));
        }
        if let Some(words) = expected["warns"].as_str().filter(|words| !words.split('|').any(|w| warnings.contains(w)))
        {
            failures.push(format!("{name}: no warning of {words} in {warnings}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// The small real files of this repository.
fn small(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats").join(name)
}

fn kinds(r: &Reconstruction) -> Vec<WarningKind> {
    r.warnings.iter().map(|w| w.kind).collect()
}

/// Median distance in pixels between where a point is projected and where it was seen, and the greatest.
fn reprojection(r: &Reconstruction) -> [f64; 2] {
    let mut off = Vec::new();
    for index in 0..r.points.len() {
        for (image, keypoint) in r.track(PointIndex(index as u32)) {
            let seen = &r.images[image.0 as usize];
            let o = seen.observations[*keypoint as usize];
            let [x, y] =
                r.camera_of(*image).project(&seen.cam_from_sfm(&r.points[index])).expect("a point behind its camera");
            off.push((x - o.x_px).hypot(y - o.y_px));
        }
    }
    off.sort_by(f64::total_cmp);
    [off[off.len() / 2], off[off.len() - 1]]
}

#[test]
fn clouds_in_feet_are_read_as_they_are_with_their_unit_and_system() {
    for (name, format, points) in
        [("autzen.las", "LAS 1.2", 106), ("autzen.laz", "LAZ 1.2", 106), ("autzen.copc.laz", "COPC 1.4", 107)]
    {
        let read = read_reconstruction(&small(name)).unwrap();
        assert_eq!((read.format.to_string().as_str(), read.points.len(), read.images.len()), (format, points, 0));
        let told: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
        assert!(told.iter().any(|text| text.contains("feet") && text.contains("0.3048")), "{name}: {told:?}");
        let epsg = read.crs.as_ref().unwrap().epsg.unwrap();
        assert_eq!(epsg, if name == "autzen.copc.laz" { 2992 } else { 2994 }, "{name}");
        // Easting of the stadium in feet.
        assert!(read.points.iter().all(|p| (635_000.0..640_000.0).contains(&p.x)), "{name}: {}", read.points[0]);
    }
}

#[test]
fn further_values_of_a_cloud_are_written_out_again() {
    let read = read_reconstruction(&small("autzen.las")).unwrap();
    let out = tempfile::tempdir().unwrap();
    write_ply(&out.path().join("points.ply"), &read).unwrap();
    let again = read_reconstruction(&out.path().join("points.ply")).unwrap();
    assert_eq!((again.points, again.colors), (read.points, read.colors));
    assert!(read.fields.iter().any(|f| f.name == "intensity") && again.fields == read.fields);
}

/// Three cameras, whose pictures are 800 x 600 with the principal point in the middle, about twenty points.
struct World {
    /// Rotation and translation, world to camera (x right, y down, z ahead).
    poses: Vec<(Rotation3<f64>, Vector3<f64>)>,
    points: Vec<Point3<f64>>,
}

const FOCAL_PX: f64 = 500.0;
const K1: f64 = -0.05;

impl World {
    fn new() -> World {
        let pose = |i: i32| {
            let turn = Rotation3::from_euler_angles(0.1 * f64::from(i), 0.4 * f64::from(i - 1), 0.05);
            (turn, Vector3::new(0.3, -0.1 * f64::from(i), 9.0))
        };
        let point = |i: i32| Point3::new(f64::from(i % 5) - 2.0, f64::from(i / 5) - 1.5, 0.3 * f64::from(i * i % 7));
        World { poses: (0..3).map(pose).collect(), points: (0..20).map(point).collect() }
    }

    fn center(&self, camera: usize) -> Vector3<f64> {
        let (turn, shift) = self.poses[camera];
        -(turn.inverse() * shift)
    }

    /// Where a point appears from the middle of the picture, pixels right and down.
    fn seen(&self, camera: usize, point: usize) -> [f64; 2] {
        let (turn, shift) = self.poses[camera];
        let x = turn * self.points[point].coords + shift;
        let (u, v) = (x.x / x.z, x.y / x.z);
        let factor = FOCAL_PX * (1.0 + K1 * (u * u + v * v));
        [factor * u, factor * v]
    }

    /// Checks that a reconstruction is this world: centres, points, pixels, and that it is written and read again as COLMAP.
    fn check(&self, r: &Reconstruction) {
        assert_eq!((r.images.len(), r.points.len()), (3, 20));
        for (point, expected) in r.points.iter().zip(&self.points) {
            assert!((point - expected).norm() < 1e-9, "{point} {expected}");
        }
        for (number, image) in r.images.iter().enumerate() {
            let (turn, shift) = self.poses[number];
            assert!((image.cam_from_sfm_rotation.matrix() - turn.matrix()).norm() < 1e-9, "{}", image.name);
            assert!((image.cam_from_sfm_translation - shift).norm() < 1e-9, "{}", image.name);
        }
        let out = tempfile::tempdir().unwrap();
        write_colmap(out.path(), r).unwrap();
        let again = read_reconstruction(out.path()).unwrap();
        assert_eq!((&again.points, &again.track_elements), (&r.points, &r.track_elements));
        let names = |r: &Reconstruction| r.images.iter().map(|image| image.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&again), names(r));
    }
}

fn rows(r: &Rotation3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| r[(i, j)]))
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn openmvg_is_read_with_its_distortion_and_tracks() {
    let world = World::new();
    let view = |i: usize| {
        json!({"key": i, "value": {"polymorphic_id": 1073741824, "ptr_wrapper": {"id": i, "data": {"local_path": "",
            "filename": format!("{i}.jpg"), "width": 800, "height": 600, "id_view": i, "id_intrinsic": 0, "id_pose": i}}}})
    };
    let pose = |i: usize| json!({"key": i, "value": {"rotation": rows(&world.poses[i].0), "center": world.center(i).as_slice()}});
    let landmark = |p: usize| {
        let observation = |c: usize| {
            let [x, y] = world.seen(c, p);
            json!({"key": c, "value": {"id_feat": 0, "x": [x + 400.0, y + 300.0]}})
        };
        json!({"key": p, "value": {"X": world.points[p].coords.as_slice(), "observations": (0..3).map(observation).collect::<Vec<_>>()}})
    };
    let file = json!({"sfm_data_version": "0.3", "root_path": "", "views": (0..4).map(view).collect::<Vec<_>>(),
        "intrinsics": [{"key": 0, "value": {"polymorphic_id": 2147483649u32, "polymorphic_name": "pinhole_radial_k1",
            "ptr_wrapper": {"id": 9, "data": {"width": 800, "height": 600, "focal_length": FOCAL_PX,
            "principal_point": [400.0, 300.0], "disto_k1": [K1]}}}}],
        "extrinsics": (0..3).map(pose).collect::<Vec<_>>(), "structure": (0..20).map(landmark).collect::<Vec<_>>()});
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "sfm_data.json", &file.to_string());
    let read = read_reconstruction(folder.path()).unwrap();
    // The fourth view has no pose.
    assert_eq!((read.format.clone(), kinds(&read)), (SfmFormat::OpenMvg, vec![WarningKind::ImagesWithoutPose]));
    assert!(reprojection(&read)[1] < 1e-6);
    world.check(&read);
}

#[test]
fn opensfm_is_read_with_its_tracks_and_positions() {
    let world = World::new();
    let shot = |i: usize| {
        let (turn, shift) = &world.poses[i];
        json!({"rotation": turn.scaled_axis().as_slice(), "translation": shift.as_slice(), "camera": "c", "gps_position": [i, 2, 3]})
    };
    let shots: serde_json::Map<_, _> = (0..3).map(|i| (format!("{i}.jpg"), shot(i))).collect();
    let point = |p: &usize| {
        (format!("{:02}", p), json!({"color": [1.0, 2.0, 3.0], "coordinates": world.points[*p].coords.as_slice()}))
    };
    let points: serde_json::Map<_, _> = (0..20).map(|p| point(&p)).collect();
    let camera = json!({"projection_type": "perspective", "width": 800, "height": 600, "focal": FOCAL_PX / 800.0, "k1": K1, "k2": 0.0});
    let piece = json!({"cameras": {"c": camera}, "shots": shots, "points": points,
        "reference_lla": {"latitude": 52.5, "longitude": 13.4, "altitude": 7.0}});
    let smaller = json!({"cameras": {}, "shots": {}, "points": {}});
    let mut tracks = "OPENSFM_TRACKS_VERSION_v1\n".to_string();
    for (c, p) in (0..3).flat_map(|c| (0..20).map(move |p| (c, p))) {
        let [x, y] = world.seen(c, p).map(|v| v / 800.0);
        tracks += &format!("{c}.jpg\t{p:02}\t{p}\t{x}\t{y}\t0.001\t1\t2\t3\n");
    }
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "opensfm/reconstruction.json", &json!([smaller, piece]).to_string());
    write(folder.path(), "opensfm/tracks.csv", &(tracks + "9.jpg\t00\t0\t0\t0\t0.001\t1\t2\t3\n"));
    let read = read_reconstruction(folder.path()).unwrap();
    assert_eq!((read.format.clone(), kinds(&read)), (SfmFormat::OpenSfm, vec![WarningKind::PiecesLeftOut]));
    let positions = read.positions.as_ref().unwrap();
    assert_eq!((positions.reference_lla, positions.of_images[2]), (Some([52.5, 13.4, 7.0]), Some([2.0, 2.0, 3.0])));
    assert!(reprojection(&read)[1] < 1e-6);
    world.check(&read);
}

#[test]
fn cameras_of_opensfm_without_a_model_here_are_left_out_and_named() {
    let shot = json!({"rotation": [0, 0, 0], "translation": [0, 0, 0], "camera": "c"});
    let file = json!([{"cameras": {"c": {"projection_type": "fisheye62", "width": 8, "height": 6, "focal_x": 1, "focal_y": 1}},
        "shots": {"a.jpg": shot}, "points": {"1": {"coordinates": [0, 0, 1], "color": [0, 0, 0]}}}]);
    let folder = tempfile::tempdir().unwrap();
    let read = read_reconstruction(&write(folder.path(), "reconstruction.json", &file.to_string())).unwrap();
    assert_eq!((kinds(&read), read.images.len(), read.points.len()), (vec![WarningKind::CamerasNotHeld], 0, 1));
    assert!(read.warnings[0].to_string().contains("fisheye62"), "{}", read.warnings[0]);
}

#[test]
fn nerfstudio_is_read_in_the_frame_before_its_transform() {
    let world = World::new();
    let turn = Rotation3::from_euler_angles(-std::f64::consts::FRAC_PI_2, 0.0, 0.3);
    let (shift, scale) = (Vector3::new(1.0, -2.0, 0.5), 0.25);
    let moved = |x: &Vector3<f64>| scale * (turn * x + shift);
    let frame = |i: usize| {
        // Camera to world with y up and z back.
        let axes = turn * world.poses[i].0.inverse();
        let center = moved(&world.center(i));
        let row = |k: usize| json!([axes[(k, 0)], -axes[(k, 1)], -axes[(k, 2)], center[k]]);
        json!({"file_path": format!("./images/{i}.jpg"), "transform_matrix": [row(0), row(1), row(2), [0, 0, 0, 1]]})
    };
    let applied = |k: usize| json!([turn[(k, 0)], turn[(k, 1)], turn[(k, 2)], shift[k]]);
    let file = json!({"w": 800, "h": 600, "fl_x": FOCAL_PX, "fl_y": FOCAL_PX, "cx": 400.0, "cy": 300.0, "k1": K1, "k2": 0.0,
        "camera_model": "OPENCV", "frames": (0..3).map(frame).collect::<Vec<_>>(), "ply_file_path": "cloud.ply",
        "applied_transform": [applied(0), applied(1), applied(2)], "applied_scale": scale});
    let cloud = Reconstruction {
        points: world.points.iter().map(|p| Point3::from(moved(&p.coords))).collect(),
        ..Reconstruction::default()
    };
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "transforms.json", &file.to_string());
    let alone = read_reconstruction(folder.path()).unwrap();
    assert_eq!((alone.images.len(), alone.points.len(), kinds(&alone)), (3, 0, vec![WarningKind::NoPoints]));
    write_ply(&folder.path().join("cloud.ply"), &cloud).unwrap();
    let read = read_reconstruction(folder.path()).unwrap();
    assert_eq!((read.format.clone(), kinds(&read)), (SfmFormat::Nerfstudio, vec![]));
    assert_eq!(read.images[1].name, "images/1.jpg");
    for (c, p) in (0..3).flat_map(|c| (0..20).map(move |p| (c, p))) {
        let image = &read.images[c];
        let [x, y] = read.cameras[0].project(&image.cam_from_sfm(&read.points[p])).unwrap();
        let [expected_x, expected_y] = world.seen(c, p);
        assert!((x - 400.0 - expected_x).hypot(y - 300.0 - expected_y) < 1e-6);
    }
    world.check(&read);
}

/// A file of VisualSFM, with measurements from the middle of the picture or from its corner.
fn nvm(world: &World, corner: [f64; 2]) -> String {
    let mut text = "NVM_V3\n\n3\n".to_string();
    for i in 0..3 {
        let q = UnitQuaternion::from_rotation_matrix(&world.poses[i].0);
        let c = world.center(i);
        text +=
            &format!("photos/{i}.jpg {FOCAL_PX} {} {} {} {} {} {} {} {} 0\n", q.w, q.i, q.j, q.k, c.x, c.y, c.z, -K1);
    }
    text += "\n20\n";
    for (p, x) in world.points.iter().enumerate() {
        text += &format!("{} {} {} 10 20 30 3", x.x, x.y, x.z);
        for c in 0..3 {
            let [x, y] = world.seen(c, p);
            text += &format!(" {c} 0 {} {}", x + corner[0], y + corner[1]);
        }
        text += "\n";
    }
    text + "\n0\n"
}

#[test]
fn measurements_of_nvm_are_told_from_the_middle_or_the_corner_by_reprojection() {
    let world = World::new();
    for corner in [[0.0, 0.0], [400.0, 300.0]] {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), "scene.nvm", &nvm(&world, corner));
        for with_photographs in [false, true] {
            if with_photographs {
                let photo = image::GrayImage::new(800, 600);
                (0..3).for_each(|i| photo.save(folder.path().join(format!("{i}.jpg"))).unwrap());
            }
            let read = read_reconstruction(folder.path()).unwrap();
            let expected = if with_photographs { vec![] } else { vec![WarningKind::SizesGuessed] };
            assert_eq!(
                (read.format.clone(), kinds(&read)),
                (SfmFormat::Nvm, expected),
                "{corner:?}: {:?}",
                read.warnings
            );
            assert!(reprojection(&read)[1] < 1e-6, "{corner:?} {:?}", reprojection(&read));
            if with_photographs || corner[0] > 0.0 {
                assert_eq!((read.cameras[0].width_px, read.cameras[0].height_px), (800, 600), "{corner:?}");
            }
            world.check(&read);
        }
    }
}

#[test]
fn bundler_is_read_with_y_up_and_z_back() {
    let world = World::new();
    let mut text = "# Bundle file v0.3\n4 20\n".to_string();
    for (turn, shift) in &world.poses {
        // Half a turn about x.
        let half = |k: usize| if k == 0 { 1.0 } else { -1.0 };
        text += &format!("{FOCAL_PX} {K1} 0\n");
        (0..3).for_each(|k| {
            text += &format!("{} {} {}\n", half(k) * turn[(k, 0)], half(k) * turn[(k, 1)], half(k) * turn[(k, 2)])
        });
        text += &format!("{} {} {}\n", shift.x, -shift.y, -shift.z);
    }
    text += &"0 0 0\n".repeat(5);
    for (p, x) in world.points.iter().enumerate() {
        text += &format!("{} {} {}\n10 20 30\n3", x.x, x.y, x.z);
        for c in 0..3 {
            let [x, y] = world.seen(c, p);
            text += &format!(" {c} 0 {x} {}", -y);
        }
        text += "\n";
    }
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "bundle/bundle.out", &text);
    write(folder.path(), "list.txt", "./0.jpg\n1.jpg 0 500\n2.jpg\n3.jpg\n");
    let photo = image::GrayImage::new(800, 600);
    (0..4).for_each(|i| photo.save(folder.path().join(format!("{i}.jpg"))).unwrap());
    let read = read_reconstruction(folder.path()).unwrap();
    assert_eq!((read.format.clone(), kinds(&read)), (SfmFormat::Bundler, vec![WarningKind::ImagesWithoutPose]));
    assert_eq!(read.images.iter().map(|i| i.name.as_str()).collect::<Vec<_>>(), ["0.jpg", "1.jpg", "2.jpg"]);
    assert!(reprojection(&read)[1] < 1e-6);
    world.check(&read);
    write(folder.path(), "list.txt", "0.jpg\n");
    let message = read_reconstruction(folder.path()).unwrap_err().to_string();
    assert!(message.contains("list.txt") && message.contains("4 names") && message.contains("got 1"), "{message}");
}

#[test]
fn shared_files_are_read_in_their_conventions() {
    let Some(folder) = shared("data/formats") else { return };
    let read = |name: &str| read_reconstruction(&folder.join("sfm").join(name)).unwrap();
    // Figures of data/formats/README.md, found independently.
    let median = reprojection(&read("openmvg_sfm_data.json"))[0];
    assert!((0.31..0.33).contains(&median), "{median}");
    let median = reprojection(&read("visualsfm.nvm"))[0];
    assert!(median < 0.6, "{median}");
    let opensfm = read("opensfm_reconstruction.json");
    assert!(opensfm.images.iter().all(|image| opensfm.points.iter().all(|p| image.cam_from_sfm(p).z > 0.0)));
    assert_eq!(opensfm.positions.unwrap().of_images.iter().flatten().count(), 3);
    let scene = folder.join("../city/rotterdam_oblique/sfm");
    if scene.is_dir() {
        let (by_colmap, by_nerfstudio) = (read_reconstruction(&scene).unwrap(), read("transforms.json"));
        for image in &by_nerfstudio.images {
            let same = |other: &&cityweld::Image| image.name.ends_with(&other.name);
            let other = by_colmap.images.iter().find(same).unwrap();
            assert!((image.center() - other.center()).norm() < 1e-6, "{}", image.name);
            let off = image.cam_from_sfm_rotation.matrix() - other.cam_from_sfm_rotation.matrix();
            assert!(off.norm() < 1e-6, "{} {off}", image.name);
        }
    }
}
