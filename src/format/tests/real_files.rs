//! Real files of data/formats, with the counts that two independent readers agree on (its README.md).

#[path = "../../../tests/needs/mod.rs"]
mod needs;

use std::fs::File;
use std::io::BufReader;

use super::{assert_sound, count, extent, volumes};
use crate::format::citygml::{is_citygml, read_citygml};
use crate::format::footprints::{FootprintFields, is_geopackage, is_shapefile, read_geopackage, read_shapefile};
use crate::format::gltf::{GltfError, GltfFile, read_gltf};
use crate::format::surfaces::{SurfaceFile, SurfaceKind};
use crate::format::tileset::{TilesetFile, is_tileset, read_tile, read_tileset};

const GROUND: Option<SurfaceKind> = Some(SurfaceKind::Ground);
const ROOF: Option<SurfaceKind> = Some(SurfaceKind::Roof);
const WALL: Option<SurfaceKind> = Some(SurfaceKind::Wall);

fn citygml(name: &str) -> Option<SurfaceFile> {
    let path = needs::shared(&format!("data/formats/city/{name}"))?;
    assert!(is_citygml(&std::fs::read(&path).unwrap()));
    let file = read_citygml(BufReader::new(File::open(path).unwrap())).unwrap();
    assert_sound(&file);
    assert_eq!(file.skipped, []);
    Some(file)
}

/// Objects that are no part of another, and parts.
fn objects(file: &SurfaceFile) -> (usize, usize) {
    let parts = file.objects.iter().filter(|object| object.parent.is_some()).count();
    (file.objects.len() - parts, parts)
}

fn holes(file: &SurfaceFile) -> usize {
    file.surfaces.iter().filter(|surface| surface.ring_count > 1).count()
}

fn assert_extent(file: &SurfaceFile, low: [f64; 3], high: [f64; 3]) {
    let (found_low, found_high) = extent(file);
    for axis in 0..3 {
        assert!((found_low[axis] - low[axis]).abs() < 1e-6, "{found_low:?}");
        assert!((found_high[axis] - high[axis]).abs() < 1e-6, "{found_high:?}");
    }
}

#[test]
fn zurich_citygml_1_has_six_parts_and_a_named_reference_system() {
    let Some(file) = citygml("zurich-lod2-citygml1.xml") else { return };
    assert_eq!((file.format.as_str(), file.crs.as_deref()), ("CityGML 1.0", Some("CH1903")));
    assert_eq!(objects(&file), (4, 6));
    let lod = Some((2, 0));
    assert_eq!([GROUND, ROOF, WALL].map(|kind| count(&file, lod, kind)), [4, 12, 45]);
    assert_eq!(file.surfaces.len(), 61);
}

#[test]
fn delft_citygml_2_has_solids_of_lists_of_pos_that_look_outwards() {
    let Some(file) = citygml("delft-citygml2.xml") else { return };
    assert_eq!((file.format.as_str(), file.crs.as_deref()), ("CityGML 2.0", Some("urn:ogc:def:crs:EPSG::7415")));
    assert_eq!(objects(&file), (3, 0));
    assert_eq!([0, 1].map(|lod| count(&file, Some((lod, 0)), None)), [6, 91]);
    assert_extent(&file, [84508.173, 446648.404, 0.26], [84664.096, 447382.68, 10.56]);
    assert_eq!(volumes(&file).iter().map(|volume| *volume > 0.0).collect::<Vec<_>>(), [true; 3]);
}

#[test]
fn plateau_keeps_its_axes_in_the_file_s_order() {
    let Some(file) = citygml("64413325_bldg_6697_op.gml") else { return };
    assert_eq!(file.crs.as_deref(), Some("http://www.opengis.net/def/crs/EPSG/0/6697"));
    assert_eq!(objects(&file), (25, 0));
    assert_eq!([0, 1].map(|lod| count(&file, Some((lod, 0)), None)), [25, 156]);
    assert!((file.positions[0][0] - 42.94147409013628).abs() < 1e-12);
    // Latitude first: all solids are mirrored.
    assert_eq!(volumes(&file).len(), 25);
    assert!(volumes(&file).iter().all(|volume| *volume < 0.0));
}

