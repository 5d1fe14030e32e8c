//! Reads and writes whole reconstructions: COLMAP models and PLY clouds.

mod needs;

use std::fs;
use std::path::{Path, PathBuf};

use cityweld::synthetic::{Block, CloudOptions};
use cityweld::types::PointIndex;
use cityweld::{Point3, Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction, write_colmap, write_ply};
use needs::{pycolmap, shared};

fn subfolders(folder: &Path) -> Vec<PathBuf> {
    let mut found: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()).collect();
    found.sort();
    found
}

/// Every COLMAP model among the shared scenes; `None` where they are not there.
fn shared_models() -> Option<Vec<PathBuf>> {
    let kinds = [shared("data/city")?, shared("data/merge")?];
    let parts = kinds.iter().flat_map(|kind| subfolders(kind)).flat_map(|scene| subfolders(&scene));
    let models: Vec<_> =
        parts.filter(|p| p.join("points3D.bin").is_file() || p.join("points3D.txt").is_file()).collect();
    assert!(models.len() > 20, "{models:?}");
    Some(models)
}

/// Models that come with the project.
fn own_models() -> Vec<PathBuf> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample/sfm");
    ["rig_bin", "rig_txt"].map(|name| data().join(name)).into_iter().chain([sample]).collect()
}

fn assert_same(a: &Reconstruction, b: &Reconstruction) {
    assert_eq!(a.cameras, b.cameras);
    assert_eq!(a.camera_ids, b.camera_ids);
    assert_eq!(a.points, b.points);
    assert_eq!(a.point_ids, b.point_ids);
    assert_eq!(a.point_errors_px, b.point_errors_px);
    assert_eq!(a.colors, b.colors);
    assert_eq!(a.track_starts, b.track_starts);
    assert_eq!(a.track_elements, b.track_elements);
    assert_eq!(a.colmap, b.colmap);
    assert_eq!(a.images.len(), b.images.len());
    for (a, b) in a.images.iter().zip(&b.images) {
        assert_eq!((a.id, a.camera, &a.name, a.pose()), (b.id, b.camera, &b.name, b.pose()));
        assert_eq!(a.observations, b.observations);
    }
}

#[test]
fn every_model_of_the_project_is_read_and_written_again_to_the_bit() {
    assert_written_to_the_bit(own_models());
}

#[test]
fn every_shared_model_is_read_and_written_again_to_the_bit() {
    assert_written_to_the_bit(shared_models().unwrap_or_default());
}

fn assert_written_to_the_bit(models: Vec<PathBuf>) {
    for folder in models {
        let read = read_reconstruction(&folder).unwrap_or_else(|error| panic!("{error}"));
        println!(
            "{}: {} points, {} images, {:?}",
            folder.display(),
            read.points.len(),
            read.images.len(),
            read.warnings
        );
        assert!(!read.images.is_empty() && read.track_elements.len() >= 2 * read.points.len());
        assert!((0..read.points.len()).all(|p| !read.track(PointIndex(p as u32)).is_empty()));
        let out = tempfile::tempdir().unwrap();
        write_colmap(out.path(), &read).unwrap();
        assert_same(&read, &read_reconstruction(out.path()).unwrap());
        for entry in fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_file()) {
            let written = out.path().join(entry.file_name().unwrap());
            if entry.extension().is_some_and(|e| e == "bin") {
                assert_eq!(fs::read(&entry).unwrap(), fs::read(&written).unwrap(), "{}", entry.display());
            } else if entry.extension().is_some_and(|e| e == "txt") {
                assert!(written.is_file(), "{}", written.display());
            }
        }
    }
}

#[test]
fn a_cloud_is_written_and_read_again_to_the_bit() {
    let points = Block::mixed_houses().cloud(&CloudOptions::default()).sfm.points;
    let cloud = Reconstruction { points, ..Reconstruction::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    write_ply(&path, &cloud).unwrap();
    assert_eq!(read_reconstruction(&path).unwrap().points, cloud.points);
}

#[test]
fn shared_clouds_are_read_and_written_again_to_the_bit() {
    for scene in ["pts_denhaag", "pts_ingolstadt", "pts_rotterdam_walls"] {
        let Some(cloud) = shared(&format!("data/city/{scene}/cloud.ply")) else { return };
        let read = read_reconstruction(&cloud).unwrap();
        assert_eq!(read.points.len(), 10_000);
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("cloud.ply");
        write_ply(&out, &read).unwrap();
        assert_eq!(read_reconstruction(&out).unwrap().points, read.points);
    }
}

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reconstruction")
}

/// A turn, a scale and a shift to coordinates as large as a national grid's.
fn city_from_sfm() -> Similarity {
    Similarity {
        scale: 0.37,
        rotation: Rotation3::from_euler_angles(1.2, -0.3, 2.5),
        translation: Vector3::new(448_251.25, 5_411_932.5, 112.75),
    }
}

/// Shares and pixels: what rounding leaves at coordinates of 5 million beside distances of about 10.
const MOVED_TOLERANCES: [f64; 5] = [1e-14, 1e-14, 1e-12, 1e-5, 1e-6];

#[test]
fn pycolmap_opens_moved_models_and_finds_the_same_reprojection_errors() {
    assert_moved_as_pycolmap_sees_it(own_models());
}

