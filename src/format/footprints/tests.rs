use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::outline::{Outline, by_winding, cleaned, doubled_area};
use super::wkb::{Polygons, polygons_of};
use super::*;
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::{SurfaceFile, SurfaceKind};
use crate::format::tests::{assert_sound, count, extent, rings, volumes};

/// Ten metres square, clockwise as outlines are in a Shapefile, and a hole of two.
const SQUARE: [[f64; 2]; 5] = [[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0], [0.0, 0.0]];
const HOLE: [[f64; 2]; 5] = [[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0], [4.0, 4.0]];

pub(in crate::format) fn shp(kind: u32, records: &[Vec<Vec<[f64; 2]>>]) -> Vec<u8> {
    let mut bytes = vec![0; 100];
    bytes[..4].copy_from_slice(&9994_u32.to_be_bytes());
    bytes[28..32].copy_from_slice(&1000_u32.to_le_bytes());
    bytes[32..36].copy_from_slice(&kind.to_le_bytes());
    for (number, record) in records.iter().enumerate() {
        let points: Vec<[f64; 2]> = record.iter().flatten().copied().collect();
        let mut content = kind.to_le_bytes().to_vec();
        content.extend([0; 32]);
        content.extend((record.len() as u32).to_le_bytes());
        content.extend((points.len() as u32).to_le_bytes());
        let starts = record.iter().scan(0, |start, ring| Some(std::mem::replace(start, *start + ring.len() as u32)));
        content.extend(starts.flat_map(u32::to_le_bytes));
        content.extend(points.iter().flatten().flat_map(|value| value.to_le_bytes()));
        bytes.extend((number as u32 + 1).to_be_bytes());
        bytes.extend((content.len() as u32 / 2).to_be_bytes());
        bytes.extend(content);
    }
    let words = bytes.len() as u32 / 2;
    bytes[24..28].copy_from_slice(&words.to_be_bytes());
    bytes
}

/// Fields as name, kind and length; rows as they stand in the file, deletion mark first.
pub(in crate::format) fn dbf(fields: &[(&str, u8, u8)], rows: &[&str]) -> Vec<u8> {
    let mut bytes = vec![0; 32];
    bytes[4..8].copy_from_slice(&(rows.len() as u32).to_le_bytes());
    bytes[8..10].copy_from_slice(&(32 + 32 * fields.len() as u16 + 1).to_le_bytes());
    let length: usize = 1 + fields.iter().map(|field| usize::from(field.2)).sum::<usize>();
    bytes[10..12].copy_from_slice(&(length as u16).to_le_bytes());
    for (name, kind, length) in fields {
        let mut field = [0; 32];
        field[..name.len()].copy_from_slice(name.as_bytes());
        (field[11], field[16]) = (*kind, *length);
        bytes.extend(field);
    }
    bytes.push(0x0D);
    for row in rows {
        assert_eq!(row.len(), length);
        bytes.extend(row.as_bytes());
    }
    bytes
}

const FIELDS: [(&str, u8, u8); 3] = [("name", b'C', 2), ("HEIGHT", b'N', 5), ("base", b'F', 4)];

struct Files(tempfile::TempDir);

impl Files {
    fn new(shp: &[u8], dbf: &[u8]) -> Files {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("houses.shp"), shp).unwrap();
        std::fs::write(folder.path().join("houses.DBF"), dbf).unwrap();
        Files(folder)
    }

    fn path(&self) -> PathBuf {
        self.0.path().join("houses.shp")
    }

    fn read(&self, fields: &FootprintFields) -> Result<SurfaceFile, SurfaceError> {
        read_shapefile(&self.path(), fields).inspect(assert_sound)
    }
}

fn fields(height: &str, base: Option<&str>) -> FootprintFields {
    FootprintFields { height: Some(height.to_owned()), base: base.map(str::to_owned) }
}

fn polygon() -> Vec<Vec<[f64; 2]>> {
    vec![SQUARE.to_vec(), HOLE.to_vec()]
}

