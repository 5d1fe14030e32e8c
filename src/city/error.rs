//! Why files are no city.

use std::io;
use std::path::{Path, PathBuf};

use super::CityChange;
use crate::format::SurfaceError;
use crate::format::city_index::IndexFault;
use crate::format::cityjson::CityJsonError;
use crate::format::escaped;
use crate::format::gltf::GltfError;
use crate::format::obj::ObjError;

/// Why files are no city.
#[derive(Debug, thiserror::Error)]
pub enum CityError {
    #[error("cannot read the file: {reason}; expected a city model ({}) ({})", FORMATS, path.display())]
    Unreadable { path: PathBuf, reason: io::Error },
    #[error("{} ({})", escaped(&error.to_string()), escaped(&obj_place(path, error)))]
    Obj { path: PathBuf, error: ObjError },
    #[error("{} ({})", escaped(&error.to_string()), escaped(&gltf_place(path, error)))]
    Gltf { path: PathBuf, error: Box<GltfError> },
    #[error("{} ({})", escaped(&error.to_string()), escaped(&cityjson_place(path, error)))]
    CityJson { path: PathBuf, error: Box<CityJsonError> },
    #[error("{error} ({})", error.place_in(path))]
    Surfaces { path: PathBuf, error: Box<SurfaceError> },
    #[error("{found}, expected a city model ({}); {remedy} ({})", FORMATS, path.display())]
    OtherFormat { path: PathBuf, found: &'static str, remedy: &'static str },
    #[error("the file is of an unknown format, expected a city model ({}); convert it ({})", FORMATS, path.display())]
    UnknownFormat { path: PathBuf },
    #[error("the folder has no city model in it, {found}; expected files of {} ({})", FORMATS, path.display())]
    EmptyFolder { path: PathBuf, found: String },
    #[error("the city has no faces: {found}; expected polygons with an area ({})", path.display())]
    NoFaces { path: PathBuf, found: String },
    #[error(
        "the city has only footprints (level of detail 0), {count} polygons, which no photograph shows; expected walls and roofs: get \
         the model at level 1 or higher ({})",
        path.display()
    )]
    OnlyFootprints { path: PathBuf, count: u64 },
    #[error(
        "nothing of the city is at the level of detail that is asked for, or below it: all {count} polygons are higher; ask for a higher \
         one ({})",
        path.display()
    )]
    AboveWantedLevel { path: PathBuf, count: u64 },
    #[error(
        "vertex {vertex} comes to {} in the city's frame, farther than {limit:e} m from zero; check --city-unit and --city-origin ({})",
        place(position),
        path.display()
    )]
    OutOfReach { path: PathBuf, vertex: usize, position: [f64; 3], limit: f64 },
    #[error("more than 4 billion vertices or triangles; split the model ({})", path.display())]
    TooLarge { path: PathBuf },
    #[error("{fault}; make it again with `cityweld index` ({})", path.display())]
    Index { path: PathBuf, fault: IndexFault },
    #[error(
        "the city has changed since its index was made: {change}; make it again with `cityweld index` ({})",
        path.display()
    )]
    IndexOfOther { path: PathBuf, change: CityChange },
    #[error(
        "an index of a city is the whole city, read as it was when the index was made; give {found} to `cityweld index` ({})",
        path.display()
    )]
    IndexNotAlone { path: PathBuf, found: &'static str },
    #[error(
        "polygon {polygon} of object {object} has a corner at {}; expected finite coordinates in metres",
        place(corner)
    )]
    CornerNotFinite { polygon: usize, object: String, corner: [f64; 3] },
}

/// What is read.
pub(super) const FORMATS: &str =
    "CityJSON, CityGML, OBJ, glTF, GLB, 3D Tiles, STL, PLY with faces, Shapefile or GeoPackage";

fn place([x, y, z]: &[f64; 3]) -> String {
    format!("({x}, {y}, {z})")
}

fn obj_place(path: &Path, error: &ObjError) -> String {
    let object = error.object.as_ref().map_or(String::new(), |name| format!("object {name}, "));
    match error.line {
        0 => format!("{object}{}", path.display()),
        line => format!("{object}{}:{line}", path.display()),
    }
}

fn gltf_place(path: &Path, error: &GltfError) -> String {
    let object = error.object.as_ref().map_or(String::new(), |name| format!("object {name}, "));
    let place = if error.place.is_empty() { String::new() } else { format!("{}, ", error.place) };
    format!("{object}{place}{}", path.display())
}

fn cityjson_place(path: &Path, error: &CityJsonError) -> String {
    let object = error.object.as_ref().map_or(String::new(), |name| format!("object {name}, "));
    format!("{object}{}:{}:{}", path.display(), error.line, error.column)
}
