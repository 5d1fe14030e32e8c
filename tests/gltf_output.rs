//! Every GLB that the program writes, put before the Khronos validator.

mod needs;

use std::path::{Path, PathBuf};

use cityweld::internals::{GltfScene as Scene, Placed, city_planes, write_scene};
use cityweld::output::write_planes_glb;
use cityweld::{CityModel, CityOptions, Reconstruction, read_city, read_reconstruction, read_start};
use needs::gltf_validator;

const SCRIPT: &str = "
const validator = require('gltf-validator');
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[1]));
validator.validateBytes(bytes, { maxIssues: 20 }).then((report) => {
  console.log(JSON.stringify(report.issues));
  process.exit(report.issues.numErrors + report.issues.numWarnings > 0 ? 1 : 0);
}, (error) => { console.log(String(error)); process.exit(1); });
";

fn assert_valid(path: &Path) {
    let output = gltf_validator().unwrap().arg("-e").arg(SCRIPT).arg(path).output().unwrap();
    assert!(output.status.success(), "{}: {}", path.display(), String::from_utf8_lossy(&output.stdout));
}

fn sample(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample").join(path)
}

fn sample_city() -> CityModel {
    read_city(&sample("city.obj"), &[], &CityOptions::default()).unwrap()
}

#[test]
fn the_scene_of_the_sample_is_valid() {
    if gltf_validator().is_none() {
        return;
    }
    let city = sample_city();
    let mut reconstruction = read_reconstruction(&sample("sfm")).unwrap();
    let city_from_sfm = *read_start(&sample("start.json")).unwrap().city_from_sfm();
    let room = tempfile::tempdir().unwrap();
    let path = room.path().join("scene.glb");
    let write = |reconstruction: &Reconstruction| {
        let placed = Some(Placed { reconstruction, point_colors: &reconstruction.colors, city_from_sfm });
        write_scene(
            &path,
            &Scene { title: "best candidate, NOT aligned: \"quoted\" \u{2713}", city: Some(&city), placed },
        )
    };
    write(&reconstruction).unwrap();
    assert_valid(&path);
    reconstruction.colors.clear();
    reconstruction.images.clear();
    write(&reconstruction).unwrap();
    assert_valid(&path);
}

#[test]
fn scenes_with_little_in_them_are_valid() {
    if gltf_validator().is_none() {
        return;
    }
    let room = tempfile::tempdir().unwrap();
    let path = room.path().join("scene.glb");
    for city in [sample_city(), CityModel::default()] {
        write_scene(&path, &Scene { title: "city alone", city: Some(&city), placed: None }).unwrap();
        assert_valid(&path);
    }
}

#[test]
fn the_city_colored_by_plane_is_valid() {
    if gltf_validator().is_none() {
        return;
    }
    let room = tempfile::tempdir().unwrap();
    let path = room.path().join("planes.glb");
    let city = sample_city();
    write_planes_glb(&path, &city, &city_planes(&city)).unwrap();
    assert_valid(&path);
}
