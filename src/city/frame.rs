//! From the coordinates of city files to metres, x east, y north, z up: one decision for all files of a city.

use super::axes::{AxisOrder, AxisVotes, ShellSigns, vote};
use super::degrees::LocalProjection;
use super::warning::CityDefect;
use super::{CityOptions, Crs};
use crate::format::surfaces::SurfaceFile;
use crate::geometry::Point3;

/// Degrees are a hundred-thousandth of the metres that they mean: a city is thousands of times higher than wide.
const HEIGHT_TO_WIDTH: f64 = 100.0;

/// What is done to all coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Frame {
    pub crs: Option<Crs>,
    is_north_first: bool,
    pub projection: Option<LocalProjection>,
    /// What was decided, without a place.
    pub defects: Vec<CityDefect>,
}

impl Frame {
    /// Decides for all files whose formats have a reference system.
    pub fn of(files: &[&SurfaceFile], options: &CityOptions) -> Frame {
        let said = files.iter().find_map(|file| file.crs.as_deref());
        let crs = said.or(options.crs.as_deref()).map(Crs::understood);
        let mut frame = Frame { crs, ..Frame::default() };
        frame.compare_systems(files, options);
        frame.decided(&FrameEvidence::of(files))
    }

    /// Decides for one file of which `beginning` says the system, by what was seen of all of it.
    pub fn of_evidence(beginning: &SurfaceFile, evidence: &FrameEvidence, options: &CityOptions) -> Frame {
        let frame = Frame::of(&[&SurfaceFile { crs: beginning.crs.clone(), ..SurfaceFile::default() }], options);
        frame.decided(evidence)
    }

    fn decided(self, evidence: &FrameEvidence) -> Frame {
        let mut frame = self;
        let Some(extent) = &evidence.extent else { return frame };
        let votes = vote(&evidence.shells, frame.crs.as_ref(), extent.middle());
        if extent.is_degrees(frame.crs.as_ref()) {
            frame.project(extent, &votes);
        } else if votes.order() == Some(AxisOrder::NorthFirst) {
            frame.is_north_first = true;
            let (negative, of) = (votes.negative as u64, votes.shells as u64);
            frame.defects.push(CityDefect::NorthFirst { negative, of });
        }
        frame
    }

    /// Files of one city are in one system.
    fn compare_systems(&mut self, files: &[&SurfaceFile], options: &CityOptions) {
        let Some(first) = &self.crs else { return };
        let others = files.iter().filter_map(|file| file.crs.as_deref()).chain(options.crs.as_deref());
        let other = others.map(Crs::understood).find(|other| !is_same(first, other));
        self.defects.extend(other.map(|other| CityDefect::OtherCrs { first: first.text.clone(), other: other.text }));
    }

    fn project(&mut self, extent: &Extent, votes: &AxisVotes) {
        let crs = self.crs.as_ref();
        let [first, second] = extent.middle();
        self.is_north_first = match votes.order() {
            // Nothing else has more than 90 degrees than the longitude.
            _ if first.abs() > 90.0 => false,
            _ if second.abs() > 90.0 => true,
            Some(order) => order == AxisOrder::NorthFirst,
            None => crs.is_some_and(|crs| crs.is_geographic() && !crs.is_longitude_first()),
        };
        let (longitude, latitude) = if self.is_north_first { (second, first) } else { (first, second) };
        let projection = LocalProjection::about(latitude, longitude);
        self.defects.push(CityDefect::Degrees { latitude, longitude, is_latitude_first: self.is_north_first });
        let vertical = crs.and_then(|crs| crs.vertical.clone());
        // The text is what coordinates are in from here on; the code says what they were.
        let epsg = crs.and_then(|crs| crs.epsg);
        self.crs = Some(Crs { text: projection.text(), epsg, vertical });
        self.projection = Some(projection);
    }

    /// Coordinates of a file in the city's frame.
    pub fn placed(&self, [x, y, z]: [f64; 3]) -> Point3<f64> {
        let place = if self.is_north_first { Point3::new(y, x, z) } else { Point3::new(x, y, z) };
        self.projection.map_or(place, |projection| projection.project(place))
    }
}

fn is_same(one: &Crs, other: &Crs) -> bool {
    if one.epsg.is_some() { one.epsg == other.epsg } else { other.epsg.is_none() && one.text == other.text }
}

/// What coordinates tell of their frame.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameEvidence {
    extent: Option<Extent>,
    shells: ShellSigns,
}

impl FrameEvidence {
    pub fn of(files: &[&SurfaceFile]) -> FrameEvidence {
        FrameEvidence { extent: Extent::of(files), shells: ShellSigns::of(files) }
    }

    /// Takes in what another part of the same files tells.
    pub fn add(&mut self, other: &FrameEvidence) {
        self.extent = match (self.extent.take(), &other.extent) {
            (Some(own), Some(other)) => Some(own.with(other)),
            (own, other) => own.or_else(|| other.clone()),
        };
        self.shells.add(&other.shells);
    }
}

/// Lowest and highest coordinates that polygons use.
#[derive(Clone, Debug)]
struct Extent {
    low: [f64; 3],
    high: [f64; 3],
}

impl Extent {
    fn of(files: &[&SurfaceFile]) -> Option<Extent> {
        let mut extent = Extent { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        for file in files {
            for position in file.corners.iter().map(|&at| file.positions[at as usize]) {
                for (axis, value) in position.into_iter().enumerate() {
                    extent.low[axis] = extent.low[axis].min(value);
                    extent.high[axis] = extent.high[axis].max(value);
                }
            }
        }
        Some(extent).filter(|extent| extent.low[0].is_finite())
    }

    fn with(&self, other: &Extent) -> Extent {
        Extent {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis])),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|axis| (self.low[axis] + self.high[axis]) / 2.0)
    }

    /// Whether these are degrees: within the world, and by the name of the system, or by being far higher than wide.
    fn is_degrees(&self, crs: Option<&Crs>) -> bool {
        let reach = |axis: usize| self.low[axis].abs().max(self.high[axis].abs());
        let (least, most) = (reach(0).min(reach(1)), reach(0).max(reach(1)));
        if least > 90.0 || most > 180.0 {
            return false;
        }
        let across = |axis: usize| self.high[axis] - self.low[axis];
        let is_needle = across(0).max(across(1)) * HEIGHT_TO_WIDTH < across(2);
        // A small model about its own zero may stand beside the name of any system.
        let is_away = most > across(0).max(across(1));
        (crs.is_some_and(Crs::is_geographic) && is_away) || is_needle
    }
}
