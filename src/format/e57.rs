//! Points of E57 files (ASTM E2807), with the `e57` crate: all scans of a file, each at its pose.

use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use e57::{CartesianCoordinate, E57Reader, PointCloud, RecordName};

use super::file::open_regular;
use super::ply::{CloudField, FieldKind};

/// Why an E57 file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum E57Error {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path}, {place}: {problem}; export the scans again as E57")]
    Malformed { path: PathBuf, place: String, problem: String },
    #[error(
        "{path}, {place}: it says {points} points, and of a file of {length} bytes at most one for each byte is read; export the \
         scans again as E57 with coordinates as floating-point numbers, or as LAS"
    )]
    TooDense { path: PathBuf, place: String, points: u64, length: u64 },
}

/// What a file says of its points.
#[derive(Clone, Debug, Default)]
pub struct E57Cloud {
    /// At their scan's pose.
    pub positions: Vec<[f64; 3]>,
    /// One per point, or empty where any scan has none.
    pub colors: Vec<[u8; 3]>,
    /// Intensity from 0 to 1, and the scan's number, where there are any; one value per point.
    pub fields: Vec<CloudField>,
    /// Pulses without an echo, and points marked as invalid; left out.
    pub invalid: usize,
    /// Attributes that are not carried, as the file names them.
    pub not_carried: Vec<String>,
    /// The coordinate reference system, as the file names it.
    pub crs: Option<String>,
}

pub fn is_e57(start: &[u8]) -> bool {
    start.starts_with(b"ASTM-E57")
}

/// An attribute that has one value only takes no bytes, so that a few bytes could claim any number of points. Chosen: a point takes a
/// byte at least; three coordinates to a centimetre within ten metres take four.
const MOST_POINTS_OF_A_BYTE: u64 = 1;

pub fn read_e57(path: &Path) -> Result<E57Cloud, E57Error> {
    let problem = "the file contradicts itself".to_owned();
    let damaged = |_| Err(E57Error::Malformed { path: path.into(), place: "scans".into(), problem });
    // The crate panics on some limits, such as NaN.
    catch_unwind(AssertUnwindSafe(|| scans(path))).unwrap_or_else(damaged)
}

fn scans(path: &Path) -> Result<E57Cloud, E57Error> {
    let unreadable = |source| E57Error::Unreadable { path: path.into(), source };
    let fault = |place: String, problem: String| E57Error::Malformed { path: path.into(), place, problem };
    let told = |error: e57::Error| super::escaped(&error.to_string()).to_string();
    let file = open_regular(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut reader = E57Reader::new(BufReader::new(file)).map_err(|error| fault("header".into(), told(error)))?;
    let scans = reader.pointclouds();
    let mut cloud = Collector::new(&scans, reader.coordinate_metadata());
    for (number, scan) in scans.iter().enumerate() {
        let place = || format!("scan {} of {}", number + 1, scans.len());
        check_count(scan, length).map_err(|points| E57Error::TooDense {
            path: path.into(),
            place: place(),
            points,
            length,
        })?;
        let mut points = reader.pointcloud_simple(scan).map_err(|error| fault(place(), told(error)))?;
        points.apply_pose(true);
        points.intensity_to_color(false);
        for point in points {
            cloud.add(number, point.map_err(|error| fault(place(), told(error)))?);
        }
    }
    Ok(cloud.finish())
}

fn check_count(scan: &PointCloud, length: u64) -> Result<(), u64> {
    if scan.records > length * MOST_POINTS_OF_A_BYTE { Err(scan.records) } else { Ok(()) }
}

/// The name of an attribute that is neither understood nor carried.
fn not_carried(name: &RecordName) -> Option<String> {
    Some(match name {
        RecordName::RowIndex => "rowIndex".into(),
        RecordName::ColumnIndex => "columnIndex".into(),
        RecordName::ReturnCount => "returnCount".into(),
        RecordName::ReturnIndex => "returnIndex".into(),
        RecordName::TimeStamp => "timeStamp".into(),
        RecordName::Unknown { namespace, name } => super::escaped(&format!("{namespace}:{name}")).to_string(),
        _ => return None,
    })
}

struct Collector {
    cloud: E57Cloud,
    has_colors: bool,
    intensity: Option<CloudField>,
    scan: Option<CloudField>,
}

impl Collector {
    fn new(scans: &[PointCloud], crs: Option<&str>) -> Collector {
        let mut not_carried: Vec<String> =
            scans.iter().flat_map(|scan| &scan.prototype).filter_map(|record| not_carried(&record.name)).collect();
        not_carried.sort();
        not_carried.dedup();
        let crs = crs.map(str::trim).filter(|text| !text.is_empty()).map(str::to_owned);
        let has_intensity = scans.iter().any(|scan| scan.has_intensity());
        Collector {
            cloud: E57Cloud { not_carried, crs, ..E57Cloud::default() },
            has_colors: !scans.is_empty() && scans.iter().all(|scan| scan.has_color()),
            intensity: has_intensity.then(|| CloudField::new("intensity", FieldKind::F32)),
            scan: (scans.len() > 1).then(|| CloudField::new("scan", FieldKind::U32)),
        }
    }

    fn add(&mut self, scan: usize, point: e57::Point) {
        let CartesianCoordinate::Valid { x, y, z } = point.cartesian else {
            self.cloud.invalid += 1;
            return;
        };
        if ![x, y, z].iter().all(|v| v.is_finite()) {
            self.cloud.invalid += 1;
            return;
        }
        self.cloud.positions.push([x, y, z]);
        if self.has_colors {
            let byte = |value: f32| (value * 255.0).round() as u8;
            let color = point.color.map_or([0; 3], |c| [c.red, c.green, c.blue].map(byte));
            self.cloud.colors.push(color);
        }
        if let Some(field) = &mut self.intensity {
            field.push(point.intensity.unwrap_or_default().into());
        }
        if let Some(field) = &mut self.scan {
            field.push(scan as f64);
        }
    }

    fn finish(self) -> E57Cloud {
        E57Cloud { fields: self.intensity.into_iter().chain(self.scan).collect(), ..self.cloud }
    }
}

#[cfg(test)]
mod tests;
