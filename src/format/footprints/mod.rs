//! Footprints with heights: Shapefile and GeoPackage, as prisms of ground, walls and flat roof (level of detail 1).
//!
//! `outline.rs` is a footprint, `prism.rs` what it becomes. `shp.rs` and `dbf.rs` read the two halves of a Shapefile here: the known
//! crates take memory for the counts of a header before they look at the bytes. `geopackage.rs` asks SQLite, `wkb.rs` reads its
//! geometries.

mod dbf;
mod fields;
mod geopackage;
mod outline;
mod prism;
mod shapefile;
mod shp;
#[cfg(test)]
pub(in crate::format) mod tests;
mod wkb;

pub use fields::FootprintFields;
pub use geopackage::{is_geopackage, read_geopackage};
pub use shapefile::{is_shapefile, read_shapefile};

use crate::format::surfaces::SurfaceFile;

/// Whether a file holds footprints, of which this room makes houses.
pub fn is_of_footprints(file: &SurfaceFile) -> bool {
    [shapefile::FORMAT, geopackage::FORMAT].contains(&file.format.as_str())
}
