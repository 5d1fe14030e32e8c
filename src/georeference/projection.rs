//! Horizontal coordinates of one system to those of the city; heights are kept.
//!
//! proj4rs (against PROJ: 5 mm in the Dutch grid, 10 um in UTM); with datums of seven parameters it returns heights above another ellipsoid,
//! so its heights are not used.

use nalgebra::Vector3;
use proj4rs::Proj;

use super::GeoreferenceError;
use crate::format::positions::{Frame, GEOGRAPHIC};

/// The way from a file's frame to the city's.
pub(super) struct ToCity {
    way: Way,
    from: String,
    to: String,
    source_name: String,
}

enum Way {
    /// They are in the city's frame already.
    Same,
    Projected {
        from: Box<Proj>,
        to: Box<Proj>,
        tangent: Option<Tangent>,
    },
}

/// Where a latitude and longitude (degrees, WGS 84) lie in the city, east and north in metres. `source_name` is who says so.
pub fn from_geographic(
    [latitude_deg, longitude_deg]: [f64; 2],
    source_name: &str,
    city_frame: Option<&Frame>,
) -> Result<[f64; 2], GeoreferenceError> {
    let to_city = ToCity::new(&GEOGRAPHIC, city_frame, source_name)?;
    Ok(to_city.place([longitude_deg, latitude_deg], None)?.east_north)
}

/// A frame of east, north and up, in that of the Earth's centre.
struct Tangent {
    origin: Vector3<f64>,
    axes: [Vector3<f64>; 3],
}

/// Axes and flattening of the ellipsoid of WGS 84 (NGA.STND.0036, table 3.1).
const SEMI_MAJOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
const ECCENTRICITY_SQ: f64 = FLATTENING * (2.0 - FLATTENING);

/// A place after projection, city frame. `height_m` is the file's own.
pub(super) struct Projected {
    pub east_north: [f64; 2],
    pub height_m: Option<f64>,
}

impl ToCity {
    /// `city`: the city's frame where it is known.
    pub fn new(frame: &Frame, city: Option<&Frame>, source_name: &str) -> Result<ToCity, GeoreferenceError> {
        let same =
            |to: &str| ToCity { way: Way::Same, from: words(frame), to: to.into(), source_name: source_name.into() };
        let Some(city) = city.filter(|city| **city != Frame::OfTheCity) else {
            let from = if *frame == Frame::OfTheCity { None } else { Some(proj_of(frame)?) };
            return match from {
                Some(proj) if proj.is_latlong() => {
                    Err(GeoreferenceError::CityUnknown { source_name: source_name.into() })
                }
                _ => Ok(same("the city's")),
            };
        };
        if *frame == Frame::OfTheCity || frame == city {
            return Ok(same(&words(city)));
        }
        let tangent = match *frame {
            Frame::Tangent { latitude_deg, longitude_deg, height_m } => {
                Some(Tangent::at(latitude_deg, longitude_deg, height_m))
            }
            _ => None,
        };
        let way = Way::Projected { from: Box::new(proj_of(frame)?), to: Box::new(proj_of(city)?), tangent };
        Ok(ToCity { way, from: words(frame), to: words(city), source_name: source_name.into() })
    }

    /// Whether heights are the city's own for sure.
    pub fn keeps_heights(&self) -> bool {
        matches!(self.way, Way::Same)
    }

    /// Whether the file's heights are those of satellite positions: above the ellipsoid, unless somebody has converted them.
    pub fn is_geographic(&self) -> bool {
        matches!(&self.way, Way::Projected { from, .. } if from.is_latlong())
    }

    pub fn place(&self, east_north: [f64; 2], height_m: Option<f64>) -> Result<Projected, GeoreferenceError> {
        let Way::Projected { from, to, tangent } = &self.way else { return Ok(Projected { east_north, height_m }) };
        let (start, height_m) = match tangent {
            None => (east_north, height_m),
            Some(tangent) => {
                let [longitude, latitude, height] = tangent.geographic(east_north, height_m.unwrap_or(0.0));
                ([longitude, latitude], height_m.map(|_| height))
            }
        };
        let end = transformed(from, to, start).map_err(|reason| GeoreferenceError::Projection {
            place: format!("{}, {}", start[0], start[1]),
            way: format!("from {} to {}", self.from, self.to),
            reason,
            source_name: self.source_name.clone(),
        })?;
        Ok(Projected { east_north: end, height_m })
    }

