//! Where the reconstruction stands, from whatever was given: read before any long work, estimated once city and reconstruction are there.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::args::{AlignArgs, MergeArgs, Near};
use super::plan::file_name;
use crate::Place;
use crate::city::{CityModel, PlanBox};
use crate::format::control::{ControlFile, read_control_points};
use crate::format::positions::{Frame, PositionsError, PositionsFile, read_positions};
use crate::format::read_start;
use crate::geometry::Start;
use crate::georeference::{Estimate, GeoreferenceError, agreed, from_control_points, from_geographic, from_positions};
use crate::limits::Limits;
use crate::place_search::{Disc, PlacePrior};
use crate::reconstruction::Reconstruction;

/// What was given to say it, read.
pub struct PlaceSources {
    start: Option<Named<Start>>,
    positions: Option<Named<PositionsFile>>,
    points: Option<Named<ControlFile>>,
    near: Option<Near>,
    scale: Option<[f64; 2]>,
}

/// Something read, and the name of its file.
struct Named<T> {
    name: String,
    read: T,
}

impl<T> Named<T> {
    fn new(path: &Path, read: T) -> Named<T> {
        Named { name: file_name(path), read }
    }
}

impl PlaceSources {
    pub fn read(args: &AlignArgs) -> Result<PlaceSources> {
        let start = args.start.as_ref().map(|path| anyhow::Ok(Named::new(path, read_start(path)?))).transpose()?;
        let named_positions = |path: &PathBuf| anyhow::Ok(Named::new(path, read_positions(path)?));
        let mut positions = args.positions.as_ref().map(named_positions).transpose()?;
        let points =
            args.points.as_ref().map(|path| anyhow::Ok(Named::new(path, read_control_points(path)?))).transpose()?;
        let (near, scale) = (args.near, args.scale_range.map(|range| range.0));
        if start.is_none() && positions.is_none() && points.is_none() && near.is_none() {
            positions = of_photographs(args.photos.as_deref())?;
        }
        Ok(PlaceSources { start, positions, points, near, scale })
    }

    /// Whether nothing was given that says where in the city it is.
    pub fn is_anywhere(&self) -> bool {
        self.start.is_none() && self.positions.is_none() && self.points.is_none() && self.near.is_none()
    }

    /// What is known of the place where there is no start: the middle lies there, or anywhere in the city.
    pub fn prior(&self, city: &CityModel) -> Result<PlacePrior> {
        let near = match self.near {
            None => None,
            Some(Near::City(disc)) => Some(disc),
            Some(Near::Geographic { latitude_deg, longitude_deg, radius_m }) => {
                let center = from_geographic([latitude_deg, longitude_deg], "--near", frame_of(city).as_ref())?;
                Some(Disc { center, radius_m })
            }
        };
        Ok(PlacePrior { near, scale: self.scale, ..PlacePrior::default() })
    }

    /// What of the city matters, where that is known before it is read; all of it where positions or control points must be set into it first.
    /// `frame`: the city without anything in it.
    pub fn surroundings(
        &self,
        sfm: &Reconstruction,
        frame: &CityModel,
        fixed_scale: Option<f64>,
    ) -> Result<Option<PlanBox>> {
        if let Some(near) = self.prior(frame)?.near {
            let limits = Limits::default();
            let beyond_m = limits.place_search.most_radius_m + limits.null_poses.least_reach_m;
            return Ok(Some(PlanBox::about(near.center, near.radius_m + beyond_m)));
        }
        let start = self.start.as_ref().filter(|_| self.positions.is_none() && self.points.is_none());
        let estimate = start.map(|start| Estimate::given(start.read, &sfm.points, String::new()));
        Ok(estimate.map(|estimate| estimate.surroundings(&sfm.points, fixed_scale)))
    }

    /// The start that all sources together give; none where there is no source.
    pub fn estimate(&self, sfm: &Reconstruction, city: &CityModel) -> Result<Option<Estimate>> {
        let frame = frame_of(city);
        let frame = frame.as_ref();
        let mut estimates = Vec::new();
        if let Some(Named { name, read }) = &self.start {
            estimates.push(Estimate::given(*read, &sfm.points, format!("start ({name})")));
        }
        if let Some(Named { name, read }) = &self.positions {
            estimates.push(from_positions(read, name, sfm, city, frame)?);
        }
        if let Some(Named { name, read }) = &self.points {
            estimates.push(from_control_points(read, name, sfm, city, frame)?);
        }
        Ok(agreed(estimates)?)
    }
}

