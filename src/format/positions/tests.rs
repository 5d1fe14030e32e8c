//! Every form is read as the program that writes it means it; what is cut or altered is an error and never a panic.

use std::path::Path;

use super::database;
use super::exif::{parse as parse_exif, position};
use super::read::parse_text;
use super::{Frame, GEOGRAPHIC, PositionsFile, StoredPosition, read_positions};

fn read(text: &str) -> PositionsFile {
    parse_text(text, Path::new("positions.txt")).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn refused(text: &str) -> String {
    parse_text(text, Path::new("positions.txt")).unwrap_err().to_string()
}

fn places(file: &PositionsFile) -> Vec<(&str, [f64; 2], Option<f64>)> {
    file.positions.iter().map(|p| (p.name.as_str(), p.east_north.unwrap(), p.height_m)).collect()
}

const GEO: &str = "EPSG:4326\np001.jpg 4.456 51.905 73.2 0 0 0 3.0 6.0\np002.jpg 4.457 51.906 92.1\n";
const PLAIN: &str = "# by hand\np001.jpg 90924.547 435679.817 29.710\n\nsub\\my photo 2.jpg 90910.1 435695.8 48.5\n";
const COLMAP: &str = "p001.jpg 51.90592763 4.45607299 73.284\np002.jpg 51.90606989 4.45586068 92.150\n";
const METASHAPE: &str = "#CoordinateSystem: WGS 84 (EPSG::4326)\n#Label,Longitude,Latitude,Altitude,Accuracy_X,Accuracy_Y,Accuracy_Z,Enabled\n\
                         p001.jpg,4.456,51.905,73.2,3.0,3.5,6.0,1\np002.jpg,4.457,51.906,92.1,3.0,3.0,6.0,0\np003.jpg,,,,,,,1\n";
const REALITY: &str = "#name,x,y,alt\n\"a, b.jpg\",85000.5,446000.25,12\n";
const SPREADSHEET: &str = "Name;X;Y;Z\np001.jpg;90924,547;435679,817;29,71\n";
const OPENSFM: &str = r#"[{"cameras": {}, "reference_lla": {"latitude": 52.5, "longitude": 13.4, "altitude": 0.0}, "shots": {
    "02.jpg": {"rotation": [0,0,0], "gps_position": [4.5, 9.25, 39.0], "gps_dop": 5.0}, "03.jpg": {"rotation": [0,0,0]}}}]"#;

#[test]
fn geo_txt_has_its_system_first_and_accuracies_behind_the_angles() {
    let file = read(GEO);
    assert_eq!((file.format, &file.frame), ("geo.txt", &GEOGRAPHIC));
    assert_eq!(places(&file)[0], ("p001.jpg", [4.456, 51.905], Some(73.2)));
    assert_eq!((file.positions[0].sigma_m, file.positions[0].height_sigma_m), (Some(3.0), Some(6.0)));
    assert_eq!(file.positions[1].sigma_m, None);
    assert_eq!(read("WGS84 UTM 31N\np.jpg 600000 5750000\n").frame, Frame::Epsg(32631));
}

#[test]
fn lines_without_a_system_are_in_that_of_the_city_and_names_may_have_blanks() {
    let file = read(PLAIN);
    assert_eq!(file.frame, Frame::OfTheCity);
    assert_eq!(places(&file)[1], ("sub/my photo 2.jpg", [90910.1, 435695.8], Some(48.5)));
    assert_eq!(places(&read("a,1,2,3\nb,400,5,6\n"))[1], ("b", [400.0, 5.0], Some(6.0)));
}

#[test]
fn degrees_are_told_by_their_values_with_latitude_first_as_colmap_writes_them() {
    let file = read(COLMAP);
    assert_eq!(file.frame, GEOGRAPHIC);
    assert_eq!(places(&file)[0], ("p001.jpg", [4.45607299, 51.90592763], Some(73.284)));
    // What cannot be a latitude is none; what moves by metres is no angle.
    assert_eq!(places(&read("a.jpg 151.25 -33.8 5\n"))[0].1, [151.25, -33.8]);
    assert_eq!(read("a 10.5 20.5 1\nb 19.5 20.1 1\n").frame, Frame::OfTheCity);
}