/// Twice the signed areas of a surface's rings seen from above.
fn doubled_areas(file: &SurfaceFile, surface: usize) -> Vec<f64> {
    rings(file, surface)
        .iter()
        .map(|ring| doubled_area(&ring.iter().map(|[x, y, _]| [*x, *y]).collect::<Vec<_>>()))
        .collect()
}

#[test]
fn a_footprint_becomes_a_closed_prism_with_its_hole() {
    let files = Files::new(&shp(5, &[polygon()]), &dbf(&FIELDS, &[" ab 12.5 3.0"]));
    std::fs::write(files.path().with_extension("prj"), "\u{feff}PROJCS[\"X\"]\n").unwrap();
    let file = files.read(&fields("height", Some("base"))).unwrap();
    assert_eq!((file.format.as_str(), file.crs.as_deref()), ("Shapefile", Some("PROJCS[\"X\"]")));
    assert_eq!((file.objects[0].id.as_str(), file.objects[0].class.as_str()), ("houses 1", "Building"));
    let kinds =
        [SurfaceKind::Ground, SurfaceKind::Wall, SurfaceKind::Roof].map(|kind| count(&file, Some((1, 0)), Some(kind)));
    assert_eq!(kinds, [1, 8, 1]);
    assert_eq!(extent(&file), ([0.0, 0.0, 3.0], [10.0, 10.0, 15.5]));
    let last = file.surfaces.len() - 1;
    assert_eq!(doubled_areas(&file, 0), [-200.0, 8.0], "the ground looks down");
    assert_eq!(doubled_areas(&file, last), [200.0, -8.0], "the roof looks up");
    let volume = 6.0 * (100.0 - 4.0) * 12.5;
    assert!((volumes(&file)[0] - volume).abs() < 1e-9, "{:?}", volumes(&file));
}

#[test]
fn without_the_field_of_heights_the_error_lists_the_fields_with_numbers() {
    let files = Files::new(&shp(5, &[polygon()]), &dbf(&FIELDS, &[" ab 12.5 3.0"]));
    for wanted in [FootprintFields::default(), fields("hoehe", None), fields("HEIGHT", Some("name"))] {
        let error = files.read(&wanted).unwrap_err();
        assert!(error.to_string().contains("HEIGHT, base"), "{error}");
        assert!(error.place_in(Path::new("x")).contains("houses.DBF"));
    }
    let without = Files::new(&shp(5, &[polygon()]), &dbf(&FIELDS[..1], &[" ab"]));
    assert!(without.read(&FootprintFields::default()).unwrap_err().to_string().contains("no fields with numbers"));
}

#[test]
fn rows_that_are_no_house_are_counted() {
    let rows = [" ab     3.0", " ab -1.0 3.0", " ab****** ", "*ab 12.5 3.0", " ab 12.5    ", " ab 12.5 3.0"];
    let rows = rows.map(|row| format!("{row:12}"));
    let records: Vec<_> = (0..5).map(|_| polygon()).chain([vec![vec![[0.0, 0.0], [1.0, 1.0], [0.0, 0.0]]]]).collect();
    let files = Files::new(&shp(15, &records), &dbf(&FIELDS, &rows.iter().map(String::as_str).collect::<Vec<_>>()));
    let file = files.read(&fields("HEIGHT", Some("base"))).unwrap();
    let skipped: Vec<_> = file.skipped.iter().map(|skipped| (skipped.what, skipped.count)).collect();
    let expected = [
        ("heights of footprints' corners", 5),
        ("footprints without a height above zero", 3),
        ("deleted rows", 1),
        ("footprints without a base", 1),
        ("rings without an area", 1),
        ("footprints without a polygon", 1),
    ];
    assert_eq!(skipped, expected);
    assert_eq!(file.surfaces, []);
}

