use super::*;
use crate::place_search::Disc;

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
fn a_disc_is_in_metres_of_the_city_or_in_degrees_with_a_radius_that_says_metres() {
    let disc = Disc { center: [85120.0, -447250.0], radius_m: 300.0 };
    assert_eq!("85120,-447250,300".parse(), Ok(Near::City(disc)));
    assert_eq!("85120,-447250,12,300".parse(), Ok(Near::City(disc)));
    let degrees = Near::Geographic { latitude_deg: 51.9, longitude_deg: -4.48, radius_m: 300.0 };
    assert_eq!("51.9,-4.48,300m".parse(), Ok(degrees));
    for wrong in
        ["", "1,2", "1,2,0", "1,2,3,4,5", "1,2,x", "91,4,300m", "51,181,300m", "51,4,0m", "51,4,m", "51,4,1,300m"]
    {
        assert!(wrong.parse::<Near>().unwrap_err().contains("letter m"), "{wrong}");
    }
}
