//! Every reader meets files that are cut or changed at any byte: it says what is wrong, or reads something sound.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::assert_sound;
use crate::format::citygml::read_citygml;
use crate::format::footprints::{FootprintFields, read_geopackage, read_shapefile, tests};
use crate::format::meshes::{self, read_ply_mesh, read_stl};
use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::{Lod, SurfaceFile, SurfaceKind};
use crate::format::tileset::{read_tile, read_tileset};

/// Cuts the file before every byte, and changes every byte in three ways. Returns how many of these were refused.
pub fn mutate(bytes: &[u8], read: impl Fn(&[u8]) -> Result<SurfaceFile, SurfaceError>) -> usize {
    let mut refused = 0;
    let mut check = |bytes: &[u8]| match read(bytes) {
        Ok(file) => assert_sound(&file),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            refused += 1;
        }
    };
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for at in 0..bytes.len() {
        check(&bytes[..at]);
        let mut changed = bytes.to_vec();
        for byte in [changed[at] ^ 1 << (random.next_u32() % 8), 0, 0xFF] {
            changed[at] = byte;
            check(&changed);
        }
        // A byte too few and one too many.
        changed.remove(at);
        check(&changed);
    }
    refused
}

const CITYGML: &str = r##"<?xml version="1.0"?><CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:b="http://www.opengis.net/citygml/building/2.0" xmlns:gml="http://www.opengis.net/gml" xmlns:x="http://www.w3.org/1999/xlink">
<cityObjectMember><b:Building gml:id="h"><b:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember x:href="#p"/><gml:surfaceMember><gml:OrientableSurface orientation="-"><gml:baseSurface x:href="#q"/></gml:OrientableSurface></gml:surfaceMember></gml:CompositeSurface></gml:exterior></gml:Solid></b:lod2Solid>
<b:boundedBy><b:WallSurface><b:lod2MultiSurface><gml:MultiSurface srsName="EPSG:1" srsDimension="3"><gml:surfaceMember><gml:Polygon gml:id="p"><gml:exterior><gml:LinearRing><gml:posList>0 0 0 4 0 0 4 0 4 0 0 4 0 0 0</gml:posList></gml:LinearRing></gml:exterior><gml:interior><gml:LinearRing><gml:pos>1 0 1</gml:pos><gml:pos>1 0 2</gml:pos><gml:pos>2 0 2</gml:pos><gml:pos>1 0 1</gml:pos></gml:LinearRing></gml:interior></gml:Polygon></gml:surfaceMember></gml:MultiSurface></b:lod2MultiSurface></b:WallSurface></b:boundedBy></b:Building></cityObjectMember>
<cityObjectMember><v:Tree xmlns:v="v" gml:id="t"><v:lod1ImplicitRepresentation><ImplicitGeometry><transformationMatrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</transformationMatrix><relativeGMLGeometry><gml:MultiSurface gml:id="q"><gml:surfaceMember><gml:Triangle><gml:exterior><gml:LinearRing><gml:coordinates>0,0,0 1,0,0 1,1,&#48;</gml:coordinates></gml:LinearRing></gml:exterior></gml:Triangle></gml:surfaceMember></gml:MultiSurface></relativeGMLGeometry><referencePoint><gml:Point><gml:pos>7 7 7</gml:pos></gml:Point></referencePoint></ImplicitGeometry></v:lod1ImplicitRepresentation></v:Tree></cityObjectMember></CityModel>
"##;

#[test]
fn citygml_cut_or_changed_at_any_byte_is_read_or_refused() {
    let read = |bytes: &[u8]| read_citygml(bytes);
    let file = read_citygml(CITYGML.as_bytes()).unwrap();
    assert_eq!((file.surfaces.len(), file.objects.len()), (2, 2));
    let refused = mutate(CITYGML.as_bytes(), read);
    assert!(refused > CITYGML.len(), "cut files alone are as many, {refused}");
}

#[test]
fn tiles_cut_or_changed_at_any_byte_are_read_or_refused() {
    let bytes = include_bytes!("../../../tests/data/formats/house.b3dm");
    let read = |bytes: &[u8]| read_tile(bytes, std::path::Path::new("house.b3dm")).map(|file| file.surfaces);
    assert_eq!(read(bytes).unwrap().surfaces.len(), 12);
    assert!(mutate(bytes, read) > bytes.len());
}

