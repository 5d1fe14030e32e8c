use super::*;
use crate::format::wkt::WktCrs;

fn las(units: [Option<(&str, f64)>; 2], is_geographic: bool) -> LasCloud {
    let [horizontal, vertical] = units.map(|unit| unit.map(|(name, metres)| WktUnit { name: name.into(), metres }));
    let understood = WktCrs { epsg: Some(2994), is_geographic, horizontal, vertical, ..WktCrs::default() };
    LasCloud {
        positions: vec![[10.0, 20.0, 30.0], [11.0, 20.0, 60.0]],
        crs: Some(LasCrs { text: "EPSG:2994".into(), understood }),
        ..LasCloud::default()
    }
}

fn read(cloud: LasCloud) -> Result<Reconstruction, ReconstructionError> {
    of_las(Path::new("a/cloud.las"), cloud, None)
}

#[test]
fn metres_are_nothing_to_tell_and_feet_are() {
    let metres = read(las([Some(("metre", 1.0)), Some(("m", 1.0))], false)).unwrap();
    assert_eq!(metres.warnings, []);
    assert_eq!(metres.crs, Some(Crs { text: "EPSG:2994".into(), epsg: Some(2994), vertical: None }));
    let feet = read(las([Some(("US survey foot", 0.304800609)), None], false)).unwrap();
    let told = feet.warnings[0].to_string();
    assert!(feet.warnings.len() == 1 && told.contains("us survey feet") && told.contains("0.3048"), "{told}");
    assert_eq!(feet.points[0], Point3::new(10.0, 20.0, 30.0), "coordinates stay as they are");
}

#[test]
fn heights_in_another_unit_are_brought_to_that_of_the_plan() {
    let read = read(las([Some(("metre", 1.0)), Some(("foot", 0.3048))], false)).unwrap();
    assert_eq!(read.warnings[0].kind, WarningKind::HeightsBrought);
    assert!((read.points[1] - Point3::new(11.0, 20.0, 60.0 * 0.3048)).norm() < 1e-12);
    // Two feet that differ by two millionths are one.
    let alike = super::tests::read(las([Some(("foot", 0.3048)), Some(("US survey foot", 0.3048006))], false)).unwrap();
    assert_eq!(alike.warnings.len(), 1);
}

#[test]
fn degrees_are_refused_with_the_way_out_unless_the_numbers_are_none() {
    let error = read(las([None, None], true)).unwrap_err().to_string();
    assert!(error.contains("latitude and longitude") && error.contains("pdal"), "{error}");
    let mut metric = las([None, None], true);
    metric.positions[1] = [500_000.0, 5_000_000.0, 10.0];
    assert!(read(metric).is_ok());
}

#[test]
fn noise_bytes_without_a_name_and_times_that_stay_packed_are_told() {
    let positions = vec![[1.0; 3]];
    let cloud = LasCloud { noise: 3, extra_bytes: 4, times_left_out: true, positions, ..LasCloud::default() };
    let told: Vec<String> = read(cloud).unwrap().warnings.iter().map(ToString::to_string).collect();
    assert!(told[0].starts_with("3 points classified as noise") && told[1].contains("4 bytes"), "{told:?}");
    assert!(told[2].contains("gps_time"), "{told:?}");
}

#[test]
fn files_of_noise_alone_have_no_points() {
    let cloud = LasCloud { noise: 3, ..LasCloud::default() };
    assert!(matches!(read(cloud), Err(ReconstructionError::NoPoints { .. })));
}

#[test]
fn a_scan_tells_what_it_loses() {
    let cloud = E57Cloud {
        positions: vec![[1.0; 3]],
        invalid: 2,
        not_carried: vec!["rowIndex".into(), "nor:normalX".into()],
        crs: Some(r#"PROJCS["a",UNIT["metre",1],AUTHORITY["EPSG","25832"]]"#.into()),
        ..E57Cloud::default()
    };
    let read = of_e57(Path::new("scan.e57"), cloud).unwrap();
    let told: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    assert!(
        told.len() == 2 && told[0].starts_with("2 points") && told[1].contains("rowIndex, nor:normalX"),
        "{told:?}"
    );
    assert_eq!((read.crs.unwrap().epsg, read.format), (Some(25832), SfmFormat::E57));
}
