mod extensions_read;
mod refusals;

use base64::Engine;
use serde_json::{Value, json};

use std::path::Path;

use super::buffers::Buffers;
use super::*;

/// A scene with one mesh of one primitive: the bytes of one buffer, and JSON that tests may change.
struct Scene {
    json: Value,
    bytes: Vec<u8>,
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 0.0]];

impl Scene {
    /// Four corners, indices 0 1 2 0 2 3 as u16.
    fn square() -> Scene {
        let mut bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "house", "mesh": 0}],
            "meshes": [{"name": "mesh", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [2, 3, 0]},
                {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": 48},
                {"buffer": 0, "byteOffset": 48, "byteLength": 12}
            ],
            "buffers": [{"byteLength": 60}]
        });
        Scene { json, bytes }
    }

    fn changed(change: impl FnOnce(&mut Value)) -> Scene {
        let mut scene = Scene::square();
        change(&mut scene.json);
        scene
    }

    /// Replaces the indices, which stand behind the corners.
    fn with_indices(component_type: u32, count: usize, indices: &[u8]) -> Scene {
        let mut scene = Scene::changed(|json| {
            json["accessors"][1]["componentType"] = json!(component_type);
            json["accessors"][1]["count"] = json!(count);
            json["bufferViews"][1]["byteLength"] = json!(indices.len());
            json["buffers"][0]["byteLength"] = json!(48 + indices.len());
        });
        scene.bytes.truncate(48);
        scene.bytes.extend(indices);
        scene
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = self.bytes.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let word = |value: usize| (value as u32).to_le_bytes();
        let length = 12 + 8 + json.len() + 8 + binary.len();
        let header = [b"glTF".as_slice(), &word(2), &word(length)].concat();
        [&header, &word(json.len())[..], b"JSON", &json, &word(binary.len()), b"BIN\0", &binary].concat()
    }

    fn read(&self) -> Result<GltfFile, GltfError> {
        read_gltf(&self.glb(), Path::new("."))
    }

    fn part(&self) -> GltfPart {
        let mut file = self.read().unwrap_or_else(|error| panic!("{error} ({})", error.place));
        assert_eq!(file.parts.len(), 1);
        file.parts.remove(0)
    }
}

fn places(part: &GltfPart) -> Vec<[f64; 3]> {
    part.triangles.iter().flatten().map(|&at| part.positions[at as usize]).collect()
}

