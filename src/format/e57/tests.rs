use e57::{
    E57Writer, IntensityLimits, Quaternion, Record, RecordDataType, RecordName, RecordValue, Transform, Translation,
};

use super::*;

/// The points of a scan, whether it has a colour and an intensity, and its pose.
type Scan<'a> = (&'a [[f64; 3]], bool, Option<Transform>);

fn file(scans: &[Scan]) -> tempfile::NamedTempFile {
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut writer = E57Writer::from_file(file.path(), "file").unwrap();
    for (number, (points, has_color, pose)) in scans.iter().enumerate() {
        let mut prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
        if *has_color {
            prototype.extend([Record::COLOR_RED_U8, Record::COLOR_GREEN_U8, Record::COLOR_BLUE_U8]);
            prototype.push(Record {
                name: RecordName::Intensity,
                data_type: RecordDataType::Single { min: None, max: None },
            });
        }
        let mut scan = writer.add_pointcloud(&format!("scan {number}"), prototype).unwrap();
        scan.set_transform(pose.clone());
        for point in *points {
            let mut values: Vec<RecordValue> = point.iter().map(|v| RecordValue::Double(*v)).collect();
            if *has_color {
                values.extend([255, 128, 0].map(RecordValue::Integer));
                values.push(RecordValue::Single(0.5));
            }
            scan.add_point(values).unwrap();
        }
        scan.finalize().unwrap();
    }
    writer.finalize().unwrap();
    drop(writer);
    file
}

fn pose(z_turn_rad: f64, x: f64) -> Option<Transform> {
    let (sine, cosine) = (0.5 * z_turn_rad).sin_cos();
    Some(Transform {
        rotation: Quaternion { w: cosine, x: 0.0, y: 0.0, z: sine },
        translation: Translation { x, y: 0.0, z: 0.0 },
    })
}

#[test]
fn every_scan_stands_at_its_pose_and_its_points_say_which_it_is() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let cloud =
        read_e57(file(&[(&[[1.0, 0.0, 2.0]], false, pose(quarter, 10.0)), (&[[3.0, 4.0, 5.0]], false, None)]).path());
    let cloud = cloud.unwrap();
    let expected = [[10.0, 1.0, 2.0], [3.0, 4.0, 5.0]];
    let off = cloud.positions.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-12 && cloud.positions.len() == 2, "{:?}", cloud.positions);
    assert_eq!((cloud.fields[0].name.as_str(), cloud.fields[0].value(1)), ("scan", Some(1.0)));
    assert!(cloud.colors.is_empty());
}

#[test]
fn colours_and_intensity_are_read() {
    let cloud = read_e57(file(&[(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], true, None)]).path()).unwrap();
    assert_eq!(cloud.colors, [[255, 128, 0]; 2]);
    assert_eq!((cloud.fields[0].name.as_str(), cloud.fields[0].len()), ("intensity", 2));
}

#[test]
fn points_that_are_no_numbers_are_left_out_and_counted() {
    let cloud = read_e57(file(&[(&[[1.0, f64::NAN, 3.0], [4.0, 5.0, 6.0]], false, None)]).path()).unwrap();
    assert_eq!((cloud.invalid, cloud.positions.as_slice()), (1, [[4.0, 5.0, 6.0]].as_slice()));
}

#[test]
fn more_points_than_bytes_are_refused() {
    let scan = PointCloud::default();
    assert!(check_count(&scan, 0).is_ok());
    let mut lying = PointCloud::default();
    lying.records = 1025;
    assert_eq!(check_count(&lying, 1024), Err(1025));
    let (path, place) = ("a.e57".into(), "scan 1 of 1".into());
    let message = E57Error::TooDense { path, place, points: 1025, length: 1024 }.to_string();
    assert!(message.contains("1025 points") && message.contains("one for each byte") && message.contains("or as LAS"));
}

#[test]
fn limits_that_are_no_numbers_are_an_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut writer = E57Writer::from_file(file.path(), "file").unwrap();
    let mut prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
    let data_type = RecordDataType::Single { min: None, max: None };
    prototype.push(Record { name: RecordName::Intensity, data_type });
    let mut scan = writer.add_pointcloud("scan", prototype).unwrap();
    let [intensity_min, intensity_max] = [0.0, f32::NAN].map(|limit| Some(RecordValue::Single(limit)));
    scan.set_intensity_limits(Some(IntensityLimits { intensity_min, intensity_max }));
    let mut values: Vec<RecordValue> = [1.0, 2.0, 3.0].map(RecordValue::Double).to_vec();
    values.push(RecordValue::Single(0.5));
    scan.add_point(values).unwrap();
    scan.finalize().unwrap();
    writer.finalize().unwrap();
    let message = read_e57(file.path()).unwrap_err().to_string();
    assert!(message.contains("contradicts itself"), "{message}");
}

#[test]
fn cut_and_changed_files_never_panic() {
    let points: Vec<[f64; 3]> = (0..30).map(|i| [f64::from(i), 0.5, -2.0]).collect();
    let bytes = std::fs::read(file(&[(&points, true, None), (&points, false, pose(0.1, 3.0))]).path()).unwrap();
    let target = tempfile::NamedTempFile::new().unwrap();
    for at in (0..bytes.len()).step_by(7) {
        std::fs::write(target.path(), &bytes[..at]).unwrap();
        assert!(read_e57(target.path()).is_err(), "cut at {at}");
        for value in [0, 0xFF, b'9'] {
            let mut changed = bytes.clone();
            changed[at] = value;
            std::fs::write(target.path(), &changed).unwrap();
            let _ = read_e57(target.path());
        }
    }
}
