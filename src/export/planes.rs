//! What the program sees in a city model: its planes, as JSON, and as a GLB coloured by plane.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use super::ExportError;
use super::gltf::write_colored_city;
use super::report::ReportError;
use crate::city::{CityContents, CityModel, Crs, KindCounts, Lod};
use crate::geometry::{Point3, Vector3};
use crate::planes::{CityPlane, CityPlanes};

const SCHEMA: &str = "cityweld.planes/1";

/// Steepness, as |z| of the unit normal, up to which a plane counts as a wall, and from which as level: 10 degrees off.
const WALL_BELOW: f64 = 0.1736;
const LEVEL_ABOVE: f64 = 0.9848;

/// How a plane lies; for counting and telling only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneAttitude {
    Wall,
    Slanted,
    LevelUp,
    LevelDown,
}

impl PlaneAttitude {
    pub fn of(normal: &Vector3<f64>) -> PlaneAttitude {
        match normal.z {
            z if z.abs() <= WALL_BELOW => PlaneAttitude::Wall,
            z if z >= LEVEL_ABOVE => PlaneAttitude::LevelUp,
            z if z <= -LEVEL_ABOVE => PlaneAttitude::LevelDown,
            _ => PlaneAttitude::Slanted,
        }
    }
}

/// The planes of a city as JSON text. `files` are named as they shall stand in it.
pub fn planes_report(city: &CityModel, planes: &CityPlanes, files: &[String]) -> Result<String, ReportError> {
    let (low, high) = city.bounds().unwrap_or((Point3::origin(), Point3::origin()));
    let absolute = |p: &Point3<f64>| <[f64; 3]>::from((p + city.origin).coords);
    #[derive(Serialize)]
    struct PlanesJson<'a> {
        schema: &'static str,
        files: &'a [String],
        crs: Option<&'a Crs>,
        /// What each file holds before levels of detail were chosen.
        contents: Vec<ContentsJson<'a>>,
        origin: Box<RawValue>,
        low: Box<RawValue>,
        high: Box<RawValue>,
        objects: usize,
        facets: usize,
        triangles: usize,
        /// `normal . (x - origin) + offset = 0`, metres.
        planes: Vec<Box<RawValue>>,
        warnings: Vec<String>,
        program: &'static str,
    }
    let rows = planes.planes.iter().map(|plane| to_raw_value(&row(city, plane, absolute)));
    let report = PlanesJson {
        schema: SCHEMA,
        files,
        crs: city.crs.as_ref(),
        contents: city.sources.iter().map(|source| ContentsJson::of(&source.contents)).collect(),
        origin: to_raw_value(city.origin.as_slice())?,
        low: to_raw_value(&absolute(&low))?,
        high: to_raw_value(&absolute(&high))?,
        objects: city.objects.len(),
        facets: city.facets.len(),
        triangles: city.triangles.len(),
        planes: rows.collect::<Result<_, _>>()?,
        warnings: city.warnings.iter().map(ToString::to_string).collect(),
        program: concat!("cityweld ", env!("CARGO_PKG_VERSION")),
    };
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

#[derive(Serialize)]
struct ContentsJson<'a> {
    format: &'a str,
    objects: usize,
    parts: usize,
    /// By level of detail, then by kind; what is not there is left out.
    polygons: BTreeMap<String, BTreeMap<&'static str, usize>>,
    holes: usize,
}

impl ContentsJson<'_> {
    fn of(contents: &CityContents) -> ContentsJson<'_> {
        let CityContents { format, objects, parts, polygons, holes, .. } = contents;
        let level = |lod: &Option<Lod>| lod.map_or_else(|| "unsaid".to_owned(), |lod| lod.to_string());
        let kinds = |counts: &KindCounts| counts.named().filter(|(_, count)| *count > 0).collect();
        let polygons = polygons.iter().map(|(lod, counts)| (level(lod), kinds(counts))).collect();
        ContentsJson { format, objects: *objects, parts: *parts, polygons, holes: *holes }
    }
}

#[derive(Serialize)]
struct PlaneJson<'a> {
    object: &'a str,
    normal: [f64; 3],
    offset: f64,
    area_m2: f64,
    facets: usize,
    low: [f64; 3],
    high: [f64; 3],
}

fn row<'a>(city: &'a CityModel, plane: &CityPlane, absolute: impl Fn(&Point3<f64>) -> [f64; 3]) -> PlaneJson<'a> {
    PlaneJson {
        object: city.object_name(plane.object),
        normal: plane.plane.normal.into(),
        offset: plane.plane.offset,
        area_m2: plane.area_m2,
        facets: plane.facets.len(),
        low: absolute(&plane.low),
        high: absolute(&plane.high),
    }
}

/// Writes a city whose planes have colours of their own.
pub fn write_planes_glb(path: &Path, city: &CityModel, planes: &CityPlanes) -> Result<(), ExportError> {
    let colors: Vec<[u8; 3]> = planes.plane_of_facet.iter().map(|plane| color_of(plane.0)).collect();
    write_colored_city(path, "planes", city, &colors)
}

/// Hues by the golden ratio: neighbours in number are far apart on the circle.
fn color_of(number: u32) -> [u8; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let hue = (f64::from(number) * GOLDEN).fract() * 6.0;
    // Light enough to show its shading: saturation 0.55, value 0.95.
    [5.0, 3.0, 1.0].map(|shift| {
        let k = (shift + hue) % 6.0;
        let fall = k.min(4.0 - k).clamp(0.0, 1.0);
        (255.0 * 0.95 * (1.0 - 0.55 * fall)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_walls_from_floors() {
        let lie = |x, y, z| PlaneAttitude::of(&Vector3::new(x, y, z).normalize());
        assert_eq!(lie(1.0, 0.0, 0.1), PlaneAttitude::Wall);
        assert_eq!(lie(0.0, 0.1, 1.0), PlaneAttitude::LevelUp);
        assert_eq!(lie(0.0, 0.1, -1.0), PlaneAttitude::LevelDown);
        assert_eq!(lie(0.0, 1.0, 1.0), PlaneAttitude::Slanted);
    }

    #[test]
    fn gives_neighbouring_numbers_different_colors() {
        for number in 0..50 {
            let (a, b) = (color_of(number), color_of(number + 1));
            assert!(a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max() > Some(40), "{number}: {a:?} {b:?}");
        }
    }
}
