use std::path::Path;

use serde_json::{Value, json};

use super::*;
use crate::format::surface_error::SurfaceError;
use crate::format::tests::{assert_sound, extent, rings};

/// One triangle (0 0 0, 1 0 0, 0 1 0) with y up and two features, as glTF JSON by itself.
fn gltf(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    use base64::Engine;
    let floats: Vec<u8> = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let data = base64::engine::general_purpose::STANDARD.encode(floats);
    let mut json = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "_BATCHID": 1}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR"}
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
        "buffers": [{"byteLength": 48, "uri": format!("data:application/octet-stream;base64,{data}")}]
    });
    change(&mut json);
    json.to_string().into_bytes()
}

fn b3dm(feature_table: &str, feature_bytes: &[u8], batch_table: &str, model: &[u8]) -> Vec<u8> {
    let word = |value: usize| (value as u32).to_le_bytes();
    let length = 28 + feature_table.len() + feature_bytes.len() + batch_table.len() + model.len();
    let lengths = [length, feature_table.len(), feature_bytes.len(), batch_table.len(), 0].map(word).concat();
    let tables = [feature_table.as_bytes(), feature_bytes, batch_table.as_bytes()].concat();
    [b"b3dm".as_slice(), &word(1), &lengths, &tables, model].concat()
}

fn read_one(bytes: &[u8]) -> Result<TilesetFile, SurfaceError> {
    read_tile(bytes, Path::new("house.b3dm")).inspect(|file| assert_sound(&file.surfaces))
}

/// A folder of files; JSON is written as such.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.gltf"), gltf(|_| {})).unwrap();
        Folder(folder)
    }

    fn with(self, name: &str, root: Value) -> Folder {
        self.with_text(name, &json!({"asset": {"version": "1.1"}, "geometricError": 9, "root": root}).to_string())
    }

    fn with_text(self, name: &str, text: &str) -> Folder {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
        self
    }

    fn read(&self) -> Result<TilesetFile, SurfaceError> {
        read_tileset(&self.0.path().join("tileset.json")).inspect(|file| assert_sound(&file.surfaces))
    }

    fn refused(&self) -> String {
        let error = self.read().unwrap_err();
        format!("{error} ({})", error.place_in(Path::new("tileset.json")))
    }
}

/// Lowest corner of each triangle: where its tile stands.
fn places(file: &TilesetFile) -> Vec<[f64; 3]> {
    (0..file.surfaces.surfaces.len()).map(|at| rings(&file.surfaces, at)[0][0]).collect()
}

fn shifted(x: f64) -> Value {
    json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1])
}

