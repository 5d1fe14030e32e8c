//! Positions whose photographs the reconstruction has, in the city's frame.

use super::GeoreferenceError;
use super::names::PhotographNames;
use super::projection::ToCity;
use crate::format::positions::{PositionsFile, StoredPosition};
use crate::reconstruction::{ImageIndex, Reconstruction};

/// A position whose photograph is known, in the city's frame.
#[derive(Clone, Debug)]
pub(super) struct Matched {
    pub image: ImageIndex,
    pub name: String,
    pub east_north: Option<[f64; 2]>,
    pub height_m: Option<f64>,
    pub gravity_in_cam: Option<[f64; 3]>,
}

impl Matched {
    /// North before east, as some files have it.
    pub fn with_axes_exchanged(&self) -> Matched {
        Matched { east_north: self.east_north.map(|[east, north]| [north, east]), ..self.clone() }
    }
}

/// One place is none to compare with.
const LEAST_POSITIONS: usize = 2;

/// Matches names and projects places.
pub(super) fn matched(
    file: &PositionsFile,
    source_name: &str,
    sfm: &Reconstruction,
    to_city: &ToCity,
) -> Result<Vec<Matched>, GeoreferenceError> {
    let names = PhotographNames::new(&sfm.images);
    let mut taken = vec![false; sfm.images.len()];
    let mut matched = Vec::new();
    for StoredPosition { name, east_north, height_m, gravity_in_cam, .. } in &file.positions {
        let Some(image) = names.find(name, source_name)? else { continue };
        // Of two positions of one photograph the first counts.
        if std::mem::replace(&mut taken[image.0 as usize], true) {
            continue;
        }
        let place = east_north.map(|place| to_city.place(place, *height_m)).transpose()?;
        let (east_north, height_m) = place.map_or((None, None), |p| (Some(p.east_north), p.height_m));
        matched.push(Matched { image, name: name.clone(), east_north, height_m, gravity_in_cam: *gravity_in_cam });
    }
    let placed = matched.iter().filter(|m| m.east_north.is_some()).count();
    if placed >= LEAST_POSITIONS {
        return Ok(matched);
    }
    Err(GeoreferenceError::TooFewMatches {
        matched: placed,
        given: file.positions.len(),
        needed: LEAST_POSITIONS,
        example: file.positions.first().map_or(String::new(), |p| p.name.clone()),
        other: sfm.images.first().map_or(String::new(), |image| image.name.clone()),
        source_name: source_name.into(),
    })
}
