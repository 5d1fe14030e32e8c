//! Extensions that say where a surface is, and those that pack it.

use super::*;

/// The square with whole numbers for corners: 16 bits, a stride of 8 bytes.
fn quantized(normalized: bool) -> Scene {
    let mut scene = Scene::changed(|json| {
        json["accessors"][0]["componentType"] = json!(5122);
        json["accessors"][0]["normalized"] = json!(normalized);
        json["bufferViews"][0] = json!({"buffer": 0, "byteLength": 32, "byteStride": 8});
        json["bufferViews"][1]["byteOffset"] = json!(32);
        json["buffers"][0]["byteLength"] = json!(44);
        json["nodes"][0]["scale"] = json!([0.5, 0.5, 0.5]);
        json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    });
    let corners = [[0_i16, 0, 0, 9], [32767, -32768, 0, 9], [4, 6, 0, 9], [0, 6, 0, 9]];
    let bytes = corners.iter().flatten().flat_map(|value| value.to_le_bytes());
    scene.bytes = bytes.chain(scene.bytes[48..].iter().copied()).collect();
    scene
}

#[test]
fn quantized_positions_are_whole_numbers_or_parts_of_one() {
    let part = quantized(false).part();
    assert_eq!(part.positions[..3], [[0.0, 0.0, 0.0], [16383.5, -16384.0, 0.0], [2.0, 3.0, 0.0]]);
    assert_eq!((part.triangles.len(), part.spacing_m), (2, 0.5));
    let part = quantized(true).part();
    assert_eq!(part.positions[1], [0.5, -0.5, 0.0]);
    assert!((part.spacing_m - 0.5 / 32767.0).abs() < 1e-12);
}

#[test]
fn whole_numbers_without_the_extension_are_refused() {
    let mut scene = quantized(false);
    scene.json.as_object_mut().unwrap().remove("extensionsRequired");
    assert!(matches!(scene.read().unwrap_err().problem, GltfProblem::AccessorType { .. }));
    let mut scene = quantized(false);
    scene.json["accessors"][0]["count"] = json!(5);
    assert!(matches!(scene.read().unwrap_err().problem, GltfProblem::BeyondEnd { .. }));
}

#[test]
fn quantized_positions_may_be_sparse() {
    let mut scene = quantized(false);
    scene.bytes.extend([2, 0, 0, 0]);
    scene.bytes.extend([14_i16, 16, 18].iter().flat_map(|value| value.to_le_bytes()));
    scene.json["buffers"][0]["byteLength"] = json!(54);
    let views = scene.json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": 44, "byteLength": 1}));
    views.push(json!({"buffer": 0, "byteOffset": 48, "byteLength": 6}));
    scene.json["accessors"][0]["sparse"] =
        json!({"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3}});
    let part = scene.part();
    assert_eq!(part.positions[2..], [[7.0, 8.0, 9.0], [0.0, 3.0, 0.0]]);
}

#[test]
fn the_center_of_cesium_rtc_is_added_whether_required_or_not() {
    for list in ["extensionsUsed", "extensionsRequired"] {
        let scene = Scene::changed(|json| {
            json[list] = json!(["CESIUM_RTC"]);
            json["extensions"] = json!({"CESIUM_RTC": {"center": [592000.5, 12, -5750000]}});
        });
        let file = scene.read().unwrap();
        assert_eq!(file.center, Some([592000.5, 12.0, -5750000.0]));
        assert_eq!(file.parts[0].positions[2], [592002.5, 15.0, -5750000.0]);
    }
}

/// Two instances: as it is, and twice as large, a quarter about z, at (10, 0, 0).
fn instanced() -> Scene {
    let mut scene = Scene::square();
    let floats = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    scene.bytes.extend(floats(&[0.0, 0.0, 0.0, 10.0, 0.0, 0.0]));
    scene.bytes.extend([0_i16, 0, 0, 32767, 0, 0, 23170, 23170].iter().flat_map(|value| value.to_le_bytes()));
    scene.bytes.extend(floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]));
    scene.json["buffers"][0]["byteLength"] = json!(124);
    let views = scene.json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({"buffer": 0, "byteOffset": 60, "byteLength": 24}));
    views.push(json!({"buffer": 0, "byteOffset": 84, "byteLength": 16}));
    views.push(json!({"buffer": 0, "byteOffset": 100, "byteLength": 24}));
    let accessors = scene.json["accessors"].as_array_mut().unwrap();
    accessors.push(json!({"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}));
    accessors.push(json!({"bufferView": 3, "componentType": 5122, "normalized": true, "count": 2, "type": "VEC4"}));
    accessors.push(json!({"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3"}));
    scene.json["nodes"][0]["translation"] = json!([0, 0, 100]);
    scene.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2, "ROTATION": 3, "SCALE": 4}}});
    scene.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    scene
}

