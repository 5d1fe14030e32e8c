//! What is refused, with its place and a remedy.

use super::*;

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
    let none = extensions::Extensions::default();
    let mut buffers = Buffers::new(None, folder.path(), &none);
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
    for (name, remedy) in [("KHR_draco_mesh_compression", "@gltf-transform/cli copy"), ("VENDOR_sphere", "without it")]
    {
        let (place, problem) = refused(|json| json["extensionsRequired"] = json!([name]));
        assert_eq!(place, "extensionsRequired");
        assert!(problem.to_string().contains(name) && problem.to_string().contains(remedy), "{problem}");
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
