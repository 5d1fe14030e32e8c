//! The city model: polygons with their objects, in metres, z up, about a local origin.
//!
//! [`read_city`] takes OBJ, glTF, GLB and CityJSON files into one [`CityModel`]. What such files usually have wrong is tolerated
//! and counted in [`CityModel::warnings`]; what leaves no honest model is a [`CityError`].

mod axes;
mod build;
mod contents;
mod degrees;
mod edges;
mod error;
mod distance;
mod facet;
mod files;
mod foreign;
mod frame;
mod from_surfaces;
mod index;
mod join;
mod levels;
mod model;
mod options;
mod orientation;
mod origin;
mod plan_box;
mod polygons;
mod read;
mod recognise;
mod sorting;
mod source;
mod subset;
#[cfg(test)]
mod tests;
mod tiles;
mod triangulate;
mod units;
mod upright;
mod validate;
mod warning;
mod words;

pub use crate::format::crs::Crs;
pub use crate::format::surfaces::{Lod, SurfaceKind};
pub use contents::{CityContents, KindCounts};
pub use error::CityError;
pub use index::{CityChange, CityIndex, IndexDraft, IndexOverview, Surroundings};
pub use levels::CityLod;
pub use model::{CityModel, CityRole, CitySize, CitySource, Facet, FacetId, ObjectId, WholeCity};
pub use options::{CityOptions, CityUnit, CityUp};
pub use plan_box::PlanBox;
pub use read::{read_city, read_city_contents, read_city_files, read_city_within};
#[cfg(feature = "cli")]
pub use recognise::is_index_at;
pub use warning::{CityDefect, CityPlace, CityWarning};