#[test]
fn rings_are_told_apart_by_their_turn() {
    let moved = |ring: &[[f64; 2]], by: f64| ring.iter().map(|[x, y]| [x + by, *y]).collect::<Vec<_>>();
    let ring = |ring: &[[f64; 2]]| cleaned(ring).unwrap();
    // Two houses, a hole in the second, one within a court, and a house that is wound the wrong way.
    let court = ring(&[[4.5, 4.5], [4.5, 5.5], [5.5, 5.5], [5.5, 4.5]]);
    let odd: Vec<[f64; 2]> = moved(&SQUARE, 100.0).into_iter().rev().collect();
    let rings =
        vec![ring(&SQUARE), court, ring(&moved(&SQUARE, 50.0)), ring(&moved(&HOLE, 50.0)), ring(&HOLE), ring(&odd)];
    let outlines = by_winding(rings).unwrap();
    let shapes: Vec<_> =
        outlines.iter().map(|outline| (outline.outer[0][0] as i32 / 50, outline.holes.len())).collect();
    assert_eq!(shapes, [(0, 1), (0, 0), (1, 1), (2, 0)]);
    for Outline { outer, holes } in &outlines {
        assert!(doubled_area(outer) > 0.0 && holes.iter().all(|hole| doubled_area(hole) < 0.0));
    }
    assert_eq!(cleaned(&[[0.0; 2], [1.0, 1.0], [1.0, 1.0], [2.0, 2.0], [0.0; 2]]), None);
}

#[test]
fn shapefiles_that_lie_or_hold_something_else_are_refused() {
    let good = shp(5, &[polygon()]);
    let with = |at: usize, word: u32, table: &[&str]| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        Files::new(&bytes, &dbf(&FIELDS, table)).read(&fields("HEIGHT", None)).unwrap_err().to_string()
    };
    let row = [" ab 12.5 3.0"];
    assert!(with(32, 1, &row).contains("holds points"));
    assert!(with(32, 31, &row).contains("multipatches"));
    assert!(with(104, u32::MAX, &row).contains("cut off"));
    assert!(with(108, 3, &row).contains("type 3"));
    assert!(with(144, u32::MAX, &row).contains("more points"));
    assert!(with(148, u32::MAX, &row).contains("more points"));
    assert!(with(152, 9, &row).contains("more points"));
    assert!(with(28, 1000, &[row[0], row[0]]).contains("2 rows"));
    let mut table = dbf(&FIELDS, &row);
    table[4..8].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
    assert!(Files::new(&good, &table).read(&fields("HEIGHT", None)).unwrap_err().to_string().contains("cut off"));
    let files = Files::new(&good, &table);
    std::fs::remove_file(files.0.path().join("houses.DBF")).unwrap();
    assert!(files.read(&fields("HEIGHT", None)).unwrap_err().to_string().contains("table"));
    let mut far = polygon();
    far[0][1] = [f64::INFINITY, 0.0];
    let error = Files::new(&shp(5, &[far]), &dbf(&FIELDS, &row)).read(&fields("HEIGHT", None)).unwrap_err();
    assert!(error.to_string().contains("not finite") && error.object.as_deref() == Some("houses 1"), "{error}");
    assert!(is_shapefile(&good) && !is_shapefile(b"ply"));
}

/// A polygon in well-known binary, little-endian, with z where asked.
fn wkb(kind: u32, rings: &[Vec<[f64; 2]>]) -> Vec<u8> {
    let mut bytes = vec![1];
    bytes.extend(kind.to_le_bytes());
    bytes.extend((rings.len() as u32).to_le_bytes());
    for ring in rings {
        bytes.extend((ring.len() as u32).to_le_bytes());
        for [x, y] in ring {
            bytes.extend(x.to_le_bytes());
            bytes.extend(y.to_le_bytes());
            if kind == 1003 {
                bytes.extend(7.0_f64.to_le_bytes());
            }
        }
    }
    bytes
}

fn multi(kind: u32, parts: &[Vec<u8>]) -> Vec<u8> {
    [&[1][..], &kind.to_le_bytes(), &(parts.len() as u32).to_le_bytes(), &parts.concat()].concat()
}

