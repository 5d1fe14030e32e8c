//! Where the reconstruction stands, from whatever was given: read before any long work, estimated once city and reconstruction are there.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::args::{AlignArgs, Near};
use super::plan::file_name;
use crate::city::{CityModel, PlanBox};
use crate::format::control::{ControlFile, read_control_points};
use crate::format::positions::{Frame, PositionsFile, read_positions};
use crate::format::read_start;
use crate::geometry::Start;
use crate::georeference::{Estimate, agreed, from_control_points, from_positions};
use crate::limits::Limits;
use crate::place_search::{Disc, PlacePrior};
use crate::reconstruction::Reconstruction;

/// What was given to say it, read.
pub struct PlaceSources {
    start: Option<Named<Start>>,
    positions: Option<Named<PositionsFile>>,
    points: Option<Named<ControlFile>>,
    near: Option<Disc>,
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
        let near = args.near.map(|Near { center, radius_m }| Disc { center, radius_m });
        if start.is_none() && positions.is_none() && points.is_none() && near.is_none() {
            // Photographs without GPS say nothing, and are no error.
            positions = args.photos.as_ref().and_then(|photos| named_positions(photos).ok());
        }
        Ok(PlaceSources { start, positions, points, near })
    }

    /// What is known of the place where there is no start: the middle lies there, or anywhere in the city.
    pub fn prior(&self) -> PlacePrior {
        PlacePrior { near: self.near, ..PlacePrior::default() }
    }

    /// What of the city matters, where that is known before it is read; all of it where positions or control points must be set into it first.
    pub fn surroundings(&self, sfm: &Reconstruction, fixed_scale: Option<f64>) -> Option<PlanBox> {
        if let Some(near) = self.near {
            let limits = Limits::default();
            let beyond_m = limits.place_search.most_radius_m + limits.null_poses.least_reach_m;
            return Some(PlanBox::about(near.center, near.radius_m + beyond_m));
        }
        let start = self.start.as_ref().filter(|_| self.positions.is_none() && self.points.is_none())?;
        let estimate = Estimate::given(start.read, &sfm.points, String::new());
        Some(estimate.surroundings(&sfm.points, fixed_scale))
    }

    /// The start that all sources together give; none where there is no source.
    pub fn estimate(&self, sfm: &Reconstruction, city: &CityModel) -> Result<Option<Estimate>> {
        let frame = city.crs.as_ref().and_then(|crs| crs.epsg).map(Frame::Epsg);
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
