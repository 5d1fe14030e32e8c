//! `--classes`: which points of a LAS, LAZ or COPC cloud take part.

use std::path::{Path, PathBuf};

use cityweld::{SfmOptions, read_reconstruction, read_reconstruction_with};
use las::point::{Classification, Format};
use las::{Builder, Point, Writer};

/// Ground, noise, and two of a building.
fn cloud(folder: &Path, format: u8, is_compressed: bool) -> PathBuf {
    let mut builder = Builder::from((1, 4));
    builder.point_format = Format::new(format).unwrap();
    builder.point_format.is_compressed = is_compressed;
    let path = folder.join(format!("cloud_{format}_{is_compressed}.las"));
    let mut writer = Writer::from_path(&path, builder.into_header().unwrap()).unwrap();
    for (x, class) in [(1.0, 2), (2.0, 7), (3.0, 6), (4.0, 6)] {
        let classification = Classification::new(class).unwrap();
        let gps_time = Some(x);
        writer.write_point(Point { x, classification, gps_time, ..Point::default() }).unwrap();
    }
    writer.close().unwrap();
    path
}

#[test]
fn points_of_the_classes_that_are_named_take_part_even_noise_and_the_others_are_counted() {
    let room = tempfile::tempdir().unwrap();
    for (format, is_compressed) in [(1, false), (1, true), (6, false), (6, true)] {
        let path = cloud(room.path(), format, is_compressed);
        let places = |classes: Option<&[u8]>| {
            let options = classes.map_or(SfmOptions::default(), |classes| SfmOptions::default().with_classes(classes));
            let read = read_reconstruction_with(&path, &options).unwrap();
            let told: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
            (read.points.iter().map(|point| point.x).collect::<Vec<_>>(), told.join("\n"))
        };
        assert_eq!(places(None).0, [1.0, 3.0, 4.0]);
        let (found, told) = places(Some(&[2, 6]));
        assert_eq!(found, [1.0, 3.0, 4.0]);
        assert!(told.contains("1 points of other classes than were asked for, left out"), "{told}");
        assert_eq!(places(Some(&[7])).0, [2.0]);
    }
}

#[test]
fn classes_that_are_not_there_are_refused_with_those_that_are() {
    let room = tempfile::tempdir().unwrap();
    let building = SfmOptions::default().with_classes([9]);
    let error = read_reconstruction_with(&cloud(room.path(), 6, true), &building).unwrap_err().to_string();
    assert!(error.contains("no points of the classes 9; it has the classes 2, 6, 7"), "{error}");
    let sfm = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample/sfm");
    assert!(read_reconstruction(&sfm).is_ok());
    let error = read_reconstruction_with(&sfm, &building).unwrap_err().to_string();
    assert!(error.contains("leave --classes out"), "{error}");
}