#[test]
fn tilesets_cut_or_changed_at_any_byte_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("0.b3dm"), include_bytes!("../../../tests/data/formats/house.b3dm")).unwrap();
    let json = br#"{"asset": {"version": "1.0"}, "geometricError": 9, "root": {"refine": "ADD", "children": [{},
        {"transform": [1,0,0,0,0,1,0,0,0,0,1,0,5,5,5,1], "content": {"uri": "0.b3dm"}}]}}"#;
    let path = folder.path().join("tileset.json");
    let read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read_tileset(&path).map(|file| file.surfaces)
    };
    assert_eq!(read(json).unwrap().surfaces.len(), 12);
    assert!(mutate(json, read) > json.len());
}

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0]];

#[test]
fn shapefiles_and_tables_cut_or_changed_at_any_byte_are_read_or_refused() {
    let shp = tests::shp(5, &[vec![SQUARE.to_vec()], vec![SQUARE.to_vec()]]);
    let dbf = tests::dbf(&[("h", b'N', 3), ("i", b'I', 4)], &[" 2.5\0\0\0\0", " 3.5\0\0\0\0"]);
    let folder = tempfile::tempdir().unwrap();
    let [shapes, table] = ["a.shp", "a.dbf"].map(|name| folder.path().join(name));
    let fields = FootprintFields { height: Some("h".to_owned()), base: Some("i".to_owned()) };
    let read = |path: &std::path::Path, bytes: &[u8]| {
        std::fs::write(path, bytes).unwrap();
        read_shapefile(&shapes, &fields)
    };
    std::fs::write(&table, &dbf).unwrap();
    assert_eq!(read(&shapes, &shp).unwrap().surfaces.len(), 12);
    assert!(mutate(&shp, |bytes| read(&shapes, bytes)) > shp.len() / 2);
    std::fs::write(&shapes, &shp).unwrap();
    assert!(mutate(&dbf, |bytes| read(&table, bytes)) > dbf.len() / 2);
}

