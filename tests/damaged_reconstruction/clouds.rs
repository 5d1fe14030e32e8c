//! Damaged, lying and odd clouds.

use super::*;

/// (file, what the message says)
const REFUSED_CLOUDS: [(&str, &[&str]); 21] = [
    ("bad_cut", &["byte 178", "element vertex", "3 rows of at least 27 bytes", "80 bytes"]),
    ("bad_count_lies", &["element vertex", "4000000000 rows", "81 bytes to the end"]),
    ("bad_count_lies_ascii", &["4000000000 rows of vertex", "the end of the file after 3"]),
    ("bad_count_overflows", &["18446744073709551615"]),
    ("bad_count_too_low", &["the end of the file", "27 bytes more"]),
    ("bad_count_too_low_ascii", &["line 10", "the end of the file", "-1.5"]),
    ("bad_count_negative", &["header line 3", "-3"]),
    ("bad_list_length_lies", &["element face"]),
    ("bad_no_vertex", &["expected an element `vertex`"]),
    ("bad_no_z", &["expected a property `z`"]),
    ("bad_x_list", &["`x` of vertex is a list"]),
    ("bad_no_header_end", &["end_header"]),
    ("bad_format", &["header line 2", "binary_middle_endian"]),
    ("bad_row_short", &["line 9", "a number for `z` of vertex", "the end of the line"]),
    ("bad_row_long", &["line 9", "3 values", "`7`"]),
    ("bad_row_word", &["line 9", "a number for `y` of vertex", "`five 6`"]),
    ("bad_element_without_properties", &["the element `ghost` has no properties"]),
    ("bad_element_twice", &["the element `vertex` is there twice"]),
    ("bad_property_twice", &["the property `x` is there twice"]),
    ("bad_no_points", &["no points"]),
    ("bad_all_nan", &["no points"]),
];

#[test]
fn every_damaged_cloud_is_refused_with_its_place() {
    let mut failures = Vec::new();
    for (name, fragments) in REFUSED_CLOUDS {
        let path = data().join("ply").join(name).with_extension("ply");
        let message = read_reconstruction(&path).expect_err(name).to_string();
        println!("{name}: {message}");
        assert!(message.starts_with(path.to_str().unwrap()) && !message.contains('\n'), "{name}: {message}");
        let absent = fragments.iter().filter(|fragment| !message.contains(**fragment));
        failures.extend(absent.map(|fragment| format!("{name}: `{fragment}` is not in: {message}")));
    }
    assert!(failures.is_empty(), "{failures:#?}");
    let bad = files_of(&data().join("ply"))
        .into_iter()
        .filter(|p| p.file_name().unwrap().to_str().unwrap().starts_with("bad"));
    assert_eq!(bad.count(), REFUSED_CLOUDS.len());
}

#[test]
fn sound_clouds_of_every_kind_say_the_same() {
    let mut read_files = 0;
    for path in files_of(&data().join("ply")) {
        let name = path.file_stem().unwrap().to_str().unwrap();
        if !name.starts_with("sound") {
            continue;
        }
        read_files += 1;
        let read = read_reconstruction(&path).unwrap_or_else(|error| panic!("{error}"));
        // Lists are not carried along, and that is told.
        assert!(
            read.warnings.iter().all(|warning| warning.kind == WarningKind::FieldsDropped)
                && read.images.is_empty()
                && read.colmap.is_none(),
            "{name}"
        );
        let expected = [[0.25, -0.5, 1.125], [1.0, 2.0, 3.0], [-1.5, 0.0, 1e-3]];
        let tolerance = if name == "sound_float" { 1e-9 } else { 0.0 };
        for (point, expected) in read.points.iter().zip(expected) {
            assert!(point.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance), "{name} {point}");
        }
        let colors = [[10, 20, 30], [0, 128, 255], [1, 2, 3]];
        let without_colors = ["sound_mesh_first", "sound_odd_header", "sound_crlf"].contains(&name);
        assert_eq!(read.colors, if without_colors { vec![] } else { colors.to_vec() }, "{name}");
        assert_eq!(read.normals.len(), if name == "sound_mesh_first" { 3 } else { 0 }, "{name}");
    }
    assert_eq!(read_files, 8);
}

#[test]
fn odd_rows_of_clouds_are_left_out_and_counted() {
    for name in ["odd_nan_rows", "odd_nan_rows_binary"] {
        let read = read_reconstruction(&data().join("ply").join(name).with_extension("ply")).unwrap();
        assert_eq!(read.points.len(), 2, "{name}");
        let warning = &read.warnings[0];
        assert_eq!((warning.kind, warning.count), (WarningKind::PointsWithoutPosition, 1), "{name}");
        assert!(warning.to_string().contains("vertex 1"), "{warning}");
    }
    let read = read_reconstruction(&data().join("ply/odd_zero_normal.ply")).unwrap();
    let normals: Vec<_> = read.normals.iter().map(|n| [n.x, n.y, n.z]).collect();
    assert_eq!(normals, [[0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]]);
    assert_eq!((read.warnings[0].kind, read.warnings[0].count), (WarningKind::NormalsWithoutDirection, 2));
}