fn blob(envelope: u8, wkb: &[u8]) -> Vec<u8> {
    let sizes = [0, 32, 48, 48, 64];
    [b"GP\0".as_slice(), &[1 | envelope << 1], &[0; 4], &vec![0; sizes[envelope as usize]], wkb].concat()
}

#[test]
fn geometries_are_read_behind_every_size_of_envelope() {
    for envelope in 0..5 {
        for kind in [3, 1003] {
            let found = polygons_of(&blob(envelope, &wkb(kind, &polygon()))).unwrap();
            assert_eq!((found.outlines.len(), found.outlines[0].holes.len(), found.has_heights), (1, 1, kind == 1003));
            assert_eq!(doubled_area(&found.outlines[0].outer), 200.0);
        }
    }
    let parts = [wkb(3, &polygon()), wkb(3, &[SQUARE.to_vec()])];
    assert_eq!(polygons_of(&blob(1, &multi(6, &parts))).unwrap().outlines.len(), 2);
    let point = [&[1, 1, 0, 0, 0][..], &[0; 16]].concat();
    let mixed = polygons_of(&blob(0, &multi(7, &[point, parts[0].clone()]))).unwrap();
    assert_eq!((mixed.outlines.len(), mixed.others), (1, 1));
    let mut empty = blob(0, &[]);
    empty[3] |= 0x10;
    assert_eq!(polygons_of(&empty), Ok(Polygons::default()));
    let big = [&[0][..], &3_u32.to_be_bytes(), &1_u32.to_be_bytes(), &4_u32.to_be_bytes()].concat();
    let points: Vec<u8> = SQUARE[..4].iter().flatten().flat_map(|value| value.to_be_bytes()).collect();
    assert_eq!(polygons_of(&blob(0, &[big, points].concat())).unwrap().outlines.len(), 1);
}

#[test]
fn geometries_that_lie_are_refused() {
    let lying = [&[1, 3, 0, 0, 0][..], &u32::MAX.to_le_bytes(), &u32::MAX.to_le_bytes()].concat();
    for (bytes, expected) in [
        (b"XX\0\x01aaaa".to_vec(), "`GP`"),
        (vec![b'G', b'P', 0, 0xB, 0, 0, 0, 0], "code 5"),
        (blob(1, &[]), "cut off"),
        (blob(0, &lying), "cut off"),
        (blob(0, &multi(99, &[])), "type 99"),
        (blob(0, &(0..99).fold(wkb(3, &[]), |inner, _| multi(7, &[inner]))), "collections"),
    ] {
        assert!(polygons_of(&bytes).unwrap_err().contains(expected), "{expected}");
    }
    let good = blob(1, &multi(6, &[wkb(3, &polygon()), wkb(1003, &polygon())]));
    for at in 0..good.len() {
        assert!(polygons_of(&good[..at]).is_err());
        for value in [0, 1, 0xFF] {
            let mut changed = good.clone();
            changed[at] = value;
            let _ = polygons_of(&changed);
        }
    }
}

/// A GeoPackage as small as one can be.
pub(in crate::format) fn geopackage(path: &Path) -> Connection {
    let database = Connection::open(path).unwrap();
    database
        .execute_batch(
            "PRAGMA page_size = 512; PRAGMA application_id = 0x47504B47;
             CREATE TABLE gpkg_spatial_ref_sys (srs_id INTEGER, organization TEXT, organization_coordsys_id INTEGER, definition TEXT);
             INSERT INTO gpkg_spatial_ref_sys VALUES (3006, 'epsg', 3006, 'PROJCS[]'), (9, 'NONE', 9, 'LOCAL[]');
             CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, srs_id INTEGER);
             INSERT INTO gpkg_geometry_columns VALUES ('the houses', 'geom', 3006);
             CREATE TABLE \"the houses\" (fid INTEGER PRIMARY KEY, geom BLOB, name TEXT, height REAL, \"base \"\"m\" MEDIUMINT);",
        )
        .unwrap();
    let mut insert = database.prepare("INSERT INTO \"the houses\" VALUES (?, ?, 'x', ?, ?)").unwrap();
    insert.execute((5, blob(1, &wkb(3, &polygon())), 4.5, 100)).unwrap();
    insert.execute((7, blob(1, &multi(6, &[wkb(3, &[SQUARE.to_vec()]), wkb(3, &[HOLE.to_vec()])])), "3", 100)).unwrap();
    insert.execute((8, None::<i64>, 3.0, 100)).unwrap();
    insert.execute((9, blob(0, &wkb(3, &polygon())), None::<i64>, 100)).unwrap();
    drop(insert);
    database
}

