//! The city model: polygons with their objects, in metres, z up, about a local origin.
//!
//! [`read_city`] takes OBJ, glTF and GLB files into one [`CityModel`]. What such files usually have wrong is tolerated
//! and counted in [`CityModel::warnings`]; what leaves no honest model is a [`CityError`].

mod build;
mod distance;
mod facet;
mod join;
mod model;
mod orientation;
mod origin;
mod polygons;
mod read;
mod recognise;
mod signed_links;
mod source;
mod subset;
#[cfg(test)]
mod tests;
mod triangulate;
mod validate;
mod warning;

pub use model::{CityModel, CityRole, CitySource, Facet, FacetId, ObjectId};
pub use read::{CityError, CityOptions, CityUp, read_city};
pub use warning::{CityDefect, CityPlace, CityWarning};
