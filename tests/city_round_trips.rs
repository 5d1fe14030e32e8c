//! One city in all units and axes, from its text and from its index: the same facets.

use std::collections::BTreeSet;
use std::fs;

use cityweld::types::CityError;
use cityweld::{
    CityModel, CityOptions, CityUnit, CityUp, PlanBox, Vector3, read_city, read_city_within, write_city_index,
};
use proptest::prelude::*;

fn place(most: f64) -> impl Strategy<Value = [f64; 3]> {
    [-most..most, -most..most, -most..most]
}

/// A box of a city: its corner, and how far it goes along each axis.
type Block = ([f64; 3], [f64; 3]);

fn blocks() -> impl Strategy<Value = Vec<Block>> {
    // Apart along x, so that none touches another; sides of houses.
    prop::collection::vec((place(200.0), [4.0..40.0_f64, 4.0..40.0, 3.0..30.0]), 1..12).prop_map(|blocks| {
        let spread = |(at, ([_, y, _], size)): (usize, Block)| ([300.0 * at as f64, y, 0.0], size);
        blocks.into_iter().enumerate().map(spread).collect()
    })
}

/// The boxes as OBJ, each an object, their corners put down by `corner`.
fn obj(blocks: &[Block], corner: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let mut text = String::new();
    for (number, (low, size)) in blocks.iter().enumerate() {
        text += &format!("o house_{number}\n");
        for i in 0..8_usize {
            let [x, y, z] = corner([0, 1, 2].map(|k| low[k] + if i >> k & 1 == 1 { size[k] } else { 0.0 }));
            text += &format!("v {x:?} {y:?} {z:?}\n");
        }
        for face in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [2, 4, 8, 6], [4, 3, 7, 8], [3, 1, 5, 7]] {
            text += &format!("f {}\n", face.map(|i| (8 * number + i).to_string()).join(" "));
        }
    }
    text
}

fn city_of(text: &str, options: &CityOptions) -> CityModel {
    read("city.obj", text.as_bytes(), options).unwrap_or_else(|error| panic!("{error}"))
}

fn read(name: &str, bytes: &[u8], options: &CityOptions) -> Result<CityModel, CityError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    read_city(&path, &[], options)
}

/// Corners of a box, and its sides as quadrilaterals that look outwards.
fn sides((low, size): &Block) -> [[[f64; 3]; 4]; 6] {
    let corner = |i: usize| [0, 1, 2].map(|k| low[k] + if i >> k & 1 == 1 { size[k] } else { 0.0 });
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]].map(|side| side.map(corner))
}

/// The boxes in formats that have other ways to put them down.
fn in_other_formats(blocks: &[Block]) -> Vec<(&'static str, Vec<u8>)> {
    let sides: Vec<[[f64; 3]; 4]> = blocks.iter().flat_map(sides).collect();
    let triangles: Vec<[[f64; 3]; 3]> = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let words = |x: &[f64; 3]| format!("{:?} {:?} {:?}", x[0], x[1], x[2]);

    let facets = triangles.iter().map(|corners| {
        let vertices = corners.map(|x| format!("vertex {}\n", words(&x))).concat();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    });
    let stl = format!("solid city\n{}endsolid city\n", facets.collect::<String>());
    let mut binary_stl = vec![b' '; 80];
    binary_stl.extend((triangles.len() as u32).to_le_bytes());
    for corners in &triangles {
        binary_stl.extend([0; 12]);
        binary_stl.extend(corners.as_flattened().iter().flat_map(|value| (*value as f32).to_le_bytes()));
        binary_stl.extend([0; 2]);
    }
    let axes = ["x", "y", "z"].map(|axis| format!("property double {axis}\n")).concat();
    let header = |format: &str| {
        let (vertices, faces) = (4 * sides.len(), sides.len());
        format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\n{axes}element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let vertices = sides.as_flattened().iter().map(|x| words(x) + "\n").collect::<String>();
    let faces = (0..sides.len()).map(|at| format!("4 {} {} {} {}\n", 4 * at, 4 * at + 1, 4 * at + 2, 4 * at + 3));
    let ply = header("ascii") + &vertices + &faces.collect::<String>();
    let mut binary_ply = header("binary_little_endian").into_bytes();
    binary_ply.extend(sides.as_flattened().as_flattened().iter().flat_map(|value| value.to_le_bytes()));
    for at in 0..sides.len() as i32 {
        binary_ply.push(4);
        binary_ply.extend((0..4).flat_map(|k| (4 * at + k).to_le_bytes()));
    }
    vec![
        ("city.stl", stl.into_bytes()),
        ("city.stl", binary_stl),
        ("city.ply", ply.into_bytes()),
        ("city.ply", binary_ply),
        ("city.city.json", cityjson(blocks).into_bytes()),
    ]
}

/// Whole millimetres, as writers of CityJSON have them.
fn cityjson(blocks: &[Block]) -> String {
    let objects = blocks.iter().enumerate().map(|(number, _)| {
        let ring = |side: usize| {
            let first = 24 * number + 4 * side;
            format!("[[{}, {}, {}, {}]]", first, first + 1, first + 2, first + 3)
        };
        let shell = (0..6).map(ring).collect::<Vec<_>>().join(", ");
        format!(
            r#""house_{number}": {{"type": "Building", "geometry": [{{"type": "Solid", "lod": "2", "boundaries": [[{shell}]]}}]}}"#
        )
    });
    let objects = objects.collect::<Vec<_>>().join(", ");
    let millimetres = |x: &[f64; 3]| format!("[{:.0}, {:.0}, {:.0}]", x[0] * 1000.0, x[1] * 1000.0, x[2] * 1000.0);
    let sides: Vec<_> = blocks.iter().flat_map(sides).collect();
    let vertices = sides.as_flattened().iter().map(millimetres).collect::<Vec<_>>().join(", ");
    format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}}, "CityObjects": {{{objects}}}, "vertices": [{vertices}]}}"#
    )
}