    /// Longitude and latitude of a place of the city, degrees; `None` where its frame is not known.
    pub fn geographic(&self, east_north: [f64; 2]) -> Option<[f64; 2]> {
        let Way::Projected { to, .. } = &self.way else { return None };
        transformed(to, &proj_of(&GEOGRAPHIC).ok()?, east_north).ok()
    }
}

impl Tangent {
    fn at(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Tangent {
        let ((s, c), (sl, cl)) = (latitude_deg.to_radians().sin_cos(), longitude_deg.to_radians().sin_cos());
        let normal_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQ * s * s).sqrt();
        let up = Vector3::new(c * cl, c * sl, s);
        let origin = up.component_mul(&Vector3::new(1.0, 1.0, 1.0 - ECCENTRICITY_SQ)) * normal_m + up * height_m;
        let east = Vector3::new(-sl, cl, 0.0);
        Tangent { origin, axes: [east, up.cross(&east), up] }
    }

    /// Longitude, latitude (degrees) and height above the ellipsoid. Latitude by fixed points: each step is better by the eccentricity's
    /// square, 0.7 %.
    fn geographic(&self, [east, north]: [f64; 2], up: f64) -> [f64; 3] {
        let p = self.origin + self.axes[0] * east + self.axes[1] * north + self.axes[2] * up;
        let across = p.xy().norm();
        let mut latitude = p.z.atan2(across * (1.0 - ECCENTRICITY_SQ));
        for _ in 0..8 {
            let s = latitude.sin();
            latitude =
                (p.z + ECCENTRICITY_SQ * SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQ * s * s).sqrt() * s).atan2(across);
        }
        let (s, c) = latitude.sin_cos();
        let height = across * c + p.z * s - SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQ * s * s).sqrt();
        [p.y.atan2(p.x).to_degrees(), latitude.to_degrees(), height]
    }
}

/// A place taken from one system to another; degrees where a system is of longitude and latitude.
fn transformed(from: &Proj, to: &Proj, [x, y]: [f64; 2]) -> Result<[f64; 2], String> {
    let start = if from.is_latlong() { (x.to_radians(), y.to_radians(), 0.0) } else { (x, y, 0.0) };
    let mut point = start;
    proj4rs::transform::transform(from, to, &mut point).map_err(|error| error.to_string())?;
    if !(point.0.is_finite() && point.1.is_finite()) {
        return Err("the result is no number".into());
    }
    Ok(if to.is_latlong() { [point.0.to_degrees(), point.1.to_degrees()] } else { [point.0, point.1] })
}

fn proj_of(frame: &Frame) -> Result<Proj, GeoreferenceError> {
    let text = match frame {
        Frame::Epsg(code) => {
            u16::try_from(*code).ok().and_then(crs_definitions::from_code).map(|def| def.proj4.to_owned())
        }
        Frame::Proj(text) => Some(text.clone()),
        Frame::Tangent { .. } => return proj_of(&GEOGRAPHIC),
        Frame::OfTheCity => None,
    };
    let unknown = || GeoreferenceError::UnknownSystem { name: words(frame) };
    let proj = text.and_then(|text| Proj::from_proj_string(&text).ok()).ok_or_else(unknown)?;
    if proj.is_geocent() { Err(unknown()) } else { Ok(proj) }
}

fn words(frame: &Frame) -> String {
    match frame {
        Frame::OfTheCity => "the city's system".into(),
        Frame::Epsg(code) => format!("EPSG:{code}"),
        Frame::Proj(text) => format!("\"{text}\""),
        Frame::Tangent { .. } => "the plane at reference_lla".into(),
    }
}