#[test]
fn tables_are_read_by_the_names_of_their_columns() {
    let file = read(METASHAPE);
    assert_eq!((file.frame.clone(), file.positions.len()), (GEOGRAPHIC, 1));
    assert_eq!(places(&file)[0], ("p001.jpg", [4.456, 51.905], Some(73.2)));
    assert_eq!((file.positions[0].sigma_m, file.positions[0].height_sigma_m), (Some(3.0), Some(6.0)));
    assert!(file.warnings[0].contains("1 positions are not enabled"), "{:?}", file.warnings);
    let file = read(REALITY);
    assert_eq!(
        (places(&file)[0], file.frame.clone()),
        (("a, b.jpg", [85000.5, 446000.25], Some(12.0)), Frame::OfTheCity)
    );
    assert_eq!(places(&read(SPREADSHEET))[0], ("p001.jpg", [90924.547, 435679.817], Some(29.71)));
    assert_eq!(read("Label,X/Easting,Y/Northing,Z/Altitude\na,500000,5000000,3\n").positions.len(), 1);
    // In the columns' own words, whatever their order.
    assert_eq!(places(&read("latitude\tlongitude\timage\n51.5\t4.5\ta.jpg\n"))[0], ("a.jpg", [4.5, 51.5], None));
}

#[test]
fn opensfm_gives_metres_about_its_reference() {
    let file = read(OPENSFM);
    assert_eq!(file.frame, Frame::Tangent { latitude_deg: 52.5, longitude_deg: 13.4, height_m: 0.0 });
    assert_eq!(places(&file), [("02.jpg", [4.5, 9.25], Some(39.0))]);
    assert_eq!(file.positions[0].sigma_m, Some(5.0));
}

#[test]
fn what_holds_no_positions_is_told_with_its_line() {
    for (text, says) in [
        ("", "the file is empty"),
        ("# only a remark\n", "holds no position"),
        ("p001.jpg 1 2 3\np002.jpg 1 x 3\n", "line 2: x is no number"),
        ("p001.jpg 1\n", "line 1: 2 words"),
        ("p001.jpg 1 nan 2\n", "line 1: nan is no number"),
        ("p001.jpg 1 1e999 2\n", "line 1: 1e999 is no number"),
        ("Label,X,Y,Z\na,1\n", "line 2: 2 columns"),
        ("Label,X,Y,Z\n,1,2,3\n", "line 2: a row without a name"),
        ("{\"scale\": 1}", "another kind of file"),
        ("[{\"shots\": {}}]", "no reference_lla"),
        ("[{\"reference_lla\": {\"latitude\": 1e9, \"longitude\": 0}}]", "no place on Earth"),
        ("[1, 2]", "not a valid OpenSfM reconstruction"),
    ] {
        let message = refused(text);
        assert!(message.contains(says) && message.ends_with("positions.txt"), "{text:?}: {message}");
    }
}

#[test]
fn a_text_that_is_cut_anywhere_is_an_error_or_positions_with_finite_numbers() {
    for text in [GEO, PLAIN, COLMAP, METASHAPE, REALITY, SPREADSHEET, OPENSFM] {
        for cut in (0..=text.len()).filter(|cut| text.is_char_boundary(*cut)) {
            check(parse_text(&text[..cut], Path::new("p")).ok());
            // Each byte in turn becomes another sign.
            if cut < text.len() {
                for sign in ["\0", "9", ",", "\n", "é"] {
                    let altered = [&text[..cut], sign, &text[cut + 1..]].concat();
                    check(parse_text(&altered, Path::new("p")).ok());
                }
            }
        }
    }
}

fn check(file: Option<PositionsFile>) {
    for StoredPosition { east_north, height_m, sigma_m, height_sigma_m, .. } in file.iter().flat_map(|f| &f.positions) {
        let optional = [*height_m, *sigma_m, *height_sigma_m];
        assert!(east_north.iter().flatten().chain(optional.iter().flatten()).all(|v| v.is_finite()));
    }
}

