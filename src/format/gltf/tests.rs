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

/// Reads what must be refused, and returns where and what.
fn refused(change: impl FnOnce(&mut Value)) -> (String, GltfProblem) {
    let error = Scene::changed(change).read().unwrap_err();
    (error.place, error.problem)
}

#[test]
fn refuses_accessors_that_lie() {
    for count in [5_u64, 100, 1 << 32, 1 << 60, u64::MAX, u64::MAX / 12 + 1] {
        let (place, problem) = refused(|json| json["accessors"][0]["count"] = json!(count));
        assert_eq!(place, "accessors[0], bufferViews[0]");
        assert!(matches!(problem, GltfProblem::BeyondEnd { available: 48, .. }), "{count}: {problem}");
    }
    for (pointer, value) in [
        ("/accessors/0/count", json!(0)),
        ("/accessors/0/byteOffset", json!(8)),
        ("/accessors/0/byteOffset", json!(u64::MAX)),
        ("/accessors/0/type", json!("VEC2")),
        ("/accessors/0/type", json!("VEC9")),
        ("/accessors/0/componentType", json!(5123)),
        ("/accessors/0/componentType", json!(5130)),
        ("/accessors/1/componentType", json!(5126)),
        ("/accessors/1/type", json!("VEC3")),
        ("/bufferViews/0/byteStride", json!(4)),
        ("/bufferViews/0/byteStride", json!(0)),
        ("/bufferViews/0/byteLength", json!(u64::MAX)),
        ("/bufferViews/0/byteOffset", json!(u64::MAX)),
        ("/bufferViews/0/byteOffset", json!(13)),
        ("/bufferViews/0/buffer", json!(7)),
        ("/buffers/0/byteLength", json!(4_000_000_000_u64)),
        ("/accessors/0/bufferView", json!(7)),
        ("/accessors/0/bufferView", json!(4_294_967_296_u64)),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(7)),
        ("/meshes/0/primitives/0/indices", json!(7)),
        ("/meshes/0/primitives/0/mode", json!(9)),
        ("/nodes/0/mesh", json!(3)),
        ("/scenes/0/nodes/0", json!(3)),
    ] {
        let scene = Scene::changed(|json| match json.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => {
                let (parent, key) = pointer.rsplit_once('/').unwrap();
                json.pointer_mut(parent).unwrap()[key] = value.clone();
            }
        });
        let error = scene.read().expect_err(pointer);
        assert!(!error.place.is_empty(), "{pointer} {value}: {error}");
    }
}

#[test]
fn refuses_sparse_accessors_that_lie() {
    let mut scene = sparse(true);
    scene.bytes[60] = 4;
    assert!(scene.read().unwrap_err().to_string().contains("sparse index 4"));
    for (pointer, value) in [
        ("/accessors/0/sparse/count", json!(0)),
        ("/accessors/0/sparse/count", json!(4_000_000_000_u64)),
        ("/accessors/0/sparse/values/bufferView", json!(9)),
        ("/accessors/0/sparse/indices/bufferView", json!(9)),
        ("/accessors/0/sparse/indices/componentType", json!(5126)),
    ] {
        let mut scene = sparse(true);
        *scene.json.pointer_mut(pointer).unwrap() = value;
        assert!(scene.read().is_err(), "{pointer}");
    }
    let mut endless = sparse(false);
    endless.json["accessors"][0]["count"] = json!(4_000_000_000_u64);
    assert!(matches!(endless.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
}

#[test]
fn refuses_indices_beyond_the_vertices() {
    let error = Scene::with_indices(5121, 3, &[0, 1, 4]).read().unwrap_err();
    assert_eq!(error.problem, GltfProblem::IndexOutOfRange { index: 4, vertices: 4 });
    assert_eq!((error.place.as_str(), error.object.as_deref()), ("meshes[0].primitives[0]", Some("house")));
}

#[test]
fn refuses_vertices_that_are_no_places() {
    for value in [f32::NAN, f32::INFINITY, 1e10] {
        let mut scene = Scene::square();
        scene.bytes[12..16].copy_from_slice(&value.to_le_bytes());
        assert!(matches!(scene.read().unwrap_err().problem, GltfProblem::OutOfReach { vertex: 1, .. }));
    }
    let (_, problem) = refused(|json| json["nodes"][0]["translation"] = json!([1e12, 0, 0]));
    assert!(matches!(problem, GltfProblem::OutOfReach { vertex: 0, .. }));
    refused(|json| json["nodes"][0]["translation"] = json!([1e39, 0, 0]));
}

#[test]
fn refuses_nodes_that_are_no_tree() {
    let (place, problem) = refused(|json| json["nodes"][0]["children"] = json!([0]));
    assert_eq!(place, "nodes[0]");
    assert!(matches!(problem, GltfProblem::Invalid { .. }));
    refused(|json| json["nodes"] = json!([{"children": [1, 1]}, {"mesh": 0}]));
    refused(|json| json["nodes"] = json!([{"children": [1]}, {"children": [0], "mesh": 0}]));
    refused(|json| json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]));
    refused(|json| json["nodes"][0]["matrix"] = json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]));
}

