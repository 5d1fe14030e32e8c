use std::path::Path;

use super::read::parse;
use super::{CloudField, FieldKind, PlyCloud};

fn read(text: &str) -> PlyCloud {
    parse(Path::new("cloud.ply"), text.as_bytes()).unwrap()
}

fn header(encoding: &str, properties: &[&str]) -> String {
    let properties: String = properties.iter().map(|p| format!("property {p}\n")).collect();
    format!(
        "ply\nformat {encoding} 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n{properties}"
    )
}

#[test]
fn further_properties_keep_their_names_types_and_values() {
    let text = header("ascii", &["uchar class", "double scalar_d_(m)", "int8 turn", "list uchar int neighbours"]);
    let cloud = read(&(text + "end_header\n1 2 3 6 0.1 -4 2 0 1\n4 5 6 2 1e300 127 0\n"));
    let named: Vec<_> = cloud.fields.iter().map(|f| (f.name.as_str(), f.kind)).collect();
    assert_eq!(named, [("class", FieldKind::U8), ("scalar_d_(m)", FieldKind::F64), ("turn", FieldKind::I8)]);
    let values = |f: &CloudField| (0..f.len()).map(|i| f.value(i).unwrap()).collect::<Vec<_>>();
    assert_eq!(cloud.fields.iter().map(values).collect::<Vec<_>>(), [[6.0, 2.0], [0.1, 1e300], [-4.0, 127.0]]);
    assert_eq!(cloud.lists, ["neighbours"]);
}

#[test]
fn a_point_that_is_left_out_takes_its_further_values_with_it() {
    let cloud = read(&(header("ascii", &["int id"]) + "end_header\nnan 2 3 7\n4 5 6 8\n"));
    assert_eq!((cloud.dropped, cloud.positions.len()), (1, 1));
    assert_eq!((cloud.fields[0].len(), cloud.fields[0].value(0), cloud.fields[0].value(1)), (1, Some(8.0), None));
}

#[test]
fn one_colour_alone_is_a_further_property() {
    let cloud = read(&(header("ascii", &["uchar red", "float nx"]) + "end_header\n1 2 3 7 1\n4 5 6 8 0\n"));
    assert!(cloud.colors.is_empty() && cloud.normals.is_empty());
    assert_eq!(cloud.fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["red", "nx"]);
}

#[test]
fn colours_are_scaled_by_their_type() {
    for (kind, value, expected) in
        [("float", "1.0", 255), ("ushort", "65535", 255), ("uchar", "7", 7), ("float", "nan", 0)]
    {
        let properties = ["red", "green", "blue"].map(|name| format!("{kind} {name}"));
        let properties: Vec<&str> = properties.iter().map(String::as_str).collect();
        let row = format!("1 2 3 {value} {value} {value}\n");
        let cloud = read(&format!("{}end_header\n{row}{row}", header("ascii", &properties)));
        assert_eq!(cloud.colors, [[expected; 3]; 2], "{kind} {value}");
    }
}

#[test]
fn faces_that_are_not_as_the_header_says_are_passed_over_and_counted() {
    let faces = "element face 3\nproperty list uchar int vertex_indices\nend_header\n";
    let cloud = read(&(header("ascii", &[]) + faces + "1 2 3\n4 5 6\n3 0 1 0 1 1 1\n3 0 1 0\n2 0\n"));
    assert_eq!((cloud.positions.len(), cloud.odd_rows, cloud.first_odd_line), (2, 2, Some(12)));
    // A row too few is a file that was cut.
    let cut = header("ascii", &[]) + faces + "1 2 3\n4 5 6\n3 0 1 0 1 1 1\n";
    assert!(parse(Path::new("cloud.ply"), cut.as_bytes()).unwrap_err().to_string().contains("after 1"));
}

#[test]
fn a_row_of_every_type_is_read_in_both_orders() {
    let kinds = ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"];
    let properties: Vec<String> = kinds.iter().map(|kind| format!("{kind} f_{kind}")).collect();
    let properties: Vec<&str> = properties.iter().map(String::as_str).collect();
    for (name, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut bytes = (header(name, &properties) + "end_header\n").into_bytes();
        let mut put = |raw: &[u8]| match is_big {
            true => bytes.extend(raw.iter().rev()),
            false => bytes.extend(raw),
        };
        for sign in [1i8, -1] {
            [1.5f32, -2.5, 3.5].iter().for_each(|v| put(&v.to_le_bytes()));
            put(&(sign * 100).to_le_bytes());
            put(&200u8.to_le_bytes());
            put(&(i16::from(sign) * 30000).to_le_bytes());
            put(&60000u16.to_le_bytes());
            put(&(i32::from(sign) * 2_000_000_000).to_le_bytes());
            put(&4_000_000_000u32.to_le_bytes());
            put(&(f32::from(sign) * 0.5).to_le_bytes());
            put(&(f64::from(sign) * 0.1).to_le_bytes());
        }
        let cloud = parse(Path::new("cloud.ply"), &bytes).unwrap();
        assert_eq!(cloud.positions, [[1.5, -2.5, 3.5]; 2]);
        for (point, sign) in [(0, 1.0), (1, -1.0)] {
            let values: Vec<f64> = cloud.fields.iter().map(|f| f.value(point).unwrap()).collect();
            let expected = [sign * 100.0, 200.0, sign * 3e4, 6e4, sign * 2e9, 4e9, sign * 0.5, sign * 0.1];
            assert_eq!(values, expected, "{name}");
        }
    }
}

#[test]
fn cut_and_changed_files_never_panic() {
    let rows = "end_header\n1 2 3 5 2 0 1\n4 5 6 -7 0\n";
    let text = header("ascii", &["int id", "list uchar int faces"]) + rows;
    let mut binary = header("binary_little_endian", &["list int double many"]).into_bytes();
    binary.extend(b"end_header\n");
    (0..2).for_each(|_| binary.extend([[0; 12].as_slice(), &[1, 0, 0, 0], &[9; 8]].concat()));
    for bytes in [text.into_bytes(), binary] {
        for cut in 0..bytes.len() {
            let _ = parse(Path::new("cloud.ply"), &bytes[..cut]);
            for value in [0, 0xFF, b'-', b'9', b'\n'] {
                let mut changed = bytes.clone();
                changed[cut] = value;
                let _ = parse(Path::new("cloud.ply"), &changed);
            }
        }
    }
}