#[test]
fn instances_stand_in_the_frame_of_their_node() {
    let file = instanced().read().unwrap();
    let names: Vec<&str> = file.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["house instance 0", "house instance 1"]);
    assert_eq!(file.parts[0].positions[2], [2.0, 3.0, 100.0]);
    // (2, 3) twice as large is (4, 6), turned (-6, 4), shifted (4, 4).
    let [x, y, z] = file.parts[1].positions[2];
    assert!((x - 4.0).abs() < 1e-9 && (y - 4.0).abs() < 1e-9 && z == 100.0, "{x} {y} {z}");
}

#[test]
fn instances_that_lie_are_refused() {
    for (pointer, value) in [
        ("/accessors/2/count", json!(3)),
        ("/accessors/3/count", json!(1)),
        ("/accessors/2/type", json!("VEC4")),
        ("/accessors/3/componentType", json!(5125)),
        ("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", json!({})),
        ("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/SCALE", json!(99)),
        ("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/SCALE", json!(-1)),
    ] {
        let mut scene = instanced();
        *scene.json.pointer_mut(pointer).unwrap() = value;
        assert!(scene.read().is_err(), "{pointer}");
    }
    // A quaternion of zeros.
    let mut scene = instanced();
    scene.bytes[84..92].fill(0);
    assert!(scene.read().unwrap_err().to_string().contains("length zero"));
    // Zeros that no byte stands for.
    let mut scene = instanced();
    scene.json["accessors"][2].as_object_mut().unwrap().remove("bufferView");
    scene.json["accessors"][2]["count"] = json!(4_000_000_000_u64);
    scene.json["accessors"][2]["sparse"] =
        json!({"count": 1, "indices": {"bufferView": 3, "componentType": 5121}, "values": {"bufferView": 2}});
    scene.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = json!({"TRANSLATION": 2});
    assert!(matches!(scene.read().unwrap_err().problem, GltfProblem::TooLarge { .. }));
}

#[test]
fn meshopt_is_read_where_the_surface_also_stands_unpacked() {
    let packed = |json: &mut Value| {
        json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
        let extension = json!({"buffer": 1, "byteLength": 9, "byteStride": 12, "mode": "ATTRIBUTES", "count": 4});
        json["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": extension});
        json["buffers"].as_array_mut().unwrap().push(json!({"byteLength": 9}));
    };
    assert_eq!(Scene::changed(packed).part().triangles.len(), 2);
    // The fallback without bytes, wherever it stands.
    for index in [0, 1] {
        let scene = Scene::changed(|json| {
            packed(json);
            json["bufferViews"][0]["buffer"] = json!(index);
            json["buffers"][index] =
                json!({"byteLength": 60, "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
        });
        let error = scene.read().unwrap_err();
        assert!(error.to_string().contains("EXT_meshopt_compression"), "{error}");
        assert!(error.to_string().contains("npx @gltf-transform/cli copy"), "{error}");
        assert!(error.place.ends_with(&format!("buffers[{index}]")), "{}", error.place);
    }
}

#[test]
fn draco_is_named_where_nothing_else_of_the_surface_is_there() {
    let scene = Scene::changed(|json| {
        json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
        json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    });
    let error = scene.read().unwrap_err();
    assert!(error.to_string().contains("KHR_draco_mesh_compression"), "{error}");
}

#[test]
fn features_are_told_by_vertex_under_both_names() {
    for (name, component, bytes) in [
        ("_BATCHID", 5126, [0.0_f32, 0.0, 1.0, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>()),
        ("_FEATURE_ID_0", 5123, [0_u16, 0, 1, 1].iter().flat_map(|v| v.to_le_bytes()).collect()),
    ] {
        let mut scene = Scene::square();
        scene.json["buffers"][0]["byteLength"] = json!(60 + bytes.len());
        let view = json!({"buffer": 0, "byteOffset": 60, "byteLength": bytes.len()});
        scene.json["bufferViews"].as_array_mut().unwrap().push(view);
        scene.bytes.extend(bytes);
        let accessor = json!({"bufferView": 2, "componentType": component, "count": 4, "type": "SCALAR"});
        scene.json["accessors"].as_array_mut().unwrap().push(accessor);
        scene.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(2);
        assert_eq!(scene.part().features, [0, 0, 1, 1], "{name}");
        scene.json["accessors"][2]["count"] = json!(3);
        assert!(scene.read().is_err());
    }
    assert_eq!(Scene::square().part().features, [] as [u32; 0]);
}