#[test]
fn layers_of_a_geopackage_become_prisms() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a b%20?.gpkg");
    drop(geopackage(&path));
    assert!(is_geopackage(&std::fs::read(&path).unwrap()));
    let file = read_geopackage(&path, &fields("height", Some("base \"m"))).unwrap();
    assert_sound(&file);
    assert_eq!((file.format.as_str(), file.crs.as_deref()), ("GeoPackage", Some("EPSG:3006")));
    let ids: Vec<&str> = file.objects.iter().map(|object| object.id.as_str()).collect();
    assert_eq!(ids, ["the houses 5", "the houses 7"]);
    assert_eq!(extent(&file), ([0.0, 0.0, 100.0], [10.0, 10.0, 104.5]));
    assert_eq!(volumes(&file).len(), 3, "a shell for each part");
    let skipped: Vec<_> =
        file.skipped.iter().map(|skipped| (skipped.what, skipped.count, skipped.example.as_str())).collect();
    let expected = [
        ("footprints without a polygon", 1, "the houses 8"),
        ("footprints without a height above zero", 1, "the houses 9"),
    ];
    assert_eq!(skipped, expected);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside");
    let error = read_geopackage(&path, &FootprintFields::default()).unwrap_err();
    assert!(error.to_string().contains("fid, height, base \"m"), "{error}");
}

#[test]
fn further_layers_are_read_where_they_have_the_field_and_the_reference_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gpkg");
    let database = geopackage(&path);
    database
        .execute_batch(
            "CREATE TABLE a_roads (fid INTEGER PRIMARY KEY, geom BLOB, width REAL);
             CREATE TABLE zones (fid INTEGER PRIMARY KEY, geom BLOB, height REAL);
             CREATE VIEW endless AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x AS fid, x AS height, NULL AS geom FROM n;
             INSERT INTO gpkg_geometry_columns VALUES ('a_roads', 'geom', 3006), ('zones', 'geom', 9), ('endless', 'geom', 3006), ('none', 'geom', 3006);",
        )
        .unwrap();
    drop(database);
    let file = read_geopackage(&path, &fields("HEIGHT", None)).unwrap();
    assert_eq!(file.objects.len(), 2);
    let skipped: Vec<_> = file.skipped.iter().map(|skipped| (skipped.what, skipped.example.as_str())).collect();
    assert_eq!(skipped[0], ("layers without the field of heights", "a_roads"));
    assert_eq!(skipped.last(), Some(&("layers in another reference system than the first", "zones")));
    let error = read_geopackage(&path, &fields("hight", None)).unwrap_err();
    assert!(error.to_string().contains("width") && error.to_string().contains("height"), "{error}");
}

#[test]
fn databases_that_are_open_elsewhere_or_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gpkg");
    drop(geopackage(&path));
    let read = |path: &Path| read_geopackage(path, &fields("height", None)).unwrap_err().to_string();
    std::fs::write(folder.path().join("a.gpkg-wal"), "x").unwrap();
    assert!(read(&path).contains("-wal"));
    std::fs::write(folder.path().join("b.gpkg"), "SQLite format 3\0 and nothing more").unwrap();
    assert!(read(&folder.path().join("b.gpkg")).contains("cannot be read"));
    assert!(read(folder.path()).contains("a folder"));
    let empty = folder.path().join("c.gpkg");
    Connection::open(&empty)
        .unwrap()
        .execute_batch("CREATE TABLE gpkg_geometry_columns (table_name, column_name, srs_id)")
        .unwrap();
    assert!(read(&empty).contains("no layer"));
}
