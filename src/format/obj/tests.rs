use std::ops::Range;

use super::file::LineTally;
use super::*;

fn read(text: &str) -> ObjFile {
    read_obj(text.as_bytes()).unwrap()
}

fn error(text: &str) -> ObjError {
    read_obj(text.as_bytes()).unwrap_err()
}

fn names(file: &ObjFile) -> Vec<(Option<&str>, Option<&str>, Range<usize>)> {
    let groups = file.objects.iter().flat_map(|object| object.groups.iter().map(move |group| (object, group)));
    groups.map(|(object, group)| (object.name.as_deref(), group.name.as_deref(), group.faces.clone())).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn keeps_every_bit_of_national_grid_coordinates() {
    let file = read("v 450000.1234567 5500000.123 -1e-3\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    assert_eq!(file.positions[0], [450000.1234567, 5500000.123, -0.001]);
}

#[test]
fn keeps_polygons_with_their_lines() {
    let file = read(&format!("# a square\n{SQUARE}\nf 1 2 3 4\nf 1 2 3\n"));
    assert_eq!(file.corners, [0, 1, 2, 3, 0, 1, 2]);
    assert_eq!(file.face_ends, [4, 7]);
    assert_eq!(file.face_lines, [7, 8]);
}

#[test]
fn reads_corners_with_texture_and_normal_indices_and_trailing_remarks() {
    let file = read(&format!("{SQUARE}vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1 4 # roof\nf 1/ 2/ 3/\n"));
    assert_eq!(file.corners, [0, 1, 2, 3, 0, 1, 2]);
}

#[test]
fn counts_negative_indices_back_from_the_face() {
    let file = read(&format!("{SQUARE}f -4 -3 -2 -1\nv 5 5 5\nf -1 -2 1\n"));
    assert_eq!(file.corners, [0, 1, 2, 3, 4, 3, 0]);
}

#[test]
fn takes_vertices_that_come_after_their_face() {
    assert_eq!(read(&format!("f 1 2 3\n{SQUARE}")).corners, [0, 1, 2]);
}

#[test]
fn reads_a_byte_order_mark_and_all_line_ends() {
    let expected = read(&format!("{SQUARE}f 1 2 3\n"));
    let lines = format!("{SQUARE}f 1 2 3");
    assert_eq!(read(&format!("\u{feff}{lines}")), expected);
    assert_eq!(read(&lines.replace('\n', "\r\n")), expected);
    assert_eq!(read(&lines.replace('\n', "\r")), expected);
}

#[test]
fn joins_continued_lines_and_still_counts_them() {
    let file = read(&format!("{SQUARE}f 1 2 \\\n 3 \\\n 4\nf 1 2 3\n"));
    assert_eq!(file.face_ends, [4, 7]);
    assert_eq!(file.face_lines, [5, 8]);
}

#[test]
fn a_backslash_ends_remarks_and_paths_without_meaning() {
    let file = read("# C:\\models\\\nv 0 0 0\nmtllib C:\\\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(file.positions.len(), 3);
    assert_eq!(file.face_lines, [6]);
}

#[test]
fn reads_names_in_latin_1() {
    let text = [b"o Stra\xDFe 1\n".as_slice(), SQUARE.as_bytes(), b"f 1 2 3\n"].concat();
    let file = read_obj(&text).unwrap();
    assert_eq!(file.objects[0].name.as_deref(), Some("Straße 1"));
}

#[test]
fn reads_names_behind_spaces_that_are_none_in_ascii() {
    let file = read(&format!("{SQUARE}g\u{a0}Dach\nf 1 2 3\n\u{3000}o\u{3000}Haus\nf 1 2 3\n  g   a   b\nf 1 2 3\n"));
    assert_eq!(
        names(&file),
        [(None, Some("Dach"), 0..1), (Some("Haus"), None, 1..2), (Some("Haus"), Some("a b"), 2..3)]
    );
}

#[test]
fn loses_no_face_on_groups_without_a_name() {
    let file = read(&format!("{SQUARE}o A\ng a\nf 1 2 3\ng\no B\nf 1 2 3\ng\nf 2 3 4\n"));
    assert_eq!(names(&file), [(Some("A"), Some("a"), 0..1), (Some("B"), None, 1..2), (Some("B"), None, 2..3)]);
}

#[test]
fn two_objects_of_one_name_stay_two() {
    let file = read(&format!("{SQUARE}o A\nf 1 2 3\no A\nf 1 2 3\n"));
    assert_eq!(file.objects.len(), 2);
}

#[test]
fn says_where_an_index_is_out_of_range() {
    let error = error(&format!("{SQUARE}o house\nf 1 2 3\nf 1 2 9\n"));
    assert_eq!((error.line, error.object.as_deref()), (7, Some("house")));
    assert_eq!(error.problem, ObjProblem::IndexOutOfRange { index: 9, vertices: 4 });
}

#[test]
fn says_where_a_negative_index_reaches_too_far() {
    let error = error(&format!("{SQUARE}f -5 -1 -2\n"));
    assert_eq!((error.line, error.problem), (5, ObjProblem::BeforeFirst));
}

#[test]
fn refuses_corners_that_are_no_indices() {
    for (corner, problem) in [
        ("0", ObjProblem::ZeroIndex),
        ("-0", ObjProblem::ZeroIndex),
        ("x", ObjProblem::NotAnIndex { token: "x".to_owned() }),
        ("1.5", ObjProblem::NotAnIndex { token: "1.5".to_owned() }),
        ("/1", ObjProblem::NotAnIndex { token: "/1".to_owned() }),
        ("-", ObjProblem::NotAnIndex { token: "-".to_owned() }),
        ("99999999999", ObjProblem::NotAnIndex { token: "99999999999".to_owned() }),
        ("4294967297", ObjProblem::IndexOutOfRange { index: 4294967296, vertices: 4 }),
    ] {
        let error = error(&format!("{SQUARE}f 1 2 {corner}\n"));
        assert_eq!((error.line, error.problem), (5, problem), "{corner}");
    }
}

#[test]
fn refuses_vertices_that_are_no_places() {
    for (line, problem) in [
        ("v 1 2", ObjProblem::TooFewCoordinates { found: 2 }),
        ("v", ObjProblem::TooFewCoordinates { found: 0 }),
        ("v 1 2 # 3", ObjProblem::TooFewCoordinates { found: 2 }),
        ("v 1 2,5 3", ObjProblem::NotANumber { token: "2,5".to_owned() }),
    ] {
        let error = error(&format!("o house\n{SQUARE}{line}\nf 1 2 3\n"));
        assert_eq!((error.line, error.object.as_deref(), error.problem), (6, Some("house"), problem));
    }
}

#[test]
fn a_vertex_that_is_nowhere_is_counted_and_keeps_its_number() {
    let file = read(&format!("{SQUARE}v 1 nan 3\nv 1e300 0 0\nv 5 5 5\nf 1 2 7\n"));
    assert_eq!(file.oddities.lost_vertices, LineTally { count: 2, first_line: 5 });
    assert_eq!((file.positions[6], &file.corners[..]), ([5.0, 5.0, 5.0], &[0, 1, 6][..]));
}

#[test]
fn a_last_line_that_is_plainly_cut_is_refused() {
    for cut in ["f 1 2", "f 1/2/3 2/2/3 3/", "f 1/2/3 2/2/3 3/2", "f 1//3 2//3 3", "v 1 2", "v", "use", "mtll"] {
        let text = format!("o house\n{SQUARE}f 1 2 3\n{cut}");
        let error = error(&text);
        let expected = ObjProblem::CutOff { line: cut.to_owned() };
        assert_eq!((error.line, error.object.as_deref(), error.problem), (7, Some("house"), expected));
    }
    for whole in
        ["f 1 2 3", "f 1/1 2/1 3/1", "f 1 2 3 # end", "v 1 2 3", "# us", "usemtl x", "g", "s off", "hello there"]
    {
        read(&format!("o house\n{SQUARE}f 1 2 3\n{whole}"));
    }
}

#[test]
fn counts_what_it_passes_over() {
    let file = read(&format!("{SQUARE}f 1 2\nf\nhello\nf 1 2 3\nsurf 0 1 0 1\nworld\n"));
    assert_eq!(file.oddities.short_faces, LineTally { count: 2, first_line: 5 });
    assert_eq!(file.oddities.unknown_lines, LineTally { count: 2, first_line: 7 });
    assert_eq!(file.oddities.free_forms, LineTally { count: 1, first_line: 9 });
    assert_eq!(file.face_lines, [8]);
}

#[test]
fn pieces_join_to_what_one_piece_would_hold() {
    // Three megabytes, so that objects, groups, continued lines and relative indices meet the cuts between pieces.
    let mut text = String::new();
    let mut expected = Vec::new();
    let mut lines = 0;
    for house in 0..30_000_u32 {
        if house % 7 == 0 {
            text += &format!("o house {house}\n");
            lines += 1;
        }
        if house % 3 == 0 {
            text += &format!("g part {house}\n");
            lines += 1;
        }
        let at = f64::from(house);
        text += &format!(
            "v {at}.125 0 0\nv {at} 1 0\nv {at} 1 1\nv {at} 0 1\nf -4 -3 \\\n-2 -1\nf {} 1 2\n",
            4 * house + 1
        );
        expected.push((lines + 5, house - house % 7, house - house % 3));
        lines += 7;
    }
    let file = read(&text);
    assert!(text.len() > 2 << 20);
    assert_eq!(file.positions.len(), 120_000);
    assert_eq!(file.positions[119_996], [29_999.125, 0.0, 0.0]);
    assert_eq!(file.oddities, ObjOddities::default());
    for (object, group, faces) in names(&file) {
        for house in faces.map(|face| face / 2) {
            let (line, first_of_object, first_of_group) = expected[house];
            assert_eq!(object, Some(format!("house {first_of_object}").as_str()));
            let is_in_object = first_of_group >= first_of_object;
            assert_eq!(group, is_in_object.then(|| format!("part {first_of_group}")).as_deref());
            assert_eq!(file.face_lines[2 * house], line);
            assert_eq!(file.corners[7 * house..7 * house + 5], [0, 1, 2, 3, 0].map(|at| at + 4 * house as u32));
        }
    }
    assert_eq!(file.objects.len(), 30_000_usize.div_ceil(7));
}

#[test]
fn places_errors_behind_the_first_piece() {
    let filler = "# a remark that fills the first megabytes of this file\n".repeat(50_000);
    let error = error(&format!("o house\n{SQUARE}{filler}f 1 2 3\nf 1 -9 2\n"));
    assert_eq!((error.line, error.object.as_deref()), (50_007, Some("house")));
}

#[test]
fn what_is_written_reads_back() {
    let file = read(&format!("o A\n{SQUARE}v 90851.4533 435670.4705 13.5946\ng a\nf 1 2 3 5\no B\nf 1 2 3\n"));
    let mut text = Vec::new();
    write_obj(&mut text, &file).unwrap();
    let again = read_obj(&text).unwrap();
    assert_eq!((&again.positions, &again.corners, &again.objects), (&file.positions, &file.corners, &file.objects));
    assert!(String::from_utf8(text).unwrap().contains("v 90851.4533 435670.4705 13.5946\n"));
}