#[test]
fn a_small_file_that_shows_one_mesh_too_often_is_refused() {
    let scene = Scene::changed(|json| {
        // A million vertices of a few bytes, as any number of corners may share them.
        json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 0}
        });
        json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        json["accessors"][0]["count"] = json!(1_000_000);
        json["scenes"][0]["nodes"] = (0..100).collect();
        json["nodes"] = (0..100).map(|_| json!({"mesh": 0})).collect();
    });
    assert!(matches!(scene.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
}

/// `count` zeros as corners, but for the first.
fn zeros(count: u64) -> Scene {
    Scene::changed(|json| {
        json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 0}
        });
        json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        json["accessors"][0]["count"] = json!(count);
    })
}

#[test]
fn a_count_is_bounded_by_the_bytes_that_are_there() {
    assert!(zeros(60_000).read().is_ok());
    for count in [1 << 17, 1 << 24, 1 << 26, 1 << 40, u64::MAX] {
        let error = zeros(count).read().unwrap_err();
        assert!(matches!(error.problem, GltfProblem::TooLarge { .. }), "{count}: {error}");
    }
    let mut of_indices = zeros(4);
    of_indices.json["accessors"][1] = of_indices.json["accessors"][0].clone();
    of_indices.json["accessors"][1]["type"] = json!("SCALAR");
    of_indices.json["accessors"][1]["componentType"] = json!(5125);
    of_indices.json["accessors"][1]["count"] = json!(1 << 30);
    assert!(matches!(of_indices.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
}

#[test]
fn a_count_times_nodes_or_primitives_is_bounded_by_the_bytes_that_are_there() {
    let mut nodes = zeros(20_000);
    nodes.json["scenes"][0]["nodes"] = (0..1000).collect();
    nodes.json["nodes"] = (0..1000).map(|_| json!({"mesh": 0})).collect();
    assert!(matches!(nodes.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
    let mut primitives = zeros(20_000);
    let primitive = primitives.json["meshes"][0]["primitives"][0].clone();
    primitives.json["meshes"][0]["primitives"] = (0..1000).map(|_| primitive.clone()).collect();
    assert!(matches!(primitives.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
}

#[test]
fn a_name_times_nodes_is_bounded_by_the_bytes_that_are_there() {
    let scene = Scene::changed(|json| {
        json["meshes"][0]["name"] = json!("n".repeat(1 << 20));
        json["scenes"][0]["nodes"] = (0..3000).collect();
        json["nodes"] = (0..3000).map(|_| json!({"mesh": 0})).collect();
    });
    assert!(matches!(scene.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
}

#[test]
fn a_file_that_many_buffers_name_is_held_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.bin"), vec![0; 1 << 16]).unwrap();
    let mut buffers = Buffers::new(None, folder.path());
    for index in 0..1000 {
        let uri = format!("{}a.bin", "./".repeat(index % 7));
        let buffer = serde_json::from_value(json!({"byteLength": 1 + 60 * index, "uri": uri})).unwrap();
        buffers.load(index, &buffer).unwrap();
        assert!(buffers.bytes(index).unwrap().len() > 60 * index);
    }
    assert!(buffers.bytes_beside() <= 2 << 16, "{}", buffers.bytes_beside());
}

#[cfg(unix)]
#[test]
fn a_buffer_that_is_a_pipe_or_a_device_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("device")).unwrap();
    for name in ["pipe", "device"] {
        let scene = Scene::changed(|json| json["buffers"][0]["uri"] = json!(name));
        let error = read_gltf(scene.json.to_string().as_bytes(), folder.path()).unwrap_err();
        assert!(error.to_string().contains(&format!("a {name}")), "{error}");
    }
}

#[test]
fn a_scene_that_does_not_exist_is_refused() {
    let (place, problem) = refused(|json| json["scene"] = json!(7));
    assert_eq!((place.as_str(), problem), ("scene", GltfProblem::Missing { what: "scene", index: 7, count: 1 }));
}

#[test]
fn what_would_steer_a_terminal_is_written_out_in_messages() {
    let (_, problem) = refused(|json| json["extensionsRequired"] = json!(["\u{1b}[2J"]));
    assert!(problem.to_string().contains("\\u{1b}[2J"), "{problem}");
    let (_, problem) = refused(|json| json["buffers"][0]["uri"] = json!("\u{1b}[2J.bin"));
    assert!(problem.to_string().contains("\\u{1b}[2J"), "{problem}");
}

#[test]
fn needed_extensions_are_named_with_a_remedy() {
    for name in ["KHR_draco_mesh_compression", "KHR_mesh_quantization", "EXT_meshopt_compression", "CESIUM_RTC"] {
        let (place, problem) = refused(|json| json["extensionsRequired"] = json!([name]));
        assert_eq!(place, "extensionsRequired");
        assert!(problem.to_string().contains(name));
    }
    let scene = Scene::changed(|json| json["extensionsRequired"] = json!(["KHR_materials_unlit"]));
    assert_eq!(scene.part().triangles.len(), 2);
}

#[test]
fn what_only_concerns_looks_may_be_wrong() {
    let scene = Scene::changed(|json| {
        json["accessors"][0].as_object_mut().unwrap().remove("min");
        json["accessors"][0].as_object_mut().unwrap().remove("max");
        json["meshes"][0]["primitives"][0]["material"] = json!(5);
        json["meshes"][0]["primitives"][0]["attributes"]["ODD"] = json!(0);
        json["textures"] = json!([{"source": 9}]);
    });
    assert_eq!(scene.part().triangles.len(), 2);
}

#[test]
fn says_at_which_byte_a_glb_ends_too_early() {
    let whole = Scene::square().glb();
    for length in 4..whole.len() {
        let error = read_gltf(&whole[..length], Path::new(".")).unwrap_err();
        assert!(error.place.starts_with("byte "), "{length}: {error} ({})", error.place);
    }
    for (at, byte) in [(8, "byte 8"), (12, "byte 12")] {
        let mut lying = whole.clone();
        lying[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = read_gltf(&lying, Path::new(".")).unwrap_err();
        assert_eq!(error.place, byte);
        assert!(matches!(error.problem, GltfProblem::Truncated { .. }));
    }
    let mut old = whole.clone();
    old[4] = 1;
    assert_eq!(read_gltf(&old, Path::new(".")).unwrap_err().problem, GltfProblem::Version { found: "1".to_owned() });
    let with_tail = [whole.as_slice(), b"tail"].concat();
    assert!(read_gltf(&with_tail, Path::new(".")).is_ok());
}

#[test]
fn says_where_the_json_is_broken() {
    let error = read_gltf(b"{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [}\n", Path::new(".")).unwrap_err();
    assert_eq!(error.place, "JSON line 3 column 13");
    let error = read_gltf(b"{\"asset\": {\"version\": \"1.0\"}}", Path::new(".")).unwrap_err();
    assert_eq!(error.problem, GltfProblem::Version { found: "1.0".to_owned() });
    let deep = format!("{{\"asset\": {}", "[".repeat(100_000));
    assert!(read_gltf(deep.as_bytes(), Path::new(".")).is_err());
}