/// Area towards each side along each axis, then the corners of the box around everything: what no way of writing polygons changes.
fn essence(city: &CityModel) -> Vec<f64> {
    let mut areas = vec![0.0; 6];
    for facet in &city.facets {
        let normal = facet.plane.normal;
        let axis = normal.iamax();
        assert!(normal[axis].abs() > 1.0 - 1e-6, "a side of a box looks towards {normal}");
        areas[2 * axis + usize::from(normal[axis] < 0.0)] += facet.area;
    }
    let (low, high) = city.bounds().unwrap();
    areas.extend((low + city.origin).iter().chain((high + city.origin).iter()));
    areas
}

/// Each facet's object, its plane in the city's own coordinates, and its area.
fn facets(city: &CityModel) -> Vec<(String, [f64; 3], f64, f64)> {
    let of = |facet: &cityweld::Facet| {
        let normal = facet.plane.normal;
        // normal . (x - origin) + offset = 0
        (
            city.object_name(facet.object).to_owned(),
            <[f64; 3]>::from(normal),
            facet.plane.offset - normal.dot(&city.origin),
            facet.area,
        )
    };
    city.facets.iter().map(of).collect()
}

fn assert_same_city(found: &CityModel, expected: &CityModel) {
    let (found, expected) = (facets(found), facets(expected));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found.0, expected.0);
        assert!((0..3).all(|k| (found.1[k] - expected.1[k]).abs() < 1e-9), "{found:?}, expected {expected:?}");
        assert!((found.2 - expected.2).abs() < 1e-5, "{found:?}, expected {expected:?}");
        assert!((found.3 - expected.3).abs() < 1e-6 * expected.3, "{found:?}, expected {expected:?}");
    }
}

