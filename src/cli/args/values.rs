//! Values of options: what is typed, checked at once.

use std::str::FromStr;
use std::time::Duration;

use crate::place_search::Disc;

/// `--up`
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UpArg {
    Auto,
    None,
    Given([f64; 3]),
}

impl FromStr for UpArg {
    type Err = String;

    fn from_str(text: &str) -> Result<UpArg, String> {
        match text {
            "auto" => Ok(UpArg::Auto),
            "none" => Ok(UpArg::None),
            _ => match *numbers(text).ok_or("expected auto, none, or three numbers X,Y,Z")? {
                [0.0, 0.0, 0.0] => Err("the zero vector points nowhere".into()),
                [x, y, z] => Ok(UpArg::Given([x, y, z])),
                _ => Err("expected auto, none, or three numbers X,Y,Z".into()),
            },
        }
    }
}

/// `--scale`, metres per reconstruction unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(pub f64);

/// `--scale-range`: metres per reconstruction unit, the least and the most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleRange(pub [f64; 2]);

/// `--budget`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget(pub Duration);

/// A chance, above 0 and below 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probability(pub f64);

impl FromStr for Probability {
    type Err = String;

    fn from_str(text: &str) -> Result<Probability, String> {
        match text.trim().parse() {
            Ok(chance) if chance > 0.0 && chance < 1.0 => Ok(Probability(chance)),
            _ => Err("expected a number above 0 and below 1, such as 0.001".to_owned()),
        }
    }
}

impl FromStr for Scale {
    type Err = String;

    fn from_str(text: &str) -> Result<Scale, String> {
        match numbers(text).as_deref() {
            Some([scale]) if *scale > 0.0 => Ok(Scale(*scale)),
            _ => Err("expected a finite number above 0: metres per reconstruction unit".into()),
        }
    }
}

impl FromStr for Budget {
    type Err = String;

    fn from_str(text: &str) -> Result<Budget, String> {
        let seconds = numbers(text).and_then(|numbers| <[f64; 1]>::try_from(numbers).ok());
        let budget = seconds.filter(|[seconds]| *seconds > 0.0).and_then(|[s]| Duration::try_from_secs_f64(s).ok());
        budget.map(Budget).ok_or_else(|| "expected a number above 0: seconds".into())
    }
}

impl FromStr for ScaleRange {
    type Err = String;

    fn from_str(text: &str) -> Result<ScaleRange, String> {
        match numbers(text).as_deref() {
            Some(&[least, most]) if least > 0.0 && least <= most => Ok(ScaleRange([least, most])),
            _ => Err("expected LEAST,MOST: two finite numbers above 0, metres per reconstruction unit".into()),
        }
    }
}

/// `--near`: a disc in plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Near {
    /// In the city's frame, metres.
    City(Disc),
    /// About a place on WGS 84.
    Geographic { latitude_deg: f64, longitude_deg: f64, radius_m: f64 },
}

impl FromStr for Near {
    type Err = String;

    fn from_str(text: &str) -> Result<Near, String> {
        let is_latitude = |degrees: f64| degrees.abs() <= 90.0;
        let is_longitude = |degrees: f64| degrees.abs() <= 180.0;
        match (text.strip_suffix('m'), numbers(text.strip_suffix('m').unwrap_or(text)).as_deref()) {
            (None, Some(&[x, y, radius_m] | &[x, y, _, radius_m])) if radius_m > 0.0 => {
                Ok(Near::City(Disc { center: [x, y], radius_m }))
            }
            (Some(_), Some(&[latitude_deg, longitude_deg, radius_m]))
                if radius_m > 0.0 && is_latitude(latitude_deg) && is_longitude(longitude_deg) =>
            {
                Ok(Near::Geographic { latitude_deg, longitude_deg, radius_m })
            }
            _ => Err("expected X,Y,RADIUS or X,Y,Z,RADIUS in metres of the city, or LATITUDE,LONGITUDE,RADIUSm in degrees with the \
                      letter m behind the radius (51.9,4.48,300m); a radius above 0"
                .into()),
        }
    }
}

/// `--accuracy`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy(pub f64);

impl FromStr for Accuracy {
    type Err = String;

    fn from_str(text: &str) -> Result<Accuracy, String> {
        match numbers(text).as_deref() {
            Some([metres]) if *metres > 0.0 => Ok(Accuracy(*metres)),
            _ => Err("expected a finite number above 0: metres".into()),
        }
    }
}

/// Finite numbers between commas.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    let parsed = text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|v| v.is_finite()));
    parsed.collect()
}
