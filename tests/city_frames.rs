//! Cities of several files, in other units, axes and degrees, brought into one frame: what is decided, and what is said of it.

use std::path::PathBuf;

use cityweld::types::{CityDefect, CityError, Lod};
use cityweld::{CityLod, CityModel, CityOptions, CityUnit, CityUp, read_city, read_city_files};

/// Corners of a box and its six sides, outward.
fn cube([x, y, z]: [f64; 3], [across, along, high]: [f64; 3]) -> Vec<[f64; 3]> {
    let corner = |at: usize| {
        let (right, back, top) = (matches!(at % 4, 1 | 2), at % 4 >= 2, at >= 4);
        let step = |on: bool, size: f64| if on { size } else { 0.0 };
        [x + step(right, across), y + step(back, along), z + step(top, high)]
    };
    (0..8).map(corner).collect()
}

const SHELL: &str = "[[[3,2,1,0]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]";

/// A CityJSON text of boxes without a transform, each a building with one solid; `more` are further members.
fn city(boxes: &[(&str, Vec<[f64; 3]>)], more: &str) -> String {
    let mut objects = Vec::new();
    let mut vertices = Vec::new();
    for (id, corners) in boxes {
        let first = vertices.len();
        let mut shell = String::new();
        for c in SHELL.chars() {
            match c.to_digit(10) {
                Some(digit) => shell += &(first + digit as usize).to_string(),
                None => shell.push(c),
            }
        }
        let solid = format!(r#"{{"type":"Solid","lod":"2","boundaries":[{shell}]}}"#);
        objects.push(format!(r#""{id}":{{"type":"Building","geometry":[{solid}]}}"#));
        vertices.extend(corners.iter().map(|[x, y, z]| format!("[{x},{y},{z}]")));
    }
    format!(
        r#"{{"type":"CityJSON","version":"2.0",{more}"CityObjects":{{{}}},"vertices":[{}]}}"#,
        objects.join(","),
        vertices.join(",")
    )
}

/// Six houses of 8 x 9 x 7 in a row that runs to the east.
fn row(unit: f64) -> Vec<(&'static str, Vec<[f64; 3]>)> {
    let names = ["a", "b", "c", "d", "e", "f"];
    let house = |(at, name)| (name, cube([10.0 + 12.0 * at as f64, 50.0, 2.0], [8.0, 9.0, 7.0]));
    let scaled = |(name, corners): (_, Vec<[f64; 3]>)| (name, corners.iter().map(|c| c.map(|v| v / unit)).collect());
    names.into_iter().enumerate().map(house).map(scaled).collect()
}

fn folder(files: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn try_text(text: &str, options: &CityOptions) -> Result<CityModel, CityError> {
    let folder = folder(&[("city.json", text.to_owned())]);
    read_city(&folder.path().join("city.json"), &[], options)
}

fn read_text(text: &str, options: &CityOptions) -> CityModel {
    try_text(text, options).unwrap_or_else(|error| panic!("{error}"))
}

fn said(model: &CityModel) -> String {
    model.warnings.iter().map(|warning| format!("{warning}\n")).collect()
}

fn extent(model: &CityModel) -> [[f64; 3]; 2] {
    let (low, high) = model.bounds().unwrap();
    [(low + model.origin).into(), (high + model.origin).into()]
}

fn assert_close(found: [[f64; 3]; 2], expected: [[f64; 3]; 2], tolerance: f64) {
    let off = found.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < tolerance, "{found:?}, expected {expected:?}");
}

const PLACE: [[f64; 3]; 2] = [[10.0, 50.0, 2.0], [78.0, 59.0, 9.0]];

fn swapped(boxes: Vec<(&str, Vec<[f64; 3]>)>) -> Vec<(&str, Vec<[f64; 3]>)> {
    boxes.into_iter().map(|(name, corners)| (name, corners.iter().map(|&[x, y, z]| [y, x, z]).collect())).collect()
}

#[test]
fn a_plain_row_of_houses_says_nothing() {
    let model = read_text(&city(&row(1.0), ""), &CityOptions::default());
    assert_eq!(said(&model), "");
    assert_eq!((model.objects.len(), model.facets.len(), model.crs.clone()), (6, 36, None));
    assert_close(extent(&model), PLACE, 1e-9);
}

#[test]
fn north_before_east_is_exchanged_by_the_volume_of_shells_with_a_warning() {
    let model = read_text(&city(&swapped(row(1.0)), ""), &CityOptions::default());
    assert_close(extent(&model), PLACE, 1e-9);
    let said = said(&model);
    assert!(said.contains("6 of 6 closed shells are inside out") && said.contains("exchanged"), "{said}");
    assert_eq!(said.lines().count(), 1, "after the exchange nothing is inside out: {said}");
}

#[test]
fn a_few_shells_wound_inwards_do_not_exchange_the_axes() {
    let mut boxes = row(1.0);
    boxes[0].1.swap(0, 1);
    boxes[0].1.swap(2, 3);
    boxes[0].1.swap(4, 5);
    boxes[0].1.swap(6, 7);
    let model = read_text(&city(&boxes, ""), &CityOptions::default());
    assert_close(extent(&model), PLACE, 1e-9);
    assert!(matches!(model.warnings[0].defect, CityDefect::InsideOut { of: 6 }), "{}", said(&model));
}

/// The range of coordinates of a known system is certain, so shells that are all wound inwards do not mirror the city.
#[test]
fn the_range_of_the_reference_system_outweighs_the_volume_of_shells() {
    let crs = r#""metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/7415"},"#;
    let moved = |boxes: Vec<(&'static str, Vec<[f64; 3]>)>, by: [f64; 2]| -> Vec<(&str, Vec<[f64; 3]>)> {
        let shift = |[x, y, z]: [f64; 3]| [x + by[0], y + by[1], z];
        boxes.into_iter().map(|(name, corners)| (name, corners.into_iter().map(shift).collect())).collect()
    };
    let inwards = moved(swapped(row(1.0)), [85_000.0, 446_000.0]);
    let model = read_text(&city(&inwards, crs), &CityOptions::default());
    assert!(said(&model).contains("6 objects are wound inside out"), "{}", said(&model));
    assert_close(extent(&model), [[85_050.0, 446_010.0, 2.0], [85_059.0, 446_078.0, 9.0]], 1e-6);
    let crs_of_model = model.crs.as_ref().unwrap();
    assert_eq!((crs_of_model.epsg, crs_of_model.vertical.as_deref()), (Some(7415), Some("NAP height")));
    let north_first = swapped(moved(row(1.0), [85_000.0, 446_000.0]));
    let model = read_text(&city(&north_first, crs), &CityOptions::default());
    assert_close(extent(&model), [[85_010.0, 446_050.0, 2.0], [85_078.0, 446_059.0, 9.0]], 1e-6);
}

#[test]
fn degrees_are_projected_about_the_middle_with_a_warning() {
    // At 42.938 degrees north a degree of longitude is 81,574 m, of latitude 111,087 m.
    let house = |name, at: f64| (name, cube([141.437 + at, 42.938, 90.0], [1e-4, 1e-4, 8.0]));
    let boxes = vec![house("a", 0.0), house("b", 3e-4), house("c", 6e-4)];
    for (text, order) in [(city(&boxes, ""), "longitude first"), (city(&swapped(boxes.clone()), ""), "latitude first")]
    {
        let model = read_text(&text, &CityOptions::default());
        let said = said(&model);
        assert!(said.contains("coordinates are degrees") && said.contains(order), "{said}");
        let [low, high] = extent(&model);
        assert!((high[0] - low[0] - 7e-4 * 81_574.0).abs() < 0.1, "{low:?} {high:?}");
        assert!((high[1] - low[1] - 1e-4 * 111_087.0).abs() < 0.1, "{low:?} {high:?}");
        assert_eq!((low[2], high[2]), (90.0, 98.0));
        assert!(low[0].abs() < 100.0 && low[1].abs() < 100.0);
        assert!(model.crs.unwrap().text.starts_with("+proj=tmerc +lat_0=42.938 +lon_0=141.437"));
    }
}

#[test]
fn latitude_is_first_where_the_code_of_the_system_says_so_and_no_shell_does() {
    let text = |crs: &str| {
        let house = city(&[("a", cube([52.0, 4.5, 0.0], [1e-4, 1e-4, 8.0]))], crs);
        house
            .replace("Solid", "MultiSurface")
            .replace("\"boundaries\":[[[[", "\"boundaries\":[[[")
            .replace("]]]]}", "]]]}")
    };
    let model = read_text(&text(r#""metadata":{"referenceSystem":"EPSG:4979"},"#), &CityOptions::default());
    assert!(said(&model).contains("latitude first") && said(&model).contains("latitude 52.000, longitude 4.500"));
    let model = read_text(&text(""), &CityOptions::default().with_crs("urn:ogc:def:crs:OGC:1.3:CRS84"));
    assert!(said(&model).contains("longitude first"), "{}", said(&model));
}

#[test]
fn houses_of_odd_heights_name_the_unit_and_the_option_turns_it() {
    for (unit, word, says) in [
        (CityUnit::Centimetre, "cm", "look like centimetres"),
        (CityUnit::Millimetre, "mm", "look like millimetres"),
        (CityUnit::Foot, "ft", "if coordinates are feet"),
    ] {
        let text = city(&row(unit.metres()), "");
        let told = said(&read_text(&text, &CityOptions::default()));
        assert!(told.contains(says) && told.contains(&format!("--city-unit {word}")), "{told}");
        let model = read_text(&text, &CityOptions::default().with_unit(unit));
        assert_eq!(said(&model), "");
        assert_close(extent(&model), PLACE, 1e-6);
    }
    let metres = read_text(&city(&row(1.0), ""), &CityOptions::default().with_unit(CityUnit::Metre));
    assert_close(extent(&metres), PLACE, 1e-9);
}

/// Houses turned by 30 degrees about up, y up as modellers write them.
fn y_up_obj() -> String {
    let mut text = String::new();
    for at in 0..6 {
        let corners = cube([12.0 * f64::from(at), 0.0, 0.0], [8.0, 9.0, 7.0]);
        let (sin, cos) = 30_f64.to_radians().sin_cos();
        text += &format!("o house{at}\n");
        for [x, y, z] in corners {
            text += &format!("v {} {} {}\n", cos * x - sin * y, z, -(sin * x + cos * y));
        }
        for side in ["4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"] {
            let corners = side.split(' ').map(|digit| (8 * at + digit.parse::<i32>().unwrap()).to_string());
            text += &format!("f {}\n", corners.collect::<Vec<_>>().join(" "));
        }
    }
    text
}

#[test]
fn facets_upright_about_y_suggest_the_option_that_turns_them() {
    let folder = folder(&[("city.obj", y_up_obj())]);
    let path = folder.path().join("city.obj");
    let told = said(&read_city(&path, &[], &CityOptions::default()).unwrap());
    assert!(told.contains("try --city-up y"), "{told}");
    let model = read_city(&path, &[], &CityOptions::default().with_up(CityUp::Y)).unwrap();
    assert_eq!(said(&model), "");
    assert_eq!([extent(&model)[0][2], extent(&model)[1][2]], [0.0, 7.0]);
}

#[test]
fn an_origin_is_added_to_every_coordinate() {
    let options = CityOptions::default().with_origin([90_400.0, 435_400.0, -1.0]);
    let model = read_text(&city(&row(1.0), ""), &options);
    assert_close(extent(&model), [[90_410.0, 435_450.0, 1.0], [90_478.0, 435_459.0, 8.0]], 1e-6);
    let far = try_text(&city(&row(1.0), ""), &CityOptions::default().with_origin([1e300, 0.0, 0.0])).unwrap_err();
    assert!(matches!(far, CityError::OutOfReach { .. }), "{far}");
}

#[test]
fn a_folder_is_one_city_with_one_origin_and_what_is_no_city_is_counted() {
    let boxes = row(1.0);
    let folder = folder(&[
        ("b.city.json", city(&boxes[3..], "")),
        ("a.city.json", city(&boxes[..3], "")),
        ("notes.txt", "read me".into()),
        ("houses.json", r#"{"type":"FeatureCollection","features":[]}"#.into()),
        (".hidden.obj", "v 0 0".into()),
    ]);
    let model = read_city(folder.path(), &[], &CityOptions::default()).unwrap();
    let names: Vec<_> = model.sources.iter().map(|source| source.path.file_name().unwrap().to_owned()).collect();
    assert_eq!((names, model.objects.concat()), (vec!["a.city.json".into(), "b.city.json".into()], "abcdef".into()));
    assert_close(extent(&model), PLACE, 1e-9);
    assert_eq!(said(&model), "2 files of the folder are no city models, passed over; first: houses.json\n");
}

#[test]
fn tiles_that_share_an_object_or_have_none_are_told() {
    let boxes = row(1.0);
    let folder =
        folder(&[("a.json", city(&boxes[..4], "")), ("b.json", city(&boxes[3..], "")), ("c.json", city(&[], ""))]);
    let told = said(&read_city(folder.path(), &[], &CityOptions::default()).unwrap());
    assert!(told.contains("1 object has the name of one in another file of the city"), "{told}");
    assert!(told.contains("object d, b.json"), "{told}");
    assert!(told.contains("1 file of the city has no polygons, passed over; first: c.json"), "{told}");
}

#[test]
fn several_files_are_one_city_too_and_a_broken_tile_is_named() {
    let boxes = row(1.0);
    let folder = folder(&[("a.json", city(&boxes[..3], "")), ("b.json", city(&boxes[3..], ""))]);
    let paths: Vec<PathBuf> = ["a.json", "b.json"].map(|name| folder.path().join(name)).to_vec();
    assert_eq!(read_city_files(&paths, &[], &CityOptions::default()).unwrap().objects.len(), 6);
    std::fs::write(&paths[1], city(&boxes[3..], "").trim_end_matches('}')).unwrap();
    for error in [
        read_city_files(&paths, &[], &CityOptions::default()).unwrap_err(),
        read_city(folder.path(), &[], &CityOptions::default()).unwrap_err(),
    ] {
        assert!(error.to_string().contains("cut off") && error.to_string().contains("b.json:1:"), "{error}");
    }
}

#[test]
fn a_folder_without_a_city_says_what_is_in_it() {
    let notes = folder(&[("notes.txt", String::new()), ("notes.md", String::new())]);
    let error = read_city(notes.path(), &[], &CityOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no city model in it, 2 other files in it, such as notes.md"), "{error}");
    let error = read_city(folder(&[]).path(), &[], &CityOptions::default()).unwrap_err().to_string();
    assert!(error.contains("it is empty"), "{error}");
}

#[test]
fn files_in_different_systems_are_told() {
    let with = |name, code: u32| {
        let crs = format!(r#""metadata":{{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/{code}"}},"#);
        (name, city(&row(1.0), &crs))
    };
    let folder = folder(&[with("a.json", 25832), with("b.json", 25833)]);
    let told = said(&read_city(folder.path(), &[], &CityOptions::default()).unwrap());
    assert!(
        told.contains("the reference systems differ: https://www.opengis.net/def/crs/EPSG/0/25832 is used"),
        "{told}"
    );
    let model = read_text(&city(&row(1.0), ""), &CityOptions::default().with_crs("EPSG:25832+7837"));
    let crs = model.crs.unwrap();
    assert_eq!((crs.epsg, crs.vertical.as_deref()), (Some(25832), Some("DHHN2016 height")));
}

/// One building of LoD 0 and 1 with a part of LoD 2, one of LoD 0 and 1, one footprint.
fn levels() -> String {
    let surface =
        |lod: &str, ring: &str| format!(r#"{{"type":"MultiSurface","lod":"{lod}","boundaries":[[[{ring}]]]}}"#);
    let (low, walls, roof) = (surface("0", "0,1,2,3"), surface("1", "0,1,5,4"), surface("2", "4,5,6,7"));
    let vertices = r#"[[0,0,0],[9,0,0],[9,9,0],[0,9,0],[0,0,9],[9,0,9],[9,9,9],[0,9,9]]"#;
    format!(
        r#"{{"type":"CityJSON","version":"1.1","CityObjects":{{
        "a":{{"type":"Building","children":["a1"],"geometry":[{low},{walls}]}},
        "a1":{{"type":"BuildingPart","parents":["a"],"geometry":[{roof}]}},
        "b":{{"type":"Building","geometry":[{low},{walls}]}},
        "c":{{"type":"Building","geometry":[{low}]}}}},"vertices":{vertices}}}"#
    )
}

/// Heights of the facets' middles by object.
fn facets(model: &CityModel) -> Vec<(String, f64)> {
    let middle = |facet: &cityweld::Facet| {
        let sum: f64 = facet.outline.iter().map(|&at| model.vertices[at as usize].z + model.origin.z).sum();
        sum / facet.outline.len() as f64
    };
    model.facets.iter().map(|facet| (model.object_name(facet.object).to_owned(), middle(facet))).collect()
}

#[test]
fn each_object_has_its_highest_level_and_footprints_are_counted() {
    let model = read_text(&levels(), &CityOptions::default());
    assert_eq!(facets(&model), [("a".into(), 9.0), ("b".into(), 4.5)]);
    let told = said(&model);
    let footprint =
        "1 polygon is the footprint of an object that has nothing above level of detail 0, left out; first: object c";
    assert!(told.contains(footprint), "{told}");
}

#[test]
fn a_wanted_level_is_a_limit_from_above() {
    let up_to = |lod| CityOptions::default().with_lod(CityLod::UpTo(lod));
    let model = read_text(&levels(), &up_to(Lod(1, 255)));
    assert_eq!(facets(&model), [("a".into(), 4.5), ("b".into(), 4.5)]);
    assert!(said(&model).contains("1 polygon is of a higher level of detail than --lod wants"), "{}", said(&model));
    let error = try_text(&levels().replace("\"1\"", "\"3\""), &up_to(Lod(1, 255))).unwrap_err();
    assert!(matches!(error, CityError::AboveWantedLevel { count: 3, .. }), "{error}");
}

#[test]
fn footprints_alone_are_no_city_but_may_be_terrain() {
    let text = levels().replace("\"1\"", "\"0\"").replace("\"2\"", "\"0\"");
    let error = try_text(&text, &CityOptions::default()).unwrap_err();
    assert!(matches!(error, CityError::OnlyFootprints { count: 6, .. }), "{error}");
    assert!(error.to_string().contains("level 1 or higher"), "{error}");
    let folder = folder(&[("city.json", city(&row(1.0), "")), ("ground.json", text)]);
    let paths = ["city.json", "ground.json"].map(|name| folder.path().join(name));
    let model = read_city(&paths[0], &paths[1..], &CityOptions::default()).unwrap();
    assert_eq!(model.sources[1].facets.len(), 6);
}

fn refused(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    read_city(&folder.path().join(name), &[], &CityOptions::default()).unwrap_err().to_string()
}

#[test]
fn what_is_not_read_is_named_with_what_to_do() {
    let three_ds = [&b"MM\x0A\0\0\0"[..], &[0; 4]].concat();
    for (name, bytes, says) in [
        ("a.skp", &b"\xFF\xFE\xFF\x0ES\0k\0e\0t\0c\0h\0U\0p\0 \0M\0"[..], "a SketchUp file, expected a city model"),
        ("a.blend", b"BLENDER-v300", "export OBJ or glTF from Blender"),
        ("a.fbx", b"Kaydara FBX Binary  \0", "an FBX file"),
        ("a.dwg", b"AC1032", "a DWG drawing"),
        ("a.dxf", b"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", "a DXF drawing"),
        ("a.ifc", b"ISO-10303-21;\nHEADER;", "IfcConvert"),
        ("a.3ds", &three_ds, "a 3DS file"),
        ("a.7z", b"7z\xBC\xAF\x27\x1C\0", "a 7-Zip archive"),
        ("a.pdf", b"%PDF-1.7", "a PDF document"),
        ("a.las", b"LASF\0", "a LAS cloud"),
        ("a.json", br#"{"features":[],"type":"FeatureCollection"}"#, "this is GeoJSON"),
        ("a.json", br#"{"nothing":"known"}"#, "this JSON is no city model"),
        ("a.json", br#"{"nothing":"#, "this JSON is broken"),
        ("a.json", b"[1, 2]", "this JSON is no city model"),
        ("a.html", b"<!DOCTYPE html><html>", "this is a web page"),
    ] {
        let message = refused(name, bytes);
        assert!(message.contains(says) && message.contains(name), "{message}, expected {says}");
    }
}

#[test]
fn a_type_that_stands_at_the_end_is_found() {
    let text = city(&row(1.0), "").replacen(r#""type":"CityJSON","#, "", 1);
    let long = "[0,0,0],".repeat(20_000);
    let text = format!("{},\"padding\":[{}0],\"type\":\"CityJSON\"}}", text.trim_end_matches('}'), long);
    let model = read_text(&text, &CityOptions::default());
    assert_eq!(model.facets.len(), 36);
}