#[test]
fn a_city_that_is_cut_anywhere_is_refused_with_its_file_or_sound() {
    let blocks = [([0.0, 0.0, 0.0], [10.0, 8.0, 6.0]), ([20.0, 0.0, 0.0], [5.0, 5.0, 5.0])];
    for (name, bytes) in in_other_formats(&blocks) {
        let mut refused = 0;
        for length in 0..bytes.len() {
            match read(name, &bytes[..length], &CityOptions::default()) {
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().contains(name), "{length} bytes: {error}");
                }
                Ok(city) => {
                    assert!(!city.facets.is_empty() && city.facets.len() <= 24, "{name} of {length} bytes");
                    let is_sound = |facet: &cityweld::Facet| facet.area.is_finite() && facet.plane.offset.is_finite();
                    assert!(city.facets.iter().all(is_sound), "{name} of {length} bytes");
                }
            }
        }
        // Text without the end of its last line is whole; an STL of text may end after any facet.
        let least = if bytes.starts_with(b"solid") { bytes.len() / 10 } else { bytes.len() - 3 };
        assert!(refused >= least, "{name}: {refused} of {} cuts are refused", bytes.len());
        assert!(read(name, &bytes, &CityOptions::default()).is_ok());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_city_is_the_same_in_every_format(blocks in blocks()) {
        // Eighths of a metre, which single precision and millimetres hold alike.
        let whole = |values: [f64; 3]| values.map(|value| (8.0 * value).round() / 8.0);
        let blocks: Vec<Block> = blocks.into_iter().map(|(low, size)| (whole(low), whole(size))).collect();
        let expected = essence(&city_of(&obj(&blocks, |x| x), &CityOptions::default()));
        for (name, bytes) in in_other_formats(&blocks) {
            let city = read(name, &bytes, &CityOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
            for (found, expected) in essence(&city).iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-6 * expected.abs() + 1e-6, "{name}: {found}, expected {expected}");
            }
        }
    }

    #[test]
    fn units_and_the_axis_that_is_up_give_back_the_city_in_metres(blocks in blocks(), is_y_up: bool, unit in 0..5_usize) {
        let unit = [CityUnit::Metre, CityUnit::Centimetre, CityUnit::Millimetre, CityUnit::Foot, CityUnit::UsFoot][unit];
        let metres = city_of(&obj(&blocks, |x| x), &CityOptions::default());
        let size = unit.metres();
        let other = obj(&blocks, |[x, y, z]| if is_y_up { [x, z, -y] } else { [x, y, z] }.map(|value| value / size));
        let up = if is_y_up { CityUp::Y } else { CityUp::Z };
        let read = city_of(&other, &CityOptions::default().with_unit(unit).with_up(up));
        assert_same_city(&read, &metres);
    }

    #[test]
    fn every_facet_of_a_closed_house_looks_away_from_its_middle(blocks in blocks(), inwards: bool) {
        let mut text = obj(&blocks, |x| x);
        if inwards {
            let turned = |line: &str| match line.strip_prefix("f ") {
                Some(corners) => format!("f {}", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
                None => line.to_owned(),
            };
            text = text.lines().map(turned).collect::<Vec<_>>().join("\n");
        }
        let city = city_of(&text, &CityOptions::default());
        assert_eq!(city.facets.len(), 6 * blocks.len());
        for facet in &city.facets {
            let number: usize = city.object_name(facet.object)["house_".len()..].parse().unwrap();
            let (low, size) = blocks[number];
            let middle = Vector3::from([0, 1, 2].map(|k| low[k] + size[k] / 2.0)) - city.origin;
            let distance = facet.plane.normal.dot(&middle) + facet.plane.offset;
            assert!(distance < -1.0, "a facet of house_{number} is {distance} m from its middle");
        }
    }

    #[test]
    fn an_index_holds_the_city_and_gives_every_house_that_a_part_touches(
        blocks in blocks(), x in -500.0..4000.0_f64, y in -300.0..300.0_f64, reach in 1.0..900.0_f64,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let [city, index] = ["city.obj", "city.cwi"].map(|name| folder.path().join(name));
        fs::write(&city, obj(&blocks, |x| x)).unwrap();
        write_city_index(std::slice::from_ref(&city), &[], &CityOptions::default(), &index, &()).unwrap();
        let whole = read_city(&index, &[], &CityOptions::default()).unwrap();
        let text = read_city(&city, &[], &CityOptions::default()).unwrap();
        assert_eq!(whole.vertices, text.vertices);
        assert_eq!((&whole.objects, &whole.triangles, whole.origin), (&text.objects, &text.triangles, text.origin));
        assert_same_city(&whole, &text);

        let within = PlanBox::about([x, y], reach);
        let part = read_city_within(&[index], &[], &CityOptions::default(), &within).unwrap();
        let met = |(low, size): &Block| {
            within.gap_m(&PlanBox { low: [low[0], low[1]], high: [low[0] + size[0], low[1] + size[1]] }) == 0.0
        };
        let expected: BTreeSet<String> =
            blocks.iter().enumerate().filter(|(_, block)| met(block)).map(|(at, _)| format!("house_{at}")).collect();
        let found: BTreeSet<String> = part.objects.iter().cloned().collect();
        assert!(found.is_superset(&expected), "{expected:?} stand there, found {found:?}");
        // What is given of a part is the whole's, facet by facet.
        let of_whole = facets(&whole);
        assert!(facets(&part).iter().all(|facet| of_whole.contains(facet)));
    }
}
