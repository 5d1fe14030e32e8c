use super::*;
use crate::format::surface_error::{Place, SurfaceError};
use crate::format::surfaces::SurfaceFile;
use crate::format::tests::{assert_sound, rings};

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]];

pub(in crate::format) fn binary_stl(remark: &str, count: u32) -> Vec<u8> {
    let mut bytes = remark.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for _ in 0..2 {
        bytes.extend([0; 12]);
        bytes.extend(TRIANGLE.iter().flatten().flat_map(|value| value.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub(in crate::format) const TEXT_STL: &str = "solid the house\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 .5\n   vertex 1 0 .5\n   vertex 0 1.0e0 .5\n  endloop\n endfacet\nendsolid the house\n";

fn stl(bytes: &[u8]) -> Result<SurfaceFile, SurfaceError> {
    read_stl(bytes, "file").inspect(assert_sound)
}

#[test]
fn binary_stl_is_read_also_where_it_begins_with_solid() {
    for remark in ["", "solid but binary, facet"] {
        let bytes = binary_stl(remark, 2);
        assert!(is_stl(&bytes));
        let file = stl(&bytes).unwrap();
        assert_eq!((file.surfaces.len(), file.objects.len(), file.objects[0].id.as_str()), (2, 1, "file"));
        assert_eq!(rings(&file, 1), [TRIANGLE.map(|corner| corner.map(f64::from)).to_vec()]);
    }
}

#[test]
fn each_solid_of_a_text_stl_is_an_object() {
    let text =
        format!("{}{}", TEXT_STL, TEXT_STL.replace(" the house", "").to_uppercase().replace("SOLID\n", "solid\r\n"));
    assert!(is_stl(text.as_bytes()));
    let file = stl(text.as_bytes()).unwrap();
    let names: Vec<&str> = file.objects.iter().map(|object| object.id.as_str()).collect();
    assert_eq!((names, file.surfaces.len(), file.surfaces[1].object), (vec!["the house", "file"], 2, 1));
    assert_eq!(rings(&file, 0), rings(&file, 1));
    assert_eq!(stl(b"solid house\nendsolid house\n").unwrap().surfaces, []);
}

#[test]
fn stl_that_lies_is_refused_with_its_place() {
    for count in [0, 1, 3, u32::MAX] {
        let bytes = binary_stl("", count);
        assert!(!is_stl(&bytes) && stl(&bytes).is_err());
    }
    let mut bytes = binary_stl("", 2);
    bytes[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(stl(&bytes).unwrap_err().place, Place::Byte(134));
    for (from, to, expected, line) in [
        ("1.0e0", "nan", "finite", 6),
        ("1 0 .5", "1 0", "finite", 5),
        ("1 0 .5", "1 0 .5 7", "finite", 5),
        ("   vertex 1 0 .5\n", "", "three corners", 7),
        ("endloop", "endlop", "expected solid", 7),
    ] {
        let error = stl(TEXT_STL.replace(from, to).as_bytes()).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
        assert!(matches!(error.place, Place::Line { line: found, .. } if found == line), "{error:?}");
    }
    let cut = TEXT_STL.replace("endsolid the house\n", "");
    assert!(stl(cut.as_bytes()).unwrap_err().to_string().contains("cut off"));
}

pub(in crate::format) const TEXT_PLY: &str = "ply\r\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nelement face 2\nproperty uchar flag\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n0 0 .5 1\n1 0 .5 2\n1 1 .5 3\n0 1 .5 4\n9 4 0 1 2 3\n9 2 0 1\n7\n";

fn ply(bytes: &[u8]) -> Result<SurfaceFile, SurfaceError> {
    read_ply_mesh(bytes, "file").inspect(assert_sound)
}

/// The same in bytes; faces stand before the vertices.
pub(in crate::format) fn binary_ply(is_big: bool) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement face 1\nproperty list uint8 uint16 vertex_index\nelement vertex 4\nproperty float32 x\nproperty float64 y\nproperty int16 z\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    let mut push =
        |little: &[u8]| bytes.extend(if is_big { little.iter().rev().copied().collect() } else { little.to_vec() });
    push(&[4]);
    (0..4_u16).for_each(|corner| push(&corner.to_le_bytes()));
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        push(&(x as f32).to_le_bytes());
        push(&f64::to_le_bytes(y));
        push(&(-3_i16).to_le_bytes());
    }
    bytes
}

#[test]
fn faces_of_a_ply_file_are_read_in_text_and_in_both_orders_of_bytes() {
    let corners = |z: f64| vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    let file = ply(TEXT_PLY.as_bytes()).unwrap();
    assert_eq!((file.surfaces.len(), rings(&file, 0)), (1, vec![corners(0.5)]));
    assert_eq!(
        (file.skipped[0].what, file.skipped[0].example.as_str()),
        ("faces with less than three corners", "face 2")
    );
    for is_big in [false, true] {
        let bytes = binary_ply(is_big);
        assert!(is_ply_mesh(&bytes));
        assert_eq!(rings(&ply(&bytes).unwrap(), 0), [corners(-3.0)]);
    }
    assert!(is_ply_mesh(TEXT_PLY.as_bytes()));
    assert!(!is_ply_mesh(TEXT_PLY.replace("face 2", "face 0").as_bytes()), "a cloud");
}

#[test]
fn ply_that_lies_is_refused() {
    for (from, to, expected) in [
        ("vertex 4", "vertex 4000000000", "cut off"),
        ("face 2", "face 4000000000", "cut off"),
        ("edge 1", "edge 0", "behind the last row"),
        ("4 0 1 2 3", "4 0 1 2 4", "corner 4"),
        ("4 0 1 2 3", "-4 0 1 2 3", "a list says -4"),
        ("4 0 1 2 3", "3 0 1 -2", "`-2`"),
        ("1 1 .5 3", "1 nan .5 3", "not finite"),
        ("1 1 .5 3", "1 x .5 3", "`x` is no number"),
        ("property double y", "property double w", "a property `y` of vertex"),
        ("property double y", "property quad y", "got `property quad y`"),
        ("property int a\n", "", "`edge` has no properties"),
        ("end_header", "end_heade", "got `end_heade`"),
    ] {
        let text = TEXT_PLY.replace(from, to);
        let error = ply(text.as_bytes()).unwrap_err();
        assert!(error.to_string().contains(expected), "{to}: {error}");
    }
    assert!(ply(b"ply\nformat ascii 1.0\n").unwrap_err().to_string().contains("`end_header`"));
    assert!(!is_ply_mesh(b"solid"));
}