/// Where the parts of a merge stand in the city: a start for each, positions of the photographs of all.
pub struct PartPlaces<'a> {
    starts: Vec<Named<Start>>,
    positions: Option<Named<PositionsFile>>,
    city: &'a CityModel,
}

impl PartPlaces<'_> {
    pub fn read<'a>(args: &MergeArgs, city: &'a CityModel) -> Result<PartPlaces<'a>> {
        let starts = args.start.iter().map(|path| anyhow::Ok(Named::new(path, read_start(path)?)));
        let named_positions = |path: &PathBuf| anyhow::Ok(Named::new(path, read_positions(path)?));
        let mut positions = args.positions.as_ref().map(named_positions).transpose()?;
        if args.start.is_empty() && positions.is_none() {
            positions = of_photographs(args.photos.as_deref())?;
        }
        Ok(PartPlaces { starts: starts.collect::<Result<_>>()?, positions, city })
    }

    /// What is known of a part's place, and what is to be said of it. A part of whose photographs no position is known is searched in the whole
    /// city, unless it has a start.
    pub fn of_part(&self, part: usize, sfm: &Reconstruction) -> Result<(Place, Vec<String>)> {
        let frame = frame_of(self.city);
        let (mut estimates, mut told) = (Vec::new(), Vec::new());
        if let Some(Named { name, read }) = self.starts.get(part) {
            estimates.push(Estimate::given(*read, &sfm.points, format!("start ({name})")));
        }
        if let Some(Named { name, read }) = &self.positions {
            match from_positions(read, name, sfm, self.city, frame.as_ref()) {
                Err(none @ (GeoreferenceError::NoCameras { .. } | GeoreferenceError::TooFewMatches { .. })) => {
                    told.push(none.to_string());
                }
                estimate => estimates.push(estimate?),
            }
        }
        let Some(estimate) = agreed(estimates)? else { return Ok((Place::default(), told)) };
        told.extend(estimate.warnings);
        Ok((Place::Start(estimate.start), told))
    }
}

/// Where photographs say that they were taken; those without GPS say nothing, and are no error.
fn of_photographs(photos: Option<&Path>) -> Result<Option<Named<PositionsFile>>> {
    let Some(photos) = photos else { return Ok(None) };
    match read_positions(photos) {
        Ok(read) => Ok(Some(Named::new(photos, read))),
        Err(PositionsError::Content { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// The city's coordinate system, where it is known.
fn frame_of(city: &CityModel) -> Option<Frame> {
    city.crs.as_ref().and_then(|crs| crs.epsg).map(Frame::Epsg)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::crs::Crs;

    fn near(text: &str, city_epsg: Option<u32>) -> Result<Option<Disc>> {
        let sources =
            PlaceSources { start: None, positions: None, points: None, near: Some(text.parse().unwrap()), scale: None };
        let crs = city_epsg.map(|epsg| Crs { epsg: Some(epsg), ..Crs::default() });
        Ok(sources.prior(&CityModel { crs, ..CityModel::default() })?.near)
    }

    #[test]
    fn a_disc_in_degrees_comes_to_the_metres_of_the_city() {
        // The spire of Amersfoort, where the Dutch grid begins: 155000, 463000.
        let disc = near("52.155172,5.387206,250m", Some(28992)).unwrap().unwrap();
        assert!((disc.center[0] - 155_000.0).hypot(disc.center[1] - 463_000.0) < 1.0, "{disc:?}");
        assert_eq!(disc.radius_m, 250.0);
        assert_eq!(near("155000,463000,12,250", None).unwrap().unwrap().center, [155_000.0, 463_000.0]);
    }

    #[test]
    fn a_disc_in_degrees_needs_the_system_of_the_city() {
        let message = near("52.155172,5.387206,250m", None).unwrap_err().to_string();
        assert!(message.starts_with("--near") && message.contains("--crs EPSG:"), "{message}");
    }
}
