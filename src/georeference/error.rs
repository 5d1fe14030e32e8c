//! Why a source does not say where a reconstruction stands.

use crate::geometry::{Point3, StartError};

/// Why positions or control points place nothing. `source` names the file.
#[derive(Debug, thiserror::Error)]
pub enum GeoreferenceError {
    #[error(
        "{source_name} holds longitudes and latitudes, and the city's coordinate system is not known; give it with --crs EPSG:<code>"
    )]
    CityUnknown { source_name: String },
    #[error(
        "{name} is not among the coordinate systems that are known here; convert the coordinates to those of the city"
    )]
    UnknownSystem { name: String },
    #[error(
        "{place} cannot be taken {way} ({reason}); check the coordinate systems and the order of the axes: {source_name}"
    )]
    Projection { place: String, way: String, reason: String, source_name: String },
    #[error("{given} may be {first} or {second}; write its folder before the name: {source_name}")]
    TwoPhotographs { given: String, first: String, second: String, source_name: String },
    #[error(
        "{matched} of {given} names in it are those of photographs of the reconstruction (in the file: {example}; in the reconstruction: \
         {other}); {needed} at least are needed: {source_name}"
    )]
    TooFewMatches { matched: usize, given: usize, needed: usize, example: String, other: String, source_name: String },
    #[error(
        "the reconstruction has no cameras, so positions of photographs do not place it; give --points or --start: {source_name}"
    )]
    NoCameras { source_name: String },
    #[error(
        "the positions lie within {spread_m:.1} m of their middle and are uncertain by {noise_m:.1} m each, so they tell neither heading \
         nor scale; give --points or --start: {source_name}"
    )]
    TooNear { spread_m: f64, noise_m: f64, source_name: String },
    #[error(
        "no more than {believed} of {all} positions fit the cameras of the reconstruction together; check that the names are those of the same \
         photographs, and that the coordinates are metres or degrees: {source_name}"
    )]
    Scattered { believed: usize, all: usize, source_name: String },
    #[error(
        "the positions are the mirror image of the cameras, so east and north are exchanged; write east (X, or the longitude) before north, or \
         name the columns in a header: {source_name}"
    )]
    Mirrored { source_name: String },
    #[error("none of the positions has a height; add them, or give --start: {source_name}")]
    NoHeights { source_name: String },
    #[error(
        "{found} control points are usable ({left_out}), expected three or more that are not on a line: {source_name}"
    )]
    TooFewPoints { found: usize, left_out: String, source_name: String },
    #[error("{source_name}: {error}")]
    Start { source_name: String, error: StartError },
    #[error(
        "the start is {} from the city's nearest facet (its place: {}; the city: {} to {}), and its sigmas reach {}; check that the coordinates \
         are of the city's system (--crs), in metres, and east before north: {source_name}",
        length(*distance_m), place_of(place), place_of(low), place_of(high), length(*reach_m)
    )]
    FarFromTheCity {
        distance_m: f64,
        reach_m: f64,
        place: Point3<f64>,
        low: Point3<f64>,
        high: Point3<f64>,
        source_name: String,
    },
    /// Two sources that cannot both be right.
    #[error("{first} and {second} do not agree: {differs}; leave out the one that is wrong")]
    Disagreement { first: String, second: String, differs: String },
}

/// Metres, and kilometres from one on.
fn length(metres: f64) -> String {
    if metres < 1000.0 { format!("{metres:.0} m") } else { format!("{:.1} km", metres / 1000.0) }
}

fn place_of(p: &Point3<f64>) -> String {
    format!("{:.0}, {:.0}, {:.0}", p.x, p.y, p.z)
}
