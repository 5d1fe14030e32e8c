//! Every GLB that the program writes, put before the Khronos validator, and read again.

mod needs;

use std::collections::BTreeMap;
use std::fs;
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

/// What a GLB says of where its coordinates count from.
fn origin_of(path: &Path) -> [f64; 3] {
    let bytes = fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    serde_json::from_value(json["asset"]["extras"]["origin"].clone()).unwrap()
}

/// Area and box of each object, absolute.
fn objects(city: &CityModel) -> BTreeMap<String, (f64, [[f64; 3]; 2])> {
    let mut found = BTreeMap::new();
    for facet in &city.facets {
        let empty = (0.0, [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]);
        let object = found.entry(city.object_name(facet.object).to_owned()).or_insert(empty);
        object.0 += facet.area;
        for corner in city.triangles_of(facet).flatten() {
            for k in 0..3 {
                let value = corner[k] + city.origin[k];
                object.1[0][k] = object.1[0][k].min(value);
                object.1[1][k] = object.1[1][k].max(value);
            }
        }
    }
    found
}

/// The sample at the coordinates of a national grid.
fn far_city(room: &Path) -> CityModel {
    let options = CityOptions::default().with_origin([92_000.0, 437_000.0, -3.5]);
    let path = room.join("city.obj");
    fs::copy(sample("city.obj"), &path).unwrap();
    read_city(&path, &[], &options).unwrap()
}

#[test]
fn a_city_that_is_written_and_read_with_its_origin_is_where_it_was() {
    let room = tempfile::tempdir().unwrap();
    let [scene, planes] = ["scene.glb", "planes.glb"].map(|name| room.path().join(name));
    for city in [sample_city(), far_city(room.path())] {
        write_scene(&scene, &Scene { title: "city alone", city: Some(&city), placed: None }).unwrap();
        write_planes_glb(&planes, &city, &city_planes(&city)).unwrap();
        let before = objects(&city);
        for path in [&scene, &planes] {
            let options = CityOptions::default().with_origin(origin_of(path));
            let after = objects(&read_city(path, &[], &options).unwrap());
            assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>(), "{}", path.display());
            for ((name, (area, corners)), (found_area, found)) in before.iter().zip(after.values()) {
                // Single precision a few hundred metres from the origin.
                assert!((area - found_area).abs() < 1e-3 * area + 1e-3, "{name}: {found_area} m2, was {area}");
                for (found, corner) in found.as_flattened().iter().zip(corners.as_flattened()) {
                    assert!((found - corner).abs() < 1e-4, "{name}: {found}, was {corner}");
                }
            }
        }
    }
}

#[test]
fn points_that_are_written_into_a_scene_stand_where_their_pose_puts_them() {
    let room = tempfile::tempdir().unwrap();
    let path = room.path().join("scene.glb");
    let city = far_city(room.path());
    let reconstruction = read_reconstruction(&sample("sfm")).unwrap();
    let mut city_from_sfm = *read_start(&sample("start.json")).unwrap().city_from_sfm();
    city_from_sfm.translation += cityweld::Vector3::new(92_000.0, 437_000.0, -3.5);
    let placed = Some(Placed { reconstruction: &reconstruction, point_colors: &reconstruction.colors, city_from_sfm });
    write_scene(&path, &Scene { title: "placed", city: Some(&city), placed }).unwrap();
    let origin = cityweld::Vector3::from(origin_of(&path));
    let file = gltf::Gltf::open(&path).unwrap();
    let points = file.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>());
    let points: Vec<_> = points.filter(|part| part.mode() == gltf::mesh::Mode::Points).collect();
    let read = points.iter().flat_map(|part| {
        let reader = part.reader(|_| file.blob.as_deref());
        reader.read_positions().unwrap().collect::<Vec<_>>()
    });
    // y is up, and z comes towards whoever looks north.
    let read: Vec<_> =
        read.map(|[x, y, z]| cityweld::Point3::new(x.into(), -f64::from(z), y.into()) + origin).collect();
    assert!(read.len() > 1000, "{} points", read.len());
    let expected: Vec<_> = reconstruction.points.iter().map(|point| city_from_sfm.apply(point)).collect();
    for point in read.iter().step_by(97) {
        let nearest = expected.iter().map(|other| (other - point).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 2e-3, "{point} is {nearest} m from any point of the reconstruction");
    }
}