#[test]
fn fzk_haus_citygml_3_has_a_solid_that_names_its_walls() {
    let Some(file) = citygml("FZK-Haus-LoD2__v3.gml") else { return };
    assert_eq!(file.format, "CityGML 3.0");
    assert_eq!(objects(&file), (1, 0));
    assert_eq!([GROUND, ROOF, WALL].map(|kind| count(&file, Some((2, 0)), kind)), [1, 2, 4]);
    assert!(file.surfaces.iter().all(|surface| surface.shell == Some(0)));
    assert!(volumes(&file)[0] > 0.0);
}

#[test]
fn tum_main_entrance_has_holes_and_its_extent() {
    let Some(file) = citygml("TUM-Main-Entrance.gml") else { return };
    assert_eq!([GROUND, ROOF, WALL].map(|kind| count(&file, Some((2, 0)), kind)), [1, 2, 14]);
    assert_eq!((file.surfaces.len(), holes(&file)), (17, 2));
    assert!(file.surfaces.iter().all(|surface| surface.shell == Some(0)));
    assert_extent(&file, [691009.16, 5335994.57, 515.042], [691054.07, 5336047.41, 534.45]);
    assert_eq!(file.crs.as_deref(), Some("urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH"));
}

fn tileset(name: &str) -> Option<TilesetFile> {
    let path = needs::shared(&format!("data/formats/tiles/{name}/tileset.json"))?;
    assert!(is_tileset(&std::fs::read(&path).unwrap()));
    let file = read_tileset(&path).unwrap();
    assert_sound(&file.surfaces);
    assert_eq!((file.surfaces.skipped.len(), file.surfaces.surfaces.len()), (0, 246));
    Some(file)
}

#[test]
fn both_tilesets_stand_in_the_same_place_upright() {
    let (Some(old), Some(new)) = (tileset("v10"), tileset("v11")) else { return };
    assert_eq!((old.surfaces.format.as_str(), new.surfaces.format.as_str()), ("3D Tiles 1.0", "3D Tiles 1.1"));
    let names: Vec<&str> = old.surfaces.objects.iter().map(|object| object.id.as_str()).collect();
    assert_eq!(names, ["NL.IMBAG.Pand.0503100000031927-0", "NL.IMBAG.Pand.0503100000028341-0"]);
    let in_ecef = |file: &TilesetFile| {
        let local = file.local_from_ecef.unwrap();
        let back = move |position: &[f64; 3]| {
            local.rotation.inverse() * (nalgebra::Vector3::from(*position) - local.translation)
        };
        file.surfaces.positions.iter().map(back).collect::<Vec<_>>()
    };
    let apart = in_ecef(&old).iter().zip(in_ecef(&new)).map(|(old, new)| (old - new).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-5, "{apart}");
    // The houses are 13.4 m high above NAP - 0.3 m, which is 43.1 m above the ellipsoid.
    let (low, high) = extent(&new.surfaces);
    assert!((low[2] - 43.124).abs() < 0.01 && (high[2] - 56.508).abs() < 0.01, "{low:?} {high:?}");
}

#[test]
fn a_tile_by_itself_is_read_and_one_that_looks_like_text_is_named() {
    let (Some(good), Some(bad)) =
        (needs::shared("cases/tile-b3dm/house.b3dm"), needs::shared("cases/tile-b3dm/looks_like_obj.b3dm"))
    else {
        return;
    };
    assert_eq!(read_tile(&std::fs::read(&good).unwrap(), &good).unwrap().surfaces.surfaces.len(), 12);
    let error = read_tile(&std::fs::read(&bad).unwrap(), &bad).unwrap_err();
    assert!(!error.to_string().is_empty());
}

#[test]
fn test_buildings_are_three_prisms_with_six_rings() {
    let Some(path) = needs::shared("data/formats/footprints/test_buildings.shp") else { return };
    assert!(is_shapefile(&std::fs::read(&path).unwrap()));
    let fields = FootprintFields { height: Some("height".to_owned()), base: None };
    let file = read_shapefile(&path, &fields).unwrap();
    assert_sound(&file);
    // The first is of three parts.
    assert_eq!((file.objects.len(), count(&file, Some((1, 0)), ROOF)), (3, 5));
    let roofs = file.surfaces.iter().filter(|surface| surface.kind == ROOF);
    assert_eq!(roofs.map(|surface| surface.ring_count).sum::<u32>(), 6);
    assert!(volumes(&file).iter().all(|volume| *volume > 0.0));
    assert!(file.crs.as_deref().is_some_and(|crs| crs.starts_with("PROJCS[")));
    assert_eq!(extent(&file).0[2], 0.0);
}

