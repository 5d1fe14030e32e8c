use super::*;
use crate::format::surfaces::{Lod, SurfaceFile, SurfaceKind};

/// A CityJSON text around city objects; vertices 0 to 7 are a cube's, bottom then top, counter-clockwise from above.
fn text(objects: &str) -> String {
    format!(
        "{{\"type\":\"CityJSON\",\"version\":\"2.0\",{TRANSFORM},\"CityObjects\":{{{objects}}},\"vertices\":{CUBE}}}"
    )
}

const TRANSFORM: &str = r#""transform":{"scale":[0.5,0.5,0.25],"translate":[100.0,200.0,10.0]}"#;
const CUBE: &str = "[[0,0,0],[2,0,0],[2,2,0],[0,2,0],[0,0,4],[2,0,4],[2,2,4],[0,2,4]]";
const SHELL: &str = "[[[3,2,1,0]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]";

fn building(geometry: &str) -> String {
    text(&format!(r#""b":{{"type":"Building","geometry":[{geometry}]}}"#))
}

fn solid(more: &str) -> String {
    format!(r#"{{"type":"Solid","lod":"2.2","boundaries":[{SHELL}]{more}}}"#)
}

fn read(text: &str) -> SurfaceFile {
    read_cityjson(text.as_bytes()).unwrap_or_else(|error| panic!("{error} at {}:{}", error.line, error.column))
}

/// Message, object, line and column.
fn refused(text: &str) -> (String, Option<String>, usize, usize) {
    let error = read_cityjson(text.as_bytes()).unwrap_err();
    (error.to_string(), error.object, error.line, error.column)
}

fn skipped(file: &SurfaceFile) -> Vec<(&str, usize, &str)> {
    file.skipped.iter().map(|skipped| (skipped.what, skipped.count, skipped.example.as_str())).collect()
}

#[test]
fn a_solid_is_six_polygons_of_one_shell_at_the_places_of_the_transform() {
    let file = read(&building(&solid("")));
    assert_eq!((file.format.as_str(), &file.crs), ("CityJSON 2.0", &None));
    assert_eq!((file.positions[0], file.positions[6]), ([100.0, 200.0, 10.0], [101.0, 201.0, 11.0]));
    assert_eq!((file.step, file.surfaces.len()), (Some(0.5), 6));
    assert!(
        file.surfaces.iter().all(|s| (s.lod, s.kind, s.shell, s.ring_count) == (Some(Lod(2, 2)), None, Some(0), 1))
    );
    assert_eq!((file.ring(0), file.ring(5)), (&[3, 2, 1, 0][..], &[3, 0, 4, 7][..]));
    assert_eq!((file.objects[0].id.as_str(), file.objects[0].class.as_str()), ("b", "Building"));
}

#[test]
fn version_1_0_may_have_numbers_for_levels_and_no_transform() {
    let text = building(r#"{"type":"MultiSurface","lod":1.3,"boundaries":[[[0,1,2,3]]]}"#);
    let old = text.replace("2.0", "1.0").replace(&format!("{TRANSFORM},"), "");
    let file = read(&old);
    assert_eq!((file.format.as_str(), file.positions[6]), ("CityJSON 1.0", [2.0, 2.0, 4.0]));
    assert_eq!((file.surfaces[0].lod, file.surfaces[0].shell), (Some(Lod(1, 3)), None));
    let whole = read(&old.replace("1.3", "2"));
    assert_eq!(whole.surfaces[0].lod, Some(Lod(2, 0)));
    assert_eq!(read(&old.replace("\"1.0\"", "\"1.0.3\"")).format, "CityJSON 1.0");
}

#[test]
fn holes_stay_with_their_outline_and_a_repeated_first_corner_is_dropped() {
    let file = read(&building(r#"{"type":"MultiSurface","boundaries":[[[0,1,2,3,0],[4,5,6]],[[4,5,6,7]]]}"#));
    let rings: Vec<_> = file.surfaces.iter().map(|surface| (surface.first_ring, surface.ring_count)).collect();
    assert_eq!(rings, [(0, 2), (2, 1)]);
    assert_eq!((file.ring(0), file.ring(1), file.ring(2)), (&[0, 1, 2, 3][..], &[4, 5, 6][..], &[4, 5, 6, 7][..]));
}

#[test]
fn only_the_outer_shells_of_solids_tell_the_order_of_axes() {
    let solids = format!(r#"{{"type":"MultiSolid","boundaries":[[{SHELL},{SHELL}],[{SHELL}]]}}"#);
    let shells: Vec<Option<u32>> = read(&building(&solids)).surfaces.iter().map(|surface| surface.shell).collect();
    assert_eq!(shells, [[Some(0); 6], [None; 6], [Some(1); 6]].concat());
}

/// Kinds of all surfaces, and what was passed over.
fn kinds(geometry: &str) -> (Vec<Option<SurfaceKind>>, usize) {
    let file = read(&building(geometry));
    (file.surfaces.iter().map(|surface| surface.kind).collect(), skipped(&file).iter().map(|skipped| skipped.1).sum())
}

#[test]
fn kinds_nest_as_the_boundaries_do() {
    let surfaces = r#""surfaces":[{"type":"GroundSurface"},{"type":"RoofSurface","slope":3},{"type":"WallSurface"},{"type":"Door"}]"#;
    let semantics = |values: &str| format!(r#","semantics":{{{surfaces},"values":{values}}}"#);
    let (ground, roof, wall, other) =
        (Some(SurfaceKind::Ground), Some(SurfaceKind::Roof), Some(SurfaceKind::Wall), Some(SurfaceKind::Other));
    assert_eq!(kinds(&solid(&semantics("[[0,1,2,null,3,2]]"))), (vec![ground, roof, wall, None, other, wall], 0));
    // `null` stands for a whole shell, too.
    let two = |values: &str| format!(r#"{{"type":"Solid","boundaries":[{SHELL},{SHELL}]{}}}"#, semantics(values));
    assert_eq!(kinds(&two("[null,[2,2,2,2,2,2]]")), ([[None; 6], [wall; 6]].concat(), 0));
    let solids =
        format!(r#"{{"type":"CompositeSolid","boundaries":[[{SHELL}],[{SHELL}]]{}}}"#, semantics("[null,[[1,0,2]]]"));
    assert_eq!(kinds(&solids), ([&[None; 6][..], &[roof, ground, wall, None, None, None]].concat(), 0));
    let flat = format!(r#"{{"type":"MultiSurface","boundaries":[[[0,1,2]],[[1,2,3]]]{}}}"#, semantics("[1,2]"));
    assert_eq!(kinds(&flat), (vec![roof, wall], 0));
    assert_eq!(kinds(&solid(&semantics("null"))).0, [None; 6]);
}

#[test]
fn values_that_fit_no_surface_are_counted() {
    let semantics =
        |values: &str| solid(&format!(r#","semantics":{{"surfaces":[{{"type":"WallSurface"}}],"values":{values}}}"#));
    for (values, misfits) in
        [("[[0,0,0,0,0,0,0,0]]", 2), ("[0,0,0,0,0,0]", 6), ("[[7]]", 1), ("[[-1]]", 1), ("[[[[[[[0]]]]]]]", 5)]
    {
        assert_eq!(kinds(&semantics(values)).1, misfits, "{values}");
    }
}

#[test]
fn points_lines_and_unknown_geometries_are_counted() {
    let file = read(&building(
        r#"{"type":"MultiPoint","boundaries":[0]},{"type":"MultiLineString","boundaries":[[0,1]]},{"type":"Blob"},{"type":"MultiSurface","boundaries":[[]]}"#,
    ));
    assert_eq!(file.surfaces, []);
    let expected = [
        ("points and lines", 2, "b"),
        ("geometries of a type that CityJSON does not have", 1, "b"),
        ("surfaces without a ring", 1, "b"),
    ];
    assert_eq!(skipped(&file), expected);
}

#[test]
fn parts_know_their_building_whichever_of_both_says_so() {
    let parents =
        |objects: &str| -> Vec<Option<u32>> { read(&text(objects)).objects.iter().map(|o| o.parent).collect() };
    let part = r#""p":{"type":"BuildingPart","parents":["b"]}"#;
    let (whole, orphan) = (r#""b":{"type":"Building","children":["p"]}"#, r#""p":{"type":"BuildingPart"}"#);
    assert_eq!(parents(&format!(r#"{part},"b":{{"type":"Building"}}"#)), [Some(1), None]);
    assert_eq!(parents(&format!("{whole},{orphan}")), [None, Some(0)]);
    assert_eq!(parents(&format!("{whole},{part}")), [None, Some(0)]);
    // Members of a group are no parts of it.
    assert_eq!(
        parents(r#""b":{"type":"CityObjectGroup","children":["p"]},"p":{"type":"Building","parents":["b"]}"#),
        [None; 2]
    );
}

#[test]
fn ties_to_nowhere_and_in_a_circle_are_counted() {
    let lost = read(&text(r#""p":{"type":"BuildingPart","parents":["gone"]}"#));
    assert_eq!(
        (lost.objects[0].parent, skipped(&lost)),
        (None, vec![("parents and children that the file does not have", 1, "p")])
    );
    let circle = read(&text(
        r#""a":{"type":"X","parents":["b"]},"b":{"type":"X","parents":["a"]},"c":{"type":"X","parents":["c"]}"#,
    ));
    assert!(circle.objects.iter().all(|object| object.parent.is_none()));
    assert_eq!(skipped(&circle), [("objects that are parts of themselves", 2, "a")]);
}

#[test]
fn the_reference_system_is_kept_as_it_is_spelled() {
    let crs = |metadata: &str| read(&building("").replacen('{', &format!("{{\"metadata\":{metadata},"), 1)).crs;
    assert_eq!(
        crs(r#"{"referenceSystem":"urn:ogc:def:crs:EPSG::7415"}"#).as_deref(),
        Some("urn:ogc:def:crs:EPSG::7415")
    );
    assert_eq!(crs(r#"{"crs":{"epsg":28992}}"#).as_deref(), Some("EPSG:28992"));
    assert_eq!(crs(r#"{"referenceSystem":2056}"#).as_deref(), Some("EPSG:2056"));
    assert_eq!(crs(r#"{"title":"x","referenceSystem":null}"#), None);
    assert_eq!(crs("[]"), None);
}

const TEMPLATES: &str = r#""geometry-templates":{"templates":[{"type":"MultiPoint","boundaries":[0]},
    {"type":"MultiSurface","lod":"3","boundaries":[[[1,2,3]]],"semantics":{"surfaces":[{"type":"RoofSurface"}],"values":[0]}}],
    "vertices-templates":[[9,9,9],[0,0,0],[1,0,0],[0,1,0]]},"#;

fn instance(more: &str) -> String {
    building(&format!(r#"{{"type":"GeometryInstance",{more}}}"#)).replacen('{', &format!("{{{TEMPLATES}"), 1)
}

#[test]
fn templates_stand_where_their_instances_put_them() {
    let file = read(&instance(
        r#""template":1,"boundaries":[6],"transformationMatrix":[0,-2,0,5, 2,0,0,0, 0,0,1,1, 0,0,0,1]"#,
    ));
    assert_eq!(file.surfaces.len(), 1);
    assert_eq!((file.surfaces[0].lod, file.surfaces[0].kind), (Some(Lod(3, 0)), Some(SurfaceKind::Roof)));
    let ring: Vec<[f64; 3]> = file.ring(0).iter().map(|&at| file.positions[at as usize]).collect();
    assert_eq!(ring, [[106.0, 201.0, 12.0], [106.0, 203.0, 12.0], [104.0, 201.0, 12.0]]);
    assert_eq!(skipped(&read(&instance(r#""template":0,"boundaries":[0]"#))), [("points and lines", 1, "b")]);
}

#[test]
fn instances_that_cannot_be_placed_are_refused_with_their_object() {
    for (more, says) in [
        (r#""template":2,"boundaries":[0]"#, "index 2 points outside the 2 templates"),
        (r#""boundaries":[0]"#, "`template` is missing"),
        (r#""template":1,"boundaries":[8]"#, "index 8 points outside the 8 vertices"),
        (r#""template":1,"boundaries":[]"#, "the place of a GeometryInstance"),
        (r#""template":1,"boundaries":[0],"transformationMatrix":[1,2]"#, "has 2 numbers, expected 16"),
        (r#""template":1,"boundaries":[0],"transformationMatrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]"#, "the last row"),
        (
            r#""template":1,"boundaries":[0],"transformationMatrix":[1e300,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#,
            "is not a finite number",
        ),
    ] {
        let (message, object, line, _) = refused(&instance(more));
        assert!(message.contains(says) && object.as_deref() == Some("b") && line > 0, "{message} {object:?}");
    }
}

#[test]
fn many_instances_of_a_large_template_are_refused_before_memory_is_taken() {
    let ring: Vec<String> = (0..200).map(|at| (at % 4).to_string()).collect();
    let surfaces = vec![format!("[[{}]]", ring.join(",")); 200].join(",");
    let template = format!(r#"{{"type":"MultiSurface","boundaries":[{surfaces}]}}"#);
    let templates = format!(
        r#""geometry-templates":{{"templates":[{template}],"vertices-templates":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}},"#
    );
    let instances = vec![r#"{"type":"GeometryInstance","template":0,"boundaries":[0]}"#; 10_000].join(",");
    let (message, object, ..) = refused(&building(&instances).replacen('{', &format!("{{{templates}"), 1));
    assert!(message.contains("too many for") && object.as_deref() == Some("b"), "{message}");
}

const HEADER: &str = r#"{"type":"CityJSON","version":"1.1","transform":{"scale":[1,1,1],"translate":[10,0,0]},"CityObjects":{},"vertices":[]}"#;

fn feature(id: &str) -> String {
    format!(
        r#"{{"type":"CityJSONFeature","id":"{id}","CityObjects":{{"{id}":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}}]}}}},"vertices":[[0,0,0],[1,0,0],[0,1,0]]}}"#
    )
}

#[test]
fn features_of_a_sequence_have_vertices_of_their_own_and_the_headers_transform() {
    let file = read(&format!("{HEADER}\n{}\n{}\n", feature("a"), feature("b")));
    assert_eq!((file.format.as_str(), file.surfaces.len(), file.positions.len()), ("CityJSON 1.1 Seq", 2, 6));
    assert_eq!(file.positions[3..], [[10.0, 0.0, 0.0], [11.0, 0.0, 0.0], [10.0, 1.0, 0.0]]);
    assert_eq!((file.surfaces[1].object, file.ring(1)), (1, &[3, 4, 5][..]));
    assert_eq!(read(&format!("\u{feff}{HEADER}")).format, "CityJSON 1.1");
}

#[test]
fn a_feature_without_its_header_is_refused_with_the_remedy() {
    let (message, _, line, _) = refused(&feature("a"));
    assert!(message.contains("without the header line") && line == 1, "{message}");
    let (message, _, line, _) = refused(&format!("{HEADER}\n{HEADER}\n"));
    assert!(message.contains("type CityJSON, expected CityJSONFeature") && line == 2, "{message}");
}

#[test]
fn a_cut_file_is_told_as_such_with_the_place_of_its_end() {
    let whole = building(&solid(""));
    let (message, ..) = refused(&whole[..whole.len() - 1]);
    assert!(message.contains("cut off"), "{message}");
    let sequence = format!("{HEADER}\n{}\n{}", feature("a"), feature("b"));
    let (message, _, line, _) = refused(&sequence[..sequence.len() - 40]);
    assert!(message.contains("cut off") && line == 3, "{message}, line {line}");
    assert!(refused("").0.contains("cut off"));
}

#[test]
fn what_is_wrong_is_told_with_object_line_and_column() {
    let column_of = |text: &str, part: &str| text.find(part).unwrap() + 1;
    for (geometry, says, part) in [
        (r#"{"type":"MultiSurface","boundaries":[[[0,1,88]]]}"#, "index 88 points outside the 8 vertices", "88"),
        (
            r#"{"type":"MultiSurface","boundaries":[[[0,1,99999999999]]]}"#,
            "index 99999999999 points outside",
            "99999999999",
        ),
        (r#"{"type":"MultiSurface","boundaries":[[[0,1,-7]]]}"#, "`-7` is no index", "-7"),
        (r#"{"type":"MultiSurface","boundaries":[[[0,1,2.5]]]}"#, "`2.5` is no index", "2.5"),
        (
            r#"{"type":"MultiSurface","boundaries":[[[[[77]]]]]}"#,
            "boundaries: `[` at nesting depth 4, expected an index at depth 3",
            "[[77",
        ),
        (r#"{"type":"Solid","boundaries":[[[77]]]}"#, "boundaries: `77` at nesting depth 3", "77"),
        (r#"{"type":"Solid","boundaries":"77"}"#, "boundaries: `\"77\"`", "\"77"),
        (r#"{"type":77,"boundaries":[]}"#, "invalid type: integer `77`", "7,"),
    ] {
        let text = building(geometry);
        let (message, object, line, column) = refused(&text);
        assert!(message.contains(says) && object.as_deref() == Some("b"), "{message} {object:?}");
        assert_eq!((line, column), (1, column_of(&text, part)), "{message}");
    }
}

#[test]
fn vertices_are_three_finite_numbers_each() {
    for (vertices, says) in [
        ("[[0,0]]", "vertices: `2 numbers` at nesting depth 2, expected three numbers"),
        ("[[0,0,0,0]]", "vertices: `4 numbers`"),
        ("[[0,0,1e99]]", "`1e99` is not a finite number"),
        ("[[0,0,1e999]]", "`1e999` is not a finite number"),
        ("[[0,0,null]]", "`null` is not a finite number"),
        ("[0,0,0]", "vertices: `0` at nesting depth 1"),
        ("[[[0,0,0]]]", "vertices: `[` at nesting depth 3"),
    ] {
        let (message, _, line, column) = refused(&building("").replace(CUBE, vertices));
        assert!(message.contains(says) && line == 1 && column > 1, "{message}");
    }
}

#[test]
fn other_versions_types_and_transforms_are_refused() {
    let sound = building("");
    for (from, to, says) in [
        ("\"2.0\"", "\"0.9\"", "version 0.9, expected 1.0, 1.1 or 2.0"),
        ("\"2.0\"", "\"2.01\"", "version 2.01"),
        ("\"2.0\"", "3", "version 3"),
        ("\"version\"", "\"verse\"", "`version` is missing"),
        ("\"CityJSON\"", "\"Topology\"", "type Topology, expected CityJSON"),
        ("\"type\"", "\"kind\"", "`type` is missing"),
        ("[0.5,0.5,0.25]", "[0.5,0,0.25]", "the transform's scale is [0.5, 0, 0.25]"),
        ("[0.5,0.5,0.25]", "[0.5,-0.5,0.25]", "above 0"),
        ("[0.5,0.5,0.25]", "[0.5]", "the JSON is broken: invalid length 1"),
    ] {
        let message = refused(&sound.replacen(from, to, 1)).0;
        assert!(message.contains(says), "{message}, expected {says}");
    }
    let error = read_cityjson(b"{\"type\":\"City\xFFJSON\"}").unwrap_err();
    assert_eq!((error.problem, error.column), (CityJsonProblem::NotUtf8, 14));
}

#[test]
fn arrays_nested_without_end_neither_overflow_nor_hang() {
    let deep = format!("{}{}", "[".repeat(200_000), "]".repeat(200_000));
    assert!(refused(&building(&format!(r#"{{"type":"Solid","boundaries":{deep}}}"#))).0.contains("nesting depth 5"));
    assert!(refused(&building("").replace(CUBE, &deep)).0.contains("nesting depth 3"));
    let semantics = format!(r#","semantics":{{"surfaces":[],"values":{deep}}}"#);
    read(&building(&solid(&semantics)));
    read(&building("").replacen('{', &format!("{{\"metadata\":{deep},\"x\":{deep},"), 1));
}

/// Whatever becomes of a text, it is read or refused.
fn survives(text: &[u8]) {
    if let Ok(file) = read_cityjson(text) {
        for surface in &file.surfaces {
            for ring in surface.first_ring..surface.first_ring + surface.ring_count {
                assert!(file.ring(ring).iter().all(|&at| (at as usize) < file.positions.len()));
            }
            assert!((surface.object as usize) < file.objects.len());
        }
        assert!(file.positions.as_flattened().iter().all(|value| value.is_finite()));
    }
}

#[test]
fn cut_or_changed_at_any_byte_a_text_is_read_or_refused() {
    let semantics = r#","semantics":{"surfaces":[{"type":"WallSurface"}],"values":[[0,0,null]]}"#;
    let one = building(&solid(semantics)).replacen('{', &format!("{{{TEMPLATES}"), 1);
    let other = instance(r#""template":1,"boundaries":[6],"transformationMatrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"#);
    let sequence = format!("{HEADER}\n{}\n{}\n", feature("a"), feature("b"));
    for text in [one, other, sequence] {
        let text = text.as_bytes();
        for at in 0..text.len() {
            survives(&text[..at]);
            for byte in [b'[', b']', b'"', b',', b'9', 0xFF] {
                let mut changed = text.to_vec();
                changed[at] = byte;
                survives(&changed);
                changed.insert(at, text[at]);
                survives(&changed);
            }
            let mut without = text.to_vec();
            without.remove(at);
            survives(&without);
        }
    }
}
