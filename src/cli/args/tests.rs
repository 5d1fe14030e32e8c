use super::*;

#[test]
fn the_command_line_is_consistent() {
    use clap::CommandFactory;
    Args::command().debug_assert();
}

#[test]
fn up_is_a_word_or_a_direction() {
    assert_eq!("auto".parse(), Ok(UpArg::Auto));
    assert_eq!("0,-1,0".parse(), Ok(UpArg::Given([0.0, -1.0, 0.0])));
    for wrong in ["", "up", "1,2", "0,0,0", "NaN,0,1", "1,2,3,4", "inf,0,0"] {
        assert!(wrong.parse::<UpArg>().is_err(), "{wrong}");
    }
}

#[test]
fn a_scale_is_positive_and_finite() {
    assert_eq!("2.5".parse(), Ok(Scale(2.5)));
    for wrong in ["0", "-1", "NaN", "inf", "1,2", "x"] {
        assert!(wrong.parse::<Scale>().is_err(), "{wrong}");
    }
}

#[test]
fn a_coordinate_system_is_a_code_or_two() {
    let crs = |text: &str| text.parse::<CrsArg>();
    assert_eq!(crs("EPSG:28992"), Ok(CrsArg { horizontal: 28992, vertical: None }));
    assert_eq!(crs(" epsg:25832+7837 "), Ok(CrsArg { horizontal: 25832, vertical: Some(7837) }));
    assert_eq!(crs("7415"), Ok(CrsArg { horizontal: 7415, vertical: None }));
    for wrong in ["", "EPSG:", "RD", "EPSG:28992+", "EPSG:-1", "EPSG:1.5", "é", "EPSé:28992"] {
        assert!(crs(wrong).unwrap_err().contains("EPSG:28992"), "{wrong}");
    }
}