/// EXIF of a JPEG: big-endian TIFF with a GPS directory, then `tail` in place of the next directory's offset.
fn exif_jpeg(latitude: [u32; 3], south: bool, altitude: u32, below: u8) -> Vec<u8> {
    let entry = |tag: u16, kind: u16, count: u32, value: [u8; 4]| {
        [&tag.to_be_bytes()[..], &kind.to_be_bytes(), &count.to_be_bytes(), &value].concat()
    };
    let ascii = |letter: u8| [letter, 0, 0, 0];
    let mut tiff = b"MM\0*\0\0\0\x08".to_vec();
    tiff.extend(1u16.to_be_bytes());
    tiff.extend(entry(0x8825, 4, 1, 26u32.to_be_bytes()));
    tiff.extend([0; 4]);
    // The GPS directory at 26: six entries; its values follow.
    let values_at = 26 + 2 + 6 * 12 + 4;
    tiff.extend(6u16.to_be_bytes());
    tiff.extend(entry(1, 2, 2, ascii(if south { b'S' } else { b'N' })));
    tiff.extend(entry(2, 5, 3, (values_at as u32).to_be_bytes()));
    tiff.extend(entry(3, 2, 2, ascii(b'E')));
    tiff.extend(entry(4, 5, 3, (values_at as u32 + 24).to_be_bytes()));
    tiff.extend(entry(5, 1, 1, [below, 0, 0, 0]));
    tiff.extend(entry(6, 5, 1, (values_at as u32 + 48).to_be_bytes()));
    tiff.extend([0; 4]);
    for value in latitude.into_iter().chain([4, 27, 36]).chain([altitude]) {
        tiff.extend([value.to_be_bytes(), 1u32.to_be_bytes()].concat());
    }
    let segment = [&b"Exif\0\0"[..], &tiff].concat();
    let length = (segment.len() as u16 + 2).to_be_bytes();
    [&[0xFF, 0xD8, 0xFF, 0xE1][..], &length, &segment, &[0xFF, 0xD9]].concat()
}

#[test]
fn photographs_say_where_they_were_taken() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    std::fs::write(folder.path().join("sub/a.JPG"), exif_jpeg([51, 54, 18], false, 73, 0)).unwrap();
    std::fs::write(folder.path().join("b.jpg"), exif_jpeg([33, 30, 0], true, 5, 1)).unwrap();
    std::fs::write(folder.path().join("c.jpg"), [0xFF, 0xD8, 0xFF, 0xD9]).unwrap();
    std::fs::write(folder.path().join("notes.txt"), "no photograph").unwrap();
    let file = read_positions(folder.path()).unwrap();
    assert_eq!((file.format, &file.frame), ("EXIF GPS", &GEOGRAPHIC));
    let found = places(&file);
    assert_eq!((found[0].0, found[0].2), ("b.jpg", Some(-5.0)));
    assert!((found[0].1[1] + 33.5).abs() < 1e-12 && (found[0].1[0] - 4.46).abs() < 1e-12);
    assert!(found[1].0 == "sub/a.JPG" && (found[1].1[1] - 51.905).abs() < 1e-12);
    assert_eq!(file.warnings, ["1 photographs without a GPS position"]);
}

#[test]
fn a_folder_without_positions_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.jpg"), exif_jpeg([0, 0, 0], false, 0, 0)).unwrap();
    let message = read_positions(&folder.path().join("none")).unwrap_err().to_string();
    assert!(message.contains("cannot read the positions"), "{message}");
    std::fs::write(folder.path().join("a.jpg"), [0xFF, 0xD8]).unwrap();
    let message = read_positions(folder.path()).unwrap_err().to_string();
    assert!(message.contains("none of its 1 photographs says where it was taken"), "{message}");
}

#[test]
fn exif_that_is_cut_or_altered_anywhere_is_no_panic() {
    let whole = exif_jpeg([51, 54, 18], false, 73, 0);
    for cut in 0..whole.len() {
        let _ = parse_exif(whole[..cut].to_vec()).and_then(|exif| position(&exif, "a.jpg"));
        for byte in [0, 0x7F, 0xFF] {
            let mut altered = whole.clone();
            altered[cut] = byte;
            let found = parse_exif(altered).and_then(|exif| position(&exif, "a.jpg"));
            assert!(found.iter().flat_map(|p| p.east_north).flatten().all(f64::is_finite));
        }
    }
}

/// A database as COLMAP makes it, with what the queries look at.
fn colmap_database(path: &Path, tables: &str) {
    let database = rusqlite::Connection::open(path).unwrap();
    database
        .execute_batch(
            "CREATE TABLE images (image_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, camera_id INTEGER);",
        )
        .unwrap();
    database.execute_batch("INSERT INTO images VALUES (1, 'a.jpg', 1), (2, 'b.jpg', 1), (3, 'c.jpg', 1);").unwrap();
    database.execute_batch(tables).unwrap();
}

fn blob(numbers: &[f64]) -> String {
    let bytes = numbers.iter().flat_map(|v| v.to_le_bytes());
    format!("X'{}'", bytes.map(|b| format!("{b:02X}")).collect::<String>())
}

fn four(rows: &[(i64, i64, &str, &str, &str, i64)]) -> String {
    let mut text = "CREATE TABLE pose_priors (pose_prior_id INTEGER PRIMARY KEY, corr_data_id INTEGER, corr_sensor_id INTEGER, \
                    corr_sensor_type INTEGER, position BLOB, position_covariance BLOB, gravity BLOB, coordinate_system INTEGER);"
        .to_owned();
    for (image, sensor, position, covariance, gravity, system) in rows {
        text += &format!(
            "INSERT INTO pose_priors VALUES (NULL, {image}, 1, {sensor}, {position}, {covariance}, {gravity}, {system});"
        );
    }
    text
}