#[test]
fn reads_triangles_with_the_name_of_their_node() {
    let part = Scene::square().part();
    assert_eq!(part.name, "house");
    assert_eq!(part.positions, CORNERS.map(|corner| corner.map(f64::from)));
    assert_eq!(part.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn a_node_without_name_is_called_after_its_mesh_or_its_number() {
    let scene = Scene::changed(|json| json["nodes"][0] = json!({"mesh": 0}));
    assert_eq!(scene.part().name, "mesh");
    let scene = Scene::changed(|json| {
        json["nodes"][0] = json!({"mesh": 0});
        json["meshes"][0]["name"] = Value::Null;
    });
    assert_eq!(scene.part().name, "node 0");
}

#[test]
fn node_transforms_keep_every_bit_of_f64() {
    let scene = Scene::changed(|json| {
        json["scenes"][0]["nodes"] = json!([1]);
        json["nodes"] = json!([
            {"mesh": 0, "translation": [0.125, 0, 0]},
            {"children": [0], "translation": [450000.1234567, 12.5, -5500000.456]}
        ]);
    });
    assert_eq!(scene.part().positions[0], [450000.1234567 + 0.125, 12.5, -5500000.456]);
}

#[test]
fn matrices_and_their_parts_mean_the_same() {
    let half = 0.5_f64.sqrt();
    let parts = json!({"mesh": 0, "translation": [10, 20, 30], "rotation": [0, 0, half, half], "scale": [2, 3, 4]});
    // Column by column: a quarter turn about z after the stretch.
    let matrix = json!({"mesh": 0, "matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 10, 20, 30, 1]});
    for node in [parts, matrix] {
        let part = Scene::changed(|json| json["nodes"][0] = node).part();
        for (found, expected) in part.positions.iter().zip([[10.0, 20.0], [10.0, 24.0], [1.0, 24.0], [1.0, 20.0]]) {
            let [x, y] = expected;
            assert!((found[0] - x).abs() < 1e-12 && (found[1] - y).abs() < 1e-12 && found[2] == 30.0, "{found:?}");
        }
    }
}

#[test]
fn a_mirroring_node_keeps_the_outer_side_outside() {
    let part = Scene::changed(|json| json["nodes"][0]["scale"] = json!([-1, 1, 1])).part();
    assert_eq!(part.triangles, [[0, 2, 1], [0, 3, 2]]);
}

#[test]
fn reads_indices_of_every_type_and_none() {
    let expected = places(&Scene::square().part());
    assert_eq!(places(&Scene::with_indices(5121, 6, &[0, 1, 2, 0, 2, 3]).part()), expected);
    let words: Vec<u8> = [0_u32, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()).collect();
    assert_eq!(places(&Scene::with_indices(5125, 6, &words).part()), expected);
    let scene = Scene::changed(|json| {
        json["meshes"][0]["primitives"][0] = json!({"attributes": {"POSITION": 0}});
    });
    assert_eq!(scene.part().triangles, [[0, 1, 2]]);
}

#[test]
fn strips_and_fans_keep_the_winding_of_their_first_triangle() {
    let with_mode = |mode: u32, indices: &[u8]| {
        let mut scene = Scene::with_indices(5121, indices.len(), indices);
        scene.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        scene.part().triangles
    };
    assert_eq!(with_mode(5, &[0, 1, 3, 2]), [[0, 1, 3], [3, 1, 2]]);
    assert_eq!(with_mode(6, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(with_mode(5, &[0, 1, 3, 3, 2, 2]), [[0, 1, 3]], "triangles that only join strips are none");
    assert_eq!(with_mode(4, &[0, 1, 2, 0, 2]), [[0, 1, 2]], "corners left over are no triangle");
}

#[test]
fn points_and_lines_are_counted_and_passed_over() {
    let scene = Scene::changed(|json| {
        json["meshes"][0]["primitives"] = json!([
            {"attributes": {"POSITION": 0}, "mode": 0},
            {"attributes": {"POSITION": 0}, "mode": 1},
            {"attributes": {"POSITION": 0}, "indices": 1}
        ]);
    });
    let file = scene.read().unwrap();
    assert_eq!((file.without_surface, file.first_without_surface.as_deref()), (2, Some("house")));
    assert_eq!(file.parts[0].triangles.len(), 2);
}

#[test]
fn reads_interleaved_vertices() {
    let mut scene = Scene::square();
    let corners =
        CORNERS.iter().flat_map(|corner| corner.iter().chain(&[9.0, 9.0]).flat_map(|value| value.to_le_bytes()));
    scene.bytes = corners.collect();
    scene.json["bufferViews"] = json!([{"buffer": 0, "byteLength": 80, "byteStride": 20}]);
    scene.json["accessors"].as_array_mut().unwrap().truncate(1);
    scene.json["meshes"][0]["primitives"][0] = json!({"attributes": {"POSITION": 0}, "mode": 6});
    scene.json["buffers"][0]["byteLength"] = json!(80);
    assert_eq!(scene.part().positions, CORNERS.map(|corner| corner.map(f64::from)));
}

/// Moves the third corner to (7, 8, 9) by a sparse accessor.
fn sparse(base: bool) -> Scene {
    let mut scene = Scene::square();
    scene.bytes.push(2);
    scene.bytes.extend([0; 3]);
    scene.bytes.extend([7.0_f32, 8.0, 9.0].iter().flat_map(|value| value.to_le_bytes()));
    scene.json["buffers"][0]["byteLength"] = json!(76);
    let views = scene.json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": 60, "byteLength": 1}));
    views.push(json!({"buffer": 0, "byteOffset": 64, "byteLength": 12}));
    let accessor = &mut scene.json["accessors"][0];
    accessor["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": 2, "componentType": 5121},
        "values": {"bufferView": 3}
    });
    if !base {
        accessor.as_object_mut().unwrap().remove("bufferView");
    }
    scene
}

#[test]
fn reads_sparse_accessors_with_and_without_a_base() {
    let part = sparse(true).part();
    assert_eq!(part.positions[2], [7.0, 8.0, 9.0]);
    assert_eq!(part.positions[3], [0.0, 3.0, 0.0]);
    let part = sparse(false).part();
    assert_eq!(part.positions, [[0.0; 3], [0.0; 3], [7.0, 8.0, 9.0], [0.0; 3]]);
}

#[test]
fn every_node_of_the_shown_scene_is_a_part_of_its_own() {
    let scene = Scene::changed(|json| {
        json["scene"] = json!(1);
        json["scenes"] = json!([{"nodes": [0]}, {"nodes": [2, 1]}]);
        json["nodes"] = json!([
            {"name": "hidden", "mesh": 0},
            {"name": "first", "mesh": 0},
            {"name": "second", "children": [3, 4]},
            {"name": "third", "mesh": 0},
            {"name": "fourth", "mesh": 0}
        ]);
    });
    let names: Vec<String> = scene.read().unwrap().parts.into_iter().map(|part| part.name).collect();
    assert_eq!(names, ["third", "fourth", "first"]);
}

#[test]
fn without_a_scene_the_roots_are_shown_and_without_nodes_the_meshes() {
    let scene = Scene::changed(|json| {
        json.as_object_mut().unwrap().remove("scene");
        json.as_object_mut().unwrap().remove("scenes");
        json["nodes"] =
            json!([{"name": "child", "mesh": 0}, {"name": "root", "children": [0], "translation": [1, 0, 0]}]);
    });
    assert_eq!(scene.part().positions[0], [1.0, 0.0, 0.0]);
    let scene = Scene::changed(|json| {
        json.as_object_mut().unwrap().remove("scene");
        json.as_object_mut().unwrap().remove("scenes");
        json.as_object_mut().unwrap().remove("nodes");
    });
    assert_eq!(scene.part().name, "mesh");
}

#[test]
fn reads_buffers_from_data_uris_and_from_files_beside() {
    let scene = Scene::square();
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("with space")).unwrap();
    std::fs::write(folder.path().join("with space/city.bin"), &scene.bytes).unwrap();
    let data = base64::engine::general_purpose::STANDARD_NO_PAD.encode(&scene.bytes);
    for uri in [format!("data:application/octet-stream;base64,{data}"), "with%20space/./city.bin".to_owned()] {
        let mut json = scene.json.clone();
        json["buffers"][0]["uri"] = json!(uri);
        let file = read_gltf(json.to_string().as_bytes(), folder.path()).unwrap();
        assert_eq!(file.parts[0], scene.part());
    }
}

#[test]
fn refuses_buffers_outside_the_folder() {
    for uri in [
        "../city.bin",
        "%2e%2e/city.bin",
        "a/../../city.bin",
        "/etc/hostname",
        "file:///etc/hostname",
        "http://example.org/city.bin",
        "C:\\city.bin",
        "..\\city.bin",
        "",
        "a%00b",
        "%ff%fe.bin",
        "data:,abc",
        "data:application/octet-stream;base64,@@@",
        "not there.bin",
    ] {
        let scene = Scene::changed(|json| json["buffers"][0]["uri"] = json!(uri));
        let error = scene.read().unwrap_err();
        assert!(matches!(error.problem, GltfProblem::Buffer { .. }), "{uri}: {error}");
        assert_eq!(error.place.split(", ").last(), Some("buffers[0]"));
    }
}