#[test]
fn a_batched_model_is_turned_upright_and_moved_to_its_center() {
    let by_numbers = (r#"{"BATCH_LENGTH":2,"RTC_CENTER":[10,20,30]}  "#, vec![]);
    let bytes = [0.0_f32, 10.0, 20.0, 30.0].iter().flat_map(|value| value.to_le_bytes()).collect();
    let by_bytes = (r#"{"BATCH_LENGTH":2,"RTC_CENTER":{"byteOffset":4}}"#, bytes);
    for (table, bytes) in [by_numbers, by_bytes] {
        let file = read_one(&b3dm(table, &bytes, r#"{"id":["first","second"]}"#, &gltf(|_| {}))).unwrap();
        assert_eq!(rings(&file.surfaces, 0), [[[10.0, 20.0, 30.0], [11.0, 20.0, 30.0], [10.0, 20.0, 31.0]]]);
        assert_eq!(file.surfaces.objects[0].id, "second");
        assert_eq!(file.local_from_ecef, None);
    }
    let file = read_one(&b3dm("", &[], "", &gltf(|_| {}))).unwrap();
    assert_eq!((places(&file), file.surfaces.objects[0].id.as_str()), (vec![[0.0; 3]], "house.b3dm feature 1"));
}

#[test]
fn cesium_rtc_within_a_tile_is_in_the_axes_of_the_tile() {
    let model = gltf(|json| json["extensions"] = json!({"CESIUM_RTC": {"center": [100, 200, 300]}}));
    let file = read_one(&b3dm("", &[], "", &model)).unwrap();
    assert_eq!(rings(&file.surfaces, 0)[0][2], [100.0, 200.0, 301.0]);
}

#[test]
fn composite_tiles_are_taken_apart() {
    let word = |value: usize| (value as u32).to_le_bytes();
    let inner = [b3dm("", &[], "", &gltf(|_| {})), [b"pnts".as_slice(), &word(1), &word(12)].concat()];
    let composite = |parts: &[u8], count: usize| {
        [b"cmpt".as_slice(), &word(1), &word(16 + parts.len()), &word(count), parts].concat()
    };
    let once = composite(&inner.concat(), 2);
    let file = read_one(&composite(&[once.clone(), inner[0].clone()].concat(), 2)).unwrap();
    assert_eq!(file.surfaces.surfaces.len(), 2);
    assert_eq!((file.surfaces.skipped[0].what, file.surfaces.skipped[0].count), ("tiles of points (pnts)", 1));
    assert!(read_one(&composite(&inner.concat(), 4_000_000_000)).unwrap_err().to_string().contains("cut off"));
    let deep = (0..9).fold(once, |inner, _| composite(&inner, 1));
    assert!(read_one(&deep).unwrap_err().to_string().contains("composite"));
}

#[test]
fn tiles_that_are_none_or_of_other_kinds_are_named() {
    let good = b3dm("{}", &[], "", &gltf(|_| {}));
    let with = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    for (bytes, expected) in [
        (with(4, 2), "version 2"),
        (with(8, 1 << 20), "cut off"),
        (with(12, u32::MAX), "cut off"),
        (with(24, 0x2222_2222), "draft"),
        (b"i3dm...".to_vec(), "i3dm"),
        (b"pnts...".to_vec(), "pnts"),
        (b3dm("{\"RTC_CENTER\": [1]}", &[], "", &[]), "feature table is no JSON"),
        (b3dm("{\"RTC_CENTER\": {\"byteOffset\": 18446744073709551615}}", &[], "", &[]), "cut off"),
        (b3dm("", &[], "[]", &[]), "batch table is no JSON"),
        (b3dm("", &[], "", b"glTF"), "cut off"),
    ] {
        assert!(is_tile(&bytes));
        let error = read_one(&bytes).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}, expected {expected}");
    }
}

#[test]
fn transforms_are_columns_and_each_acts_within_its_parent() {
    // A quarter about z, then 100 along x.
    let quarter = json!([0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1]);
    let child = json!({"transform": shifted(5.0), "content": {"uri": "a.gltf"}});
    let file = Folder::new().with("tileset.json", json!({"transform": quarter, "children": [child]})).read().unwrap();
    assert_eq!(rings(&file.surfaces, 0)[0], [[100.0, 5.0, 0.0], [100.0, 6.0, 0.0], [100.0, 5.0, 1.0]]);
    let mirror = json!([-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    let file =
        Folder::new().with("tileset.json", json!({"transform": mirror, "content": {"uri": "a.gltf"}})).read().unwrap();
    assert_eq!(
        rings(&file.surfaces, 0)[0],
        [[0.0; 3], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
        "turned round by the mirror"
    );
}

#[test]
fn finer_content_replaces_or_adds() {
    let leaf = |x: f64| json!({"transform": shifted(x), "content": {"url": "a.gltf"}});
    for (refine, expected) in [("REPLACE", vec![1.0, 2.0]), ("ADD", vec![0.0, 1.0, 2.0])] {
        let middle = json!({"children": [{}, leaf(2.0), {"children": [{"children": []}]}]});
        let root = json!({"refine": refine, "content": {"uri": "a.gltf"}, "children": [leaf(1.0), middle]});
        let file = Folder::new().with("tileset.json", root).read().unwrap();
        assert_eq!(places(&file).iter().map(|place| place[0]).collect::<Vec<_>>(), expected);
    }
    // Children without content replace nothing.
    let root = json!({"refine": "REPLACE", "content": {"uri": "a.gltf"}, "children": [{}, {"children": [{}]}]});
    assert_eq!(places(&Folder::new().with("tileset.json", root).read().unwrap()).len(), 1);
}

#[test]
fn several_contents_and_further_tilesets_are_read() {
    let multiple = json!({"3DTILES_multiple_contents": {"content": [{"uri": "a.gltf"}]}});
    let root = json!({
        "contents": [{"uri": "a.gltf?v=1.2#x"}, {"uri": "./a%2Egltf"}],
        "extensions": multiple,
        "refine": "ADD",
        "children": [{"transform": shifted(7.0), "content": {"uri": "sub/tiles.json"}}]
    });
    let sub = json!({"transform": shifted(1.0), "content": {"uri": "../a.gltf"}});
    let file = Folder::new().with("tileset.json", root).with("sub/tiles.json", sub).read().unwrap();
    assert_eq!(places(&file).iter().map(|place| place[0]).collect::<Vec<_>>(), [0.0, 0.0, 0.0, 8.0]);
    assert_eq!(file.surfaces.format, "3D Tiles 1.1");
}

#[test]
fn what_cannot_be_read_is_refused_by_name() {
    let content = |uri: &str| json!({"content": {"uri": uri}});
    let with = |root: Value| Folder::new().with("tileset.json", root).refused();
    for (uri, expected) in [
        ("https://example.org/0.b3dm", "web address"),
        ("//example.org/0.b3dm", "web address"),
        ("data:;base64,AAAA", "in the tileset itself"),
        ("/etc/hostname", "no relative path"),
        ("C:/a.gltf", "no relative path"),
        ("..\\a.gltf", "no relative path"),
        ("", "no relative path"),
        ("a%00.gltf", "no relative path"),
        ("missing.glb", "missing.glb"),
        (".", "a folder"),
    ] {
        let error = with(content(uri));
        assert!(error.contains(expected), "{uri}: {error}");
    }
    assert!(with(json!({"implicitTiling": {}, "content": {"uri": "{x}/{y}.glb"}})).contains("implicit tiling"));
    assert!(with(json!({"extensions": {"3DTILES_implicit_tiling": {}}})).contains("implicit tiling"));
    assert!(with(json!({"transform": [1, 2], "content": {"uri": "a.gltf"}})).contains("no tileset"));
    let mut bent = shifted(0.0);
    bent[3] = json!(1);
    assert!(with(json!({"transform": bent, "content": {"uri": "a.gltf"}})).contains("not affine"));
    assert!(with(json!({"transform": shifted(1e12), "content": {"uri": "a.gltf"}})).contains("farther than"));
    let text = |text: &str| Folder::new().with_text("tileset.json", text).refused();
    assert!(text(r#"{"asset": {"version": "2.0"}, "geometricError": 0, "root": {}}"#).contains("version 2.0"));
    assert!(text(r#"{"asset": {"version": "1.0"}, "root": {}, "extensionsRequired": ["X_y"]}"#).contains("X_y"));
    assert!(text("{").contains("line 1"));
    let deep = format!("{}{}{}", "{\"children\": [".repeat(1000), "{}", "]}".repeat(1000));
    assert!(text(&format!(r#"{{"asset": {{"version": "1.0"}}, "root": {deep}}}"#)).contains("recursion"));
}

#[test]
fn tilesets_in_a_circle_end_in_an_error() {
    let folder = Folder::new()
        .with("tileset.json", json!({"content": {"uri": "sub/b.json"}}))
        .with("sub/b.json", json!({"content": {"uri": "../sub/../tileset.json"}}));
    assert!(folder.refused().contains("names itself"), "{}", folder.refused());
}

#[test]
fn packed_models_are_named_with_their_file() {
    let folder = Folder::new().with("tileset.json", json!({"content": {"uri": "b.gltf"}}));
    let model = gltf(|json| json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]));
    let error = folder.with_text("b.gltf", std::str::from_utf8(&model).unwrap()).refused();
    assert!(error.contains("KHR_draco_mesh_compression") && error.contains("b.gltf"), "{error}");
}

#[test]
fn a_tileset_is_known_by_its_errors_in_metres() {
    assert!(is_tileset(b"\xEF\xBB\xBF {\"asset\": {}, \"geometricError\": 1}"));
    assert!(!is_tileset(&gltf(|_| {})) && !is_tileset(b"<x>\"geometricError\"") && !is_tile(&gltf(|_| {})));
}

#[test]
fn a_tileset_on_the_earth_stands_upright_and_says_how_it_was_turned() {
    // Delft, in ECEF; the triangle's y is up in glTF, so z in the tile: it stands on edge here.
    let center = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3923307.0, 299672.0, 5003039.0, 1]);
    let file =
        Folder::new().with("tileset.json", json!({"transform": center, "content": {"uri": "a.gltf"}})).read().unwrap();
    let local = file.local_from_ecef.unwrap();
    let (low, high) = extent(&file.surfaces);
    assert!(high[0] - low[0] < 2.0 && low.iter().take(2).all(|value| value.abs() < 2.0), "{low:?} {high:?}");
    let back = local.rotation.inverse() * (nalgebra::Vector3::from(places(&file)[0]) - local.translation);
    assert!((back - nalgebra::Vector3::new(3923307.0, 299672.0, 5003039.0)).norm() < 1e-6);
}