#[test]
fn colmap_four_has_positions_covariances_and_gravity_of_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("data base#1?.db");
    let nan = blob(&[f64::NAN; 3]);
    colmap_database(
        &path,
        &four(&[
            (
                1,
                0,
                &blob(&[51.9, 4.45, 73.0]),
                &blob(&[9.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 36.0]),
                &blob(&[0.0, 0.9, 0.4]),
                0,
            ),
            (2, 0, &nan, "NULL", &blob(&[0.0, 0.8, 0.6]), 0),
            (3, 1, &blob(&[1.0, 2.0, 3.0]), "NULL", "NULL", 1),
        ]),
    );
    let file = read_positions(&path).unwrap();
    assert_eq!((file.format, &file.frame, file.positions.len()), ("COLMAP database", &GEOGRAPHIC, 2));
    let StoredPosition { east_north, height_m, sigma_m, height_sigma_m, gravity_in_cam, .. } = &file.positions[0];
    assert_eq!((*east_north, *height_m), (Some([4.45, 51.9]), Some(73.0)));
    assert_eq!((*sigma_m, *height_sigma_m, *gravity_in_cam), (Some(3.0), Some(6.0), Some([0.0, 0.9, 0.4])));
    assert_eq!((file.positions[1].east_north, file.positions[1].gravity_in_cam), (None, Some([0.0, 0.8, 0.6])));
    let beside: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(beside.len(), 1, "nothing is left beside the database: {beside:?}");
}

#[test]
fn colmap_before_four_names_the_image_and_may_not_name_the_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("database.db");
    colmap_database(&path, &format!(
        "CREATE TABLE pose_priors (image_id INTEGER PRIMARY KEY, position BLOB, coordinate_system INTEGER, position_covariance BLOB);
         INSERT INTO pose_priors VALUES (1, {}, 1, NULL), (2, {}, 1, NULL), (3, {}, 0, NULL);",
        blob(&[500.0, 600.0, 7.0]),
        blob(&[510.0, 620.0, 8.0]),
        blob(&[51.0, 4.0, 0.0]),
    ));
    let file = read_positions(&path).unwrap();
    assert_eq!(file.frame, Frame::OfTheCity);
    assert_eq!(places(&file), [("a.jpg", [500.0, 600.0], Some(7.0)), ("b.jpg", [510.0, 620.0], Some(8.0))]);
    assert!(
        file.warnings[0].contains("1 positions of the database are in another coordinate system"),
        "{:?}",
        file.warnings
    );
}

#[test]
fn databases_that_hold_nothing_of_use_are_told_and_views_are_not_run() {
    let folder = tempfile::tempdir().unwrap();
    for (name, tables, says) in [
        ("none.db", String::new(), "no table pose_priors"),
        ("empty.db", four(&[]), "neither a position nor gravity"),
        ("short.db", four(&[(1, 0, "X'00'", "X'00'", "X'00'", 0)]), "neither a position nor gravity"),
        (
            "endless.db",
            "CREATE VIEW pose_priors AS WITH RECURSIVE n(image_id) AS (SELECT 1 UNION ALL SELECT image_id FROM n) \
             SELECT image_id, NULL AS position FROM n;"
                .into(),
            "no table pose_priors",
        ),
    ] {
        let path = folder.path().join(name);
        colmap_database(&path, &tables);
        let message = read_positions(&path).unwrap_err().to_string();
        assert!(message.contains(says) && message.contains(name), "{message}");
    }
}

#[test]
fn a_database_that_is_cut_or_altered_is_no_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("database.db");
    colmap_database(&path, &four(&[(1, 0, &blob(&[51.9, 4.45, 73.0]), "NULL", "NULL", 0)]));
    let whole = std::fs::read(&path).unwrap();
    let damaged = folder.path().join("damaged.db");
    for cut in (0..whole.len()).step_by(97) {
        std::fs::write(&damaged, &whole[..cut]).unwrap();
        assert!(read_positions(&damaged).is_err() || cut > 3 * whole.len() / 4, "cut at {cut}");
        let mut altered = whole.clone();
        altered[cut] ^= 0x5A;
        std::fs::write(&damaged, altered).unwrap();
        check(read_positions(&damaged).ok());
    }
    assert!(whole.starts_with(database::MAGIC));
}