#[test]
fn pycolmap_opens_moved_shared_models_and_finds_the_same_reprojection_errors() {
    let scenes = ["city/rotterdam_oblique/sfm", "city/delft_street/sfm", "merge/lund-one/part_b"];
    assert_moved_as_pycolmap_sees_it(scenes.iter().filter_map(|scene| shared(&format!("data/{scene}"))).collect());
}

fn assert_moved_as_pycolmap_sees_it(models: Vec<PathBuf>) {
    let city_from_sfm = city_from_sfm();
    for folder in models {
        let Some(mut python) = pycolmap() else { return };
        let out = tempfile::tempdir().unwrap();
        let moved = read_reconstruction(&folder).unwrap().transformed(&city_from_sfm);
        write_colmap(out.path(), &moved).unwrap();
        let Similarity { scale, rotation, translation } = city_from_sfm;
        let by_rows = rotation.matrix().transpose();
        let numbers = [scale].into_iter().chain(by_rows.iter().copied()).chain(translation.iter().copied());
        let output = python
            .arg(data().join("compare_moved.py"))
            .args([&folder, out.path()])
            .args(numbers.map(|v| v.to_string()))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let printed = String::from_utf8(output.stdout).unwrap();
        println!("{}: {printed}", folder.display());
        let differences: Vec<f64> = printed.split_whitespace().map(|v| v.parse().unwrap()).collect();
        assert_eq!(differences.len(), MOVED_TOLERANCES.len());
        for (difference, tolerance) in differences.iter().zip(MOVED_TOLERANCES) {
            assert!(*difference <= tolerance, "{}: {printed}", folder.display());
        }
    }
}

#[test]
fn a_moved_rig_keeps_its_frames_and_its_images_together() {
    for name in ["rig_bin", "rig_txt"] {
        let read = read_reconstruction(&data().join(name)).unwrap();
        assert!(read.warnings.is_empty());
        let moved = read.transformed(&city_from_sfm());
        let out = tempfile::tempdir().unwrap();
        write_colmap(out.path(), &moved).unwrap();
        // Reading tells of images whose poses differ from those by their rig and frame.
        let again = read_reconstruction(out.path()).unwrap();
        assert!(again.warnings.is_empty(), "{:?}", again.warnings);
        assert_same(&moved, &again);
        let rigs = again.colmap.unwrap().rigs.unwrap();
        let (before, after) =
            (read.colmap.unwrap().rigs.unwrap()[0].others[0].1.unwrap(), rigs[0].others[0].1.unwrap());
        assert_eq!(before.quaternion_wxyz, after.quaternion_wxyz);
        assert_eq!(before.translation.map(|v| 0.37 * v), after.translation);
    }
}

#[test]
fn the_made_up_rig_is_seen_where_its_cameras_project_it() {
    let read = read_reconstruction(&data().join("rig_bin")).unwrap();
    let moved = read.transformed(&city_from_sfm());
    for (r, tolerance_px) in [(&read, 1e-6), (&moved, 1e-4)] {
        for image in &r.images {
            let camera = &r.cameras[image.camera.0 as usize];
            for o in &image.observations {
                let Some(point) = o.point else { continue };
                let [x, y] = camera.project(&image.cam_from_sfm(&r.points[point.0 as usize])).unwrap();
                assert!((x - o.x_px).hypot(y - o.y_px) < tolerance_px, "{x} {y} {o:?}");
            }
        }
    }
    let center = moved.images[0].center();
    assert!((city_from_sfm().apply(&read.images[0].center()) - center).norm() < 1e-8);
    assert!(moved.images[0].cam_from_sfm(&center).coords.norm() < 1e-8);
}

#[test]
fn moving_there_and_back_gives_the_same_points() {
    let read = read_reconstruction(&data().join("rig_bin")).unwrap();
    let back = read.transformed(&city_from_sfm()).transformed(&city_from_sfm().inverse());
    let apart = |(a, b): (&Point3<f64>, &Point3<f64>)| (a - b).norm();
    assert!(read.points.iter().zip(&back.points).map(apart).fold(0.0, f64::max) < 1e-8);
}

#[test]
fn a_cloud_keeps_its_normals_and_colours_when_written() {
    let mut cloud = read_reconstruction(&data().join("ply/sound_little.ply")).unwrap();
    cloud.normals = vec![Vector3::x(), Vector3::y(), Vector3::new(0.6, 0.0, 0.8)];
    let moved = cloud.transformed(&city_from_sfm());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.ply");
    write_ply(&path, &moved).unwrap();
    let again = read_reconstruction(&path).unwrap();
    assert_eq!((&again.points, &again.colors), (&moved.points, &moved.colors));
    assert!(again.normals.iter().zip(&moved.normals).all(|(a, b)| (a - b).norm() < 1e-15));
    assert!((moved.normals[0] - city_from_sfm().rotation * Vector3::x()).norm() < 1e-15);
}

#[test]
fn what_cannot_be_written_is_told_with_its_path() {
    let read = read_reconstruction(&data().join("rig_bin")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("file");
    fs::write(&blocked, "in the way").unwrap();
    let message = write_colmap(&blocked.join("sfm"), &read).unwrap_err().to_string();
    assert!(message.contains("file/sfm"), "{message}");
    assert!(write_ply(&blocked.join("points.ply"), &read).unwrap_err().to_string().contains("points.ply"));
    let mut lacking = read;
    lacking.point_ids.clear();
    assert!(write_colmap(folder.path(), &lacking).unwrap_err().to_string().contains("an id for every point"));
}
