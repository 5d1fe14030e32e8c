//! Files to city model: which format it is, what went wrong where.

use std::io;
use std::path::{Path, PathBuf};

use super::build::build;
use super::levels::choose;
use super::recognise::{Format, recognise};
use super::source::Source;
use super::{CityLod, CityModel, CityRole};
use crate::format::cityjson::{self, CityJsonError};
use crate::format::escaped;
use crate::format::file::{LARGEST_MODEL_BYTES, read_regular};
use crate::format::gltf::{self, GltfError};
use crate::format::obj::{self, ObjError};

/// How to take city files.
#[derive(Clone, Copy, Debug, Default)]
pub struct CityOptions {
    /// Which axis of OBJ files points up; glTF is y up by its standard.
    pub up: CityUp,
    /// Which level of detail is taken, where a file has several.
    pub lod: CityLod,
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CityUp {
    #[default]
    Z,
    /// (x, y, z) becomes (x, -z, y).
    Y,
}

/// Why files are no city.
#[derive(Debug, thiserror::Error)]
pub enum CityError {
    #[error("cannot read the file: {reason}; expected an OBJ, glTF, GLB or CityJSON file ({})", path.display())]
    Unreadable { path: PathBuf, reason: io::Error },
    #[error("{} ({})", escaped(&error.to_string()), escaped(&obj_place(path, error)))]
    Obj { path: PathBuf, error: ObjError },
    #[error("{} ({})", escaped(&error.to_string()), escaped(&gltf_place(path, error)))]
    Gltf { path: PathBuf, error: Box<GltfError> },
    #[error("{} ({})", escaped(&error.to_string()), escaped(&cityjson_place(path, error)))]
    CityJson { path: PathBuf, error: Box<CityJsonError> },
    #[error("{found}, expected an OBJ, glTF, GLB or CityJSON file; {remedy} ({})", path.display())]
    OtherFormat { path: PathBuf, found: &'static str, remedy: &'static str },
    #[error("the city has no faces: {found}; expected polygons (`f` lines, or triangles of a mesh) ({})", path.display())]
    NoFaces { path: PathBuf, found: String },
    #[error("more than 4 billion vertices or triangles; split the model ({})", path.display())]
    TooLarge { path: PathBuf },
    #[error(
        "polygon {polygon} of object {object} has a corner at {}; expected finite coordinates in metres",
        place(corner)
    )]
    CornerNotFinite { polygon: usize, object: String, corner: [f64; 3] },
}

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

/// Reads CITY and further meshes (terrain) into one model with one common origin.
pub fn read_city(city: &Path, terrain: &[PathBuf], options: &CityOptions) -> Result<CityModel, CityError> {
    let mut sources = vec![read_source(city, CityRole::City, options)?];
    for path in terrain {
        sources.push(read_source(path, CityRole::Terrain, options)?);
    }
    build(sources)
}

fn read_source(path: &Path, role: CityRole, options: &CityOptions) -> Result<Source, CityError> {
    let bytes = read_regular(path, LARGEST_MODEL_BYTES)
        .map_err(|reason| CityError::Unreadable { path: path.to_owned(), reason })?;
    match recognise(&bytes, path)? {
        Format::Gltf => {
            let folder = path.parent().unwrap_or(Path::new(""));
            let file = gltf::read_gltf(&bytes, folder);
            let file = file.map_err(|error| CityError::Gltf { path: path.to_owned(), error: Box::new(error) })?;
            Ok(Source::from_gltf(path, role, file))
        }
        Format::CityJson => {
            let file = cityjson::read_cityjson(&bytes);
            let file = file.map_err(|error| CityError::CityJson { path: path.to_owned(), error: Box::new(error) })?;
            drop(bytes);
            let chosen = choose(&file, options.lod, role);
            Ok(Source::from_surfaces(path, role, file, &chosen))
        }
        Format::Obj => {
            let file = obj::read_obj(&bytes).map_err(|error| CityError::Obj { path: path.to_owned(), error })?;
            Ok(Source::from_obj(path, role, options.up, file))
        }
    }
}
