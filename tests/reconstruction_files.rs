//! Reads and writes whole reconstructions: the shared scenes where they are present, and PLY clouds.

use std::fs;
use std::path::{Path, PathBuf};

use cityweld::export::colmap::write_colmap;
use cityweld::export::ply::write_ply;
use cityweld::reconstruction::{PointIndex, Reconstruction, read_reconstruction};

/// The folder of the shared scenes; `None` (and a word about it) where it is not present.
fn shared() -> Option<PathBuf> {
    let from_env = std::env::var_os("CITYWELD_SHARED").map(PathBuf::from);
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let found = from_env.into_iter().chain([beside]).find(|path| path.join("data").is_dir());
    if found.is_none() {
        println!("skipped: the shared scenes are not present");
    }
    found
}

fn subfolders(folder: &Path) -> Vec<PathBuf> {
    let mut found: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()).collect();
    found.sort();
    found
}

/// Every COLMAP model among the shared scenes.
fn shared_models() -> Vec<PathBuf> {
    let Some(shared) = shared() else { return Vec::new() };
    let scenes = ["data/city", "data/merge"].into_iter().flat_map(|kind| subfolders(&shared.join(kind)));
    let parts = scenes.flat_map(|scene| subfolders(&scene));
    parts.filter(|p| p.join("points3D.bin").is_file() || p.join("points3D.txt").is_file()).collect()
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
fn every_shared_model_is_read_and_written_again_to_the_bit() {
    for folder in shared_models() {
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
fn shared_clouds_are_read_and_written_again_to_the_bit() {
    let Some(shared) = shared() else { return };
    for scene in ["pts_denhaag", "pts_ingolstadt", "pts_rotterdam_walls"] {
        let cloud = shared.join("data/city").join(scene).join("cloud.ply");
        let read = read_reconstruction(&cloud).unwrap();
        assert_eq!(read.points.len(), 10_000);
        let out = tempfile::tempdir().unwrap().path().join("cloud.ply");
        fs::create_dir_all(out.parent().unwrap()).unwrap();
        write_ply(&out, &read).unwrap();
        assert_eq!(read_reconstruction(&out).unwrap().points, read.points);
    }
}