#[test]
fn geopackages_changed_anywhere_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gpkg");
    drop(tests::geopackage(&path));
    let bytes = std::fs::read(&path).unwrap();
    let fields = FootprintFields { height: Some("height".to_owned()), base: None };
    // Each opens a database: bytes at steps, and those of the header all.
    let mut refused = 0;
    for at in (0..100).chain((100..bytes.len()).step_by(7)) {
        for value in [bytes[at] ^ 0x10, 0, 0xFF] {
            let mut changed = bytes.clone();
            changed[at] = value;
            std::fs::write(&path, &changed[..if value == 0 { at } else { bytes.len() }]).unwrap();
            match read_geopackage(&path, &fields) {
                Ok(file) => assert_sound(&file),
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > bytes.len() / 7, "{refused} of {}", bytes.len());
}

#[test]
fn meshes_cut_or_changed_at_any_byte_are_read_or_refused() {
    let stl = |bytes: &[u8]| read_stl(bytes, "file");
    for bytes in [meshes::tests::binary_stl("solid", 2), meshes::tests::TEXT_STL.as_bytes().to_vec()] {
        assert!(mutate(&bytes, stl) > bytes.len() / 2);
    }
    let ply = |bytes: &[u8]| read_ply_mesh(bytes, "file");
    let text = meshes::tests::TEXT_PLY.as_bytes().to_vec();
    for bytes in [text, meshes::tests::binary_ply(false), meshes::tests::binary_ply(true)] {
        assert!(mutate(&bytes, ply) > bytes.len() / 2);
    }
}

/// A model made up: objects with parts, polygons with holes, at levels and kinds of all sorts, in solids or not.
fn made_up(seed: u64) -> SurfaceFile {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut below = |count: u32| random.next_u32() % count;
    let mut builder = SurfaceBuilder::default();
    let mut shells = 0;
    for number in 0..1 + below(6) {
        let parent = (number > 0 && below(2) == 0).then_some(0);
        let class = if parent.is_some() { "BuildingPart" } else { "Building" };
        let object = builder.add_object(format!("house {number} & <others>"), class, parent);
        let is_solid = below(2) == 0;
        let lod = Some(Lod(1 + below(3) as u8, 0));
        for _ in 0..1 + below(5) {
            let kind =
                [None, Some(SurfaceKind::Wall), Some(SurfaceKind::Roof), Some(SurfaceKind::Other)][below(4) as usize];
            let mut corner = || [0, 1, 2].map(|_| f64::from(below(1 << 30)) / 1024.0 - 5e5);
            let rings: Vec<Vec<[f64; 3]>> = (0..2).map(|_| (0..5).map(|_| corner()).collect()).collect();
            let shell = is_solid.then_some(shells);
            let rings = rings.iter().map(Vec::as_slice);
            builder.add_surface(rings, SurfaceTraits { object, lod, kind, shell }).unwrap();
        }
        shells += u32::from(is_solid);
    }
    builder.file
}

/// The model as CityGML: polygons in their boundaries, solids by reference before them.
fn written(file: &SurfaceFile) -> String {
    let ring = |role: &str, ring: &[[f64; 3]]| {
        let positions: Vec<String> = ring.iter().chain(&ring[..1]).flatten().map(f64::to_string).collect();
        format!("<g:{role}><g:LinearRing><g:posList>{}</g:posList></g:LinearRing></g:{role}>", positions.join(" "))
    };
    let mut text = "<CityModel xmlns='http://www.opengis.net/citygml/3.0' xmlns:g='g' xmlns:x='x'>".to_owned();
    let mut ends = String::new();
    for (number, object) in file.objects.iter().enumerate() {
        let id = object.id.replace('&', "&amp;").replace('<', "&lt;");
        let own: Vec<usize> =
            (0..file.surfaces.len()).filter(|&at| file.surfaces[at].object as usize == number).collect();
        let first = file.surfaces[own[0]];
        let level = first.lod.unwrap().0;
        let property = if object.parent.is_some() { "buildingPart" } else { "cityObjectMember" };
        text += &format!("<{property}><{} g:id='{id}'>", object.class);
        if first.shell.is_some() {
            let links: String = own.iter().map(|at| format!("<g:surfaceMember x:href='#p{at}'/>")).collect();
            text += &format!(
                "<lod{level}Solid><g:Solid><g:exterior><g:Shell>{links}</g:Shell></g:exterior></g:Solid></lod{level}Solid>"
            );
        }
        for at in own {
            let boundary = match file.surfaces[at].kind {
                Some(SurfaceKind::Wall) => "WallSurface",
                Some(SurfaceKind::Roof) => "RoofSurface",
                Some(_) => "CeilingSurface",
                None => "boundary",
            };
            let rings = super::rings(file, at);
            let inside = ring("exterior", &rings[0]) + &ring("interior", &rings[1]);
            text += &format!(
                "<{boundary}><lod{level}MultiSurface><g:Polygon g:id='p{at}'>{inside}</g:Polygon></lod{level}MultiSurface></{boundary}>"
            );
        }
        // The first stays open around its parts, unless a house stands beside it.
        let end = format!("</{}></{property}>", object.class);
        if number == 0 { ends = end } else { text += &end }
    }
    text + &ends + "</CityModel>"
}

#[test]
fn a_model_that_is_written_and_read_is_the_same() {
    for seed in 0..200 {
        let mut model = made_up(seed);
        // Houses within the first are its parts in the text.
        for object in model.objects.iter_mut().skip(1) {
            (object.parent, object.class) = (Some(0), "BuildingPart".to_owned());
        }
        model.format = "CityGML 3.0".to_owned();
        let read = read_citygml(written(&model).as_bytes()).unwrap();
        assert_eq!(read, model, "seed {seed}");
    }
}

#[test]
fn a_shapefile_and_a_geopackage_of_the_same_footprints_are_the_same_prisms() {
    let folder = tempfile::tempdir().unwrap();
    let [shapes, table, package] = ["the houses.shp", "the houses.dbf", "a.gpkg"].map(|name| folder.path().join(name));
    std::fs::write(
        &shapes,
        tests::shp(5, &[vec![SQUARE.to_vec(), vec![[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]]]),
    )
    .unwrap();
    std::fs::write(table, tests::dbf(&[("height", b'N', 3)], &[" 4.5"])).unwrap();
    drop(tests::geopackage(&package));
    let fields = FootprintFields { height: Some("height".to_owned()), base: None };
    let (shp, gpkg) = (read_shapefile(&shapes, &fields).unwrap(), read_geopackage(&package, &fields).unwrap());
    // The package has a second house.
    let places = |file: &SurfaceFile| {
        let first = (0..10).map(|surface| (super::rings(file, surface), file.surfaces[surface].kind));
        let sorted = |ring: &Vec<[f64; 3]>| {
            let mut ring: Vec<String> = ring.iter().map(|corner| format!("{corner:?}")).collect();
            ring.sort();
            ring
        };
        let mut all: Vec<_> =
            first.map(|(rings, kind)| (rings.iter().map(sorted).collect::<Vec<_>>(), format!("{kind:?}"))).collect();
        all.sort();
        all
    };
    assert_eq!(places(&shp), places(&gpkg));
}
