//! Every reader knows its own files by their first bytes, and no other's.

use crate::format::citygml::is_citygml;
use crate::format::footprints::{is_geopackage, is_shapefile, tests};
use crate::format::gltf::is_glb;
use crate::format::meshes::{self, is_ply_mesh, is_stl};
use crate::format::tileset::{is_tile, is_tileset};

type Recogniser = (&'static str, fn(&[u8]) -> bool);

const RECOGNISERS: [Recogniser; 8] = [
    ("CityGML", is_citygml),
    ("Shapefile", is_shapefile),
    ("GeoPackage", is_geopackage),
    ("tileset", is_tileset),
    ("tile", is_tile),
    ("STL", is_stl),
    ("PLY mesh", is_ply_mesh),
    ("GLB", is_glb),
];

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("a.gpkg");
    drop(tests::geopackage(&package));
    let text = |text: &str| text.as_bytes().to_vec();
    vec![
        ("CityGML", text("<CityModel xmlns='http://www.opengis.net/citygml/2.0'/>")),
        ("CityGML", text("\u{feff}\n<!-- solid facet --><a:CityModel xmlns:a='http://www.opengis.net/citygml/3.0'/>")),
        ("Shapefile", tests::shp(5, &[])),
        ("GeoPackage", std::fs::read(package).unwrap()),
        ("tileset", text(r#"{"asset": {"version": "1.0"}, "geometricError": 1, "root": {}}"#)),
        ("tile", include_bytes!("../../../tests/data/formats/house.b3dm").to_vec()),
        ("STL", text(meshes::tests::TEXT_STL)),
        ("STL", meshes::tests::binary_stl("solid", 2)),
        ("PLY mesh", text(meshes::tests::TEXT_PLY)),
        ("PLY mesh", meshes::tests::binary_ply(true)),
        ("none", text("<?xml version='1.0'?><COLLADA/>")),
        ("GLB", text("glTF\u{2}\0\0\0")),
        ("none", text("{\"asset\": {\"version\": \"2.0\"}}")),
        ("none", text("{\"type\": \"CityJSON\"}")),
        ("none", text("<kml/>")),
        ("none", text("v 0 0 0\nf 1 1 1\n")),
        ("none", text("SQLite format 3\0")),
        ("none", Vec::new()),
    ]
}

#[test]
fn every_file_is_known_by_its_own_reader_alone() {
    for (format, bytes) in samples() {
        let known: Vec<&str> = RECOGNISERS.iter().filter(|(_, is)| is(&bytes)).map(|(name, _)| *name).collect();
        let expected = if format == "none" { vec![] } else { vec![format] };
        assert_eq!(known, expected, "{}", String::from_utf8_lossy(&bytes[..bytes.len().min(60)]));
    }
}

#[test]
fn a_few_first_bytes_are_enough_or_are_unknown() {
    for (format, bytes) in samples() {
        for end in 0..bytes.len().min(100) {
            for (name, is) in RECOGNISERS {
                assert!(!is(&bytes[..end]) || name == format, "{name} from {end} bytes of {format}");
            }
        }
    }
}
