use super::super::scene_extent::CITY_MARGIN_M;
use super::*;
use crate::city::{Facet, ObjectId};
use crate::geometry::{Plane, Rotation3, Similarity, Vector3};
use crate::reconstruction::{Image, Reconstruction};

/// A tetrahedron and a lone triangle.
fn city() -> CityModel {
    let vertices = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 2.0], [9.0, 9.0, 1.0]];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [1, 2, 4]];
    let facet = |index: usize, object| Facet {
        holes: Vec::new(),
        kind: None,
        outline: triangles[index].to_vec(),
        plane: Plane { normal: Vector3::z(), offset: 0.0 },
        area: 1.0,
        object: ObjectId(object),
        triangles: index as u32..index as u32 + 1,
    };
    CityModel {
        origin: Vector3::new(678_000.123_456_789, 5_403_400.0, 0.0),
        vertices: vertices.map(Point3::from).to_vec(),
        facets: (0..5).map(|i| facet(i, u32::from(i == 4))).collect(),
        triangles: triangles.clone(),
        objects: vec!["house".into(), "ground".into()],
        ..Default::default()
    }
}

fn reconstruction() -> Reconstruction {
    Reconstruction {
        images: vec![Image {
            name: "a/b.jpg".into(),
            cam_from_sfm_rotation: Rotation3::identity(),
            cam_from_sfm_translation: Vector3::new(0.0, 0.0, 5.0),
            ..Default::default()
        }],
        points: vec![Point3::new(1.0, 2.0, 3.0), Point3::new(1e300, 0.0, 0.0)],
        ..Default::default()
    }
}

fn written(scene: &Scene<'_>) -> (gltf::Gltf, Vec<u8>) {
    let file = tempfile::NamedTempFile::new().unwrap();
    write_scene(file.path(), scene).unwrap();
    let bytes = std::fs::read(file.path()).unwrap();
    (gltf::Gltf::from_slice(&bytes).unwrap(), bytes)
}

fn positions(gltf: &gltf::Gltf, mesh: &str) -> Vec<[f32; 3]> {
    let blob = gltf.blob.as_deref().unwrap();
    let mesh = gltf.meshes().find(|m| m.name() == Some(mesh)).unwrap();
    mesh.primitives().next().unwrap().reader(|_| Some(blob)).read_positions().unwrap().collect()
}

#[test]
fn turns_z_up_into_y_up_relative_to_the_origin() {
    let (city, reconstruction) = (city(), reconstruction());
    let shift = Similarity { translation: city.origin, ..Similarity::identity() };
    let placed =
        Some(Placed { reconstruction: &reconstruction, point_colors: &reconstruction.colors, city_from_sfm: shift });
    let (gltf, _) = written(&Scene { title: "t", city: Some(&city), placed });
    assert_eq!(positions(&gltf, "points"), [[1.0, 3.0, -2.0]]);
    assert_eq!(positions(&gltf, "ground")[2], [9.0, 1.0, -9.0]);
    let camera = gltf.nodes().find(|n| n.name() == Some("a/b.jpg")).unwrap();
    let (translation, [x, y, z, w], _) = camera.transform().decomposed();
    assert_eq!(translation, [0.0, -5.0, 0.0]);
    // The camera looks along city z, which is up: glTF +y.
    let q = crate::geometry::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
    assert!((q * nalgebra::Vector3::z() - nalgebra::Vector3::y()).norm() < 1e-6);
}

#[test]
fn keeps_the_origin_in_full_precision() {
    let city = city();
    let (gltf, bytes) = written(&Scene { title: "t", city: Some(&city), placed: None });
    let extras = gltf.as_json().asset.extras.as_ref().unwrap();
    let extras: serde_json::Value = serde_json::from_str(extras.get()).unwrap();
    assert_eq!(extras["origin"][0].as_f64(), Some(city.origin.x));
    assert_eq!(bytes.len() % 4, 0);
}

#[test]
fn shows_both_sides_only_of_open_surfaces() {
    let (gltf, _) = written(&Scene { title: "t", city: Some(&city()), placed: None });
    let double_sided = |name: &str| {
        let mesh = gltf.meshes().find(|m| m.name() == Some(name)).unwrap();
        mesh.primitives().next().unwrap().material().double_sided()
    };
    assert!(!double_sided("house") && double_sided("ground"));
}

#[test]
fn leaves_out_of_a_large_city_what_is_far_from_the_scene() {
    let city = city();
    let objects_around = |x: f64| {
        let place = Vector3::new(x, 0.0, 0.0);
        let extent = Extent { low: place, high: place };
        facets_by_object(&city, Some(&extent)).keys().copied().collect::<Vec<_>>()
    };
    // The house reaches from 0 to 4 m, the ground from 0 to 9 m.
    assert_eq!(objects_around(0.0), [0, 1]);
    assert_eq!(objects_around(CITY_MARGIN_M + 5.0), [1]);
    assert!(objects_around(CITY_MARGIN_M + 10.0).is_empty());
}

#[test]
fn writes_a_scene_without_anything_in_it() {
    let (gltf, _) = written(&Scene { title: "nothing", city: None, placed: None });
    assert_eq!(gltf.scenes().next().unwrap().nodes().next().unwrap().name(), Some("nothing"));
    assert!(gltf.blob.is_none());
}

#[test]
fn turns_srgb_into_linear_light() {
    assert_eq!(linear([0, 255, 188]), [0, 65535, 32957, 65535]);
    assert_eq!(linear([10, 11, 0])[..2], [199, 219]);
}