#[test]
fn footprints_without_heights_list_their_numbers_in_both_formats() {
    let (Some(shp), Some(gpkg)) =
        (needs::shared("data/formats/footprints/by_14.shp"), needs::shared("data/formats/footprints/by_14.gpkg"))
    else {
        return;
    };
    assert!(is_geopackage(&std::fs::read(&gpkg).unwrap()));
    let none = FootprintFields::default();
    let errors = [read_shapefile(&shp, &none).unwrap_err(), read_geopackage(&gpkg, &none).unwrap_err()];
    let listed = errors.map(|error| error.to_string());
    // Any number will do to count them.
    let field = listed[0].rsplit("numbers are ").next().unwrap().split(", ").next().unwrap().to_owned();
    assert!(listed[1].to_lowercase().contains(&field.to_lowercase()), "{listed:?}");
    let fields = FootprintFields { height: Some(field), base: None };
    for file in [read_shapefile(&shp, &fields).unwrap(), read_geopackage(&gpkg, &fields).unwrap()] {
        assert_sound(&file);
        let roofs = file.surfaces.iter().filter(|surface| surface.kind == ROOF);
        let skipped: usize = file.skipped.iter().map(|skipped| skipped.count).sum();
        assert_eq!((file.objects.len() + skipped, roofs.map(|surface| surface.ring_count).sum::<u32>()), (169, 175));
    }
}

fn gltf(case: &str, name: &str) -> Option<Result<GltfFile, GltfError>> {
    let path = needs::shared(&format!("cases/{case}/{name}"))?;
    Some(read_gltf(&std::fs::read(&path).unwrap(), path.parent().unwrap()))
}

#[test]
fn gltf_with_extensions_stands_where_it_is_and_packed_ones_are_named() {
    let Some(quantized) = gltf("gltf-quantized", "house.gltf") else { return };
    let part = quantized.unwrap().parts.remove(0);
    let highest = part.positions.iter().fold([0.0; 3], |high, at| [0, 1, 2].map(|axis| f64::max(at[axis], high[axis])));
    assert_eq!(part.triangles.len(), 12);
    assert!([10.0, 6.0, 20.0].iter().zip(highest).all(|(size, high)| (size - high).abs() < 0.001), "{highest:?}");
    let Some(centered) = gltf("gltf-cesium-rtc", "house.gltf") else { return };
    assert_eq!(centered.unwrap().parts[0].positions[0], [592000.0, 12.0, -5750000.0]);
    let Some(packed) = gltf("gltf-meshopt-fallback", "house.gltf") else { return };
    assert!(packed.unwrap_err().to_string().contains("EXT_meshopt_compression"));
    let Some(zeros) = gltf("rel-gltf-sparse-zeros", "city.gltf") else { return };
    assert!(zeros.unwrap_err().to_string().contains("too many for"));
}

#[test]
fn a_source_that_gives_single_bytes_is_read_as_a_whole_one() {
    for name in ["FZK-Haus-LoD2__v3.gml", "64413325_bldg_6697_op.gml"] {
        let Some(whole) = citygml(name) else { return };
        let path = needs::shared(&format!("data/formats/city/{name}")).unwrap();
        for capacity in [1, 7] {
            let file = read_citygml(BufReader::with_capacity(capacity, File::open(&path).unwrap())).unwrap();
            assert_eq!(file, whole);
        }
    }
}

#[test]
fn real_files_that_are_cut_are_never_taken_for_whole_ones() {
    for name in ["FZK-Haus-LoD2__v3.gml", "zurich-lod2-citygml1.xml"] {
        let Some(path) = needs::shared(&format!("data/formats/city/{name}")) else { return };
        let bytes = std::fs::read(path).unwrap();
        let end = bytes.trim_ascii_end().len();
        for cut in (1..end).step_by(997) {
            assert!(read_citygml(&bytes[..cut]).is_err(), "{name} cut at {cut}");
        }
        assert!(read_citygml(&bytes[..end]).is_ok());
    }
}
