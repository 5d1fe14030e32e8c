//! Points of LAS files, LAZ and COPC among them (ASPRS LAS 1.4 R15), with the `las` crate, a piece at a time.
//!
//! The crates believe counts and lengths; they are held against the bytes of the file first (`check.rs`, `packed.rs`).

mod check;
mod depth;
mod packed;
mod pieces;

use std::collections::BTreeSet;
use std::io::{BufReader, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use las::crs::GeoTiffData;

use self::check::{Packing, check_count, check_head};
use self::depth::{in_place, on_deep_stack};
use self::packed::check_packed;
use self::pieces::Pieces;
use super::file::open_regular;
use super::ply::{CloudField, FieldKind};
use super::wkt::{WktCrs, WktUnit, wkt_crs};

/// Why a LAS file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LasError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path}, {place}: {problem}; export the points again as LAS or LAZ")]
    Malformed { path: PathBuf, place: String, problem: String },
}

/// What a file says of its points.
#[derive(Clone, Debug, Default)]
pub struct LasCloud {
    pub version: (u8, u8),
    pub is_compressed: bool,
    pub is_copc: bool,
    pub positions: Vec<[f64; 3]>,
    /// One per point, or empty where the file has none.
    pub colors: Vec<[u8; 3]>,
    /// Intensity, class, ..., each with one value per point.
    pub fields: Vec<CloudField>,
    /// Bytes of each point that the specification has no name for, which are not carried.
    pub extra_bytes: usize,
    /// The file has times of its points, which cannot be unpacked safely and are not carried.
    pub times_left_out: bool,
    /// Points of the classes 7 and 18 (noise) where no classes were asked for, and those that are marked as withheld; left out.
    pub noise: usize,
    /// Points of other classes than were asked for, left out; and the classes that there are.
    pub of_other_classes: usize,
    pub classes: BTreeSet<u8>,
    pub crs: Option<LasCrs>,
}

/// The coordinate reference system as the file names it, and what of it could be understood.
#[derive(Clone, Debug, PartialEq)]
pub struct LasCrs {
    pub text: String,
    pub understood: WktCrs,
}

pub fn is_las(start: &[u8]) -> bool {
    start.starts_with(b"LASF")
}

/// Points that are decoded at once, and bytes of them: a format may have 64 KiB for each.
const POINTS_AT_ONCE: u64 = 1 << 16;
const BYTES_AT_ONCE: u64 = 4 << 20;

/// `classes`: those that are kept; where `None`, all but noise.
pub fn read_las(path: &Path, classes: Option<&[u8]>) -> Result<LasCloud, LasError> {
    let unreadable = |source| LasError::Unreadable { path: path.into(), source };
    let fault = |place: &str, problem: String| LasError::Malformed { path: path.into(), place: place.into(), problem };
    let mut file = open_regular(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let packing = check_head(&mut file, length).map_err(|problem| fault("header", problem))?;
    file.seek(SeekFrom::Start(0)).map_err(unreadable)?;
    let decode = || {
        let header = las::Header::new(BufReader::new(&file)).map_err(|error| fault("header", told(&error)))?;
        check_count(&header, length).map_err(|problem| fault("header", problem))?;
        check_packed(&mut BufReader::new(&file), &header, length).map_err(|problem| fault("points", problem))?;
        let pieces = Pieces::of(file, &header).map_err(|error| fault("header", told(&error)))?;
        points(path, pieces, &header, classes)
    };
    // The decoder of LAZ panics on some damaged streams, and on some descriptions of them.
    let decoded = match packing {
        Packing::Plain => in_place(decode),
        Packing::Packed => on_deep_stack(decode),
    };
    decoded.unwrap_or_else(|| Err(fault("points", "the packed points are damaged".into())))
}

fn points(path: &Path, mut pieces: Pieces, header: &las::Header, classes: Option<&[u8]>) -> Result<LasCloud, LasError> {
    let fault = |place: String, problem: String| LasError::Malformed { path: path.into(), place, problem };
    let count = header.number_of_points();
    let mut cloud = Collector::new(header, pieces.have_times(), classes);
    let at_once = (BYTES_AT_ONCE / u64::from(header.point_format().len().max(1))).clamp(1, POINTS_AT_ONCE);
    let mut read = 0;
    while read < count {
        let piece = pieces.next(at_once).map_err(|error| {
            fault(format!("point {read} to {} of {count}", (read + at_once).min(count)), told(&error))
        })?;
        if piece.is_empty() {
            return Err(fault(format!("point {read} of {count}"), "the file ends before".into()));
        }
        read += piece.len() as u64;
        cloud.add(&piece);
    }
    Ok(cloud.finish(header))
}

fn told(error: &las::Error) -> String {
    super::escaped(&error.to_string()).to_string()
}

/// Gathers points, without the noise or those of other classes than are wanted.
struct Collector<'a> {
    cloud: LasCloud,
    wanted: Option<&'a [u8]>,
    /// Whether a point has it, of each class.
    classes: [bool; 256],
    colors: Vec<[u16; 3]>,
    intensity: CloudField,
    class: CloudField,
    returns: [CloudField; 2],
    source: CloudField,
    time: CloudField,
    infrared: CloudField,
}

/// Classes of noise: below, and above.
const NOISE: [u8; 2] = [7, 18];

impl Collector<'_> {
    fn new<'a>(header: &las::Header, have_times: bool, wanted: Option<&'a [u8]>) -> Collector<'a> {
        let version = header.version();
        let cloud = LasCloud {
            version: (version.major, version.minor),
            is_compressed: header.point_format().is_compressed,
            is_copc: header.vlrs().iter().any(|record| record.is_copc_info()),
            extra_bytes: header.point_format().extra_bytes.into(),
            times_left_out: header.point_format().has_gps_time && !have_times,
            crs: crs(header),
            ..LasCloud::default()
        };
        Collector {
            cloud,
            wanted,
            classes: [false; 256],
            colors: Vec::new(),
            intensity: CloudField::new("intensity", FieldKind::U16),
            class: CloudField::new("classification", FieldKind::U8),
            returns: ["return_number", "number_of_returns"].map(|name| CloudField::new(name, FieldKind::U8)),
            source: CloudField::new("point_source_id", FieldKind::U16),
            time: CloudField::new("gps_time", FieldKind::F64),
            infrared: CloudField::new("near_infrared", FieldKind::U16),
        }
    }

    fn add(&mut self, piece: &las::PointData) {
        let is_extended = piece.format().is_extended;
        let records = piece.raw_bytes().chunks_exact(piece.record_len());
        // The flags of withheld points: bit 7 of the class before version 1.4, bit 2 of the flags after.
        let withheld = records.map(|record| if is_extended { record[15] & 4 != 0 } else { record[15] & 0x80 != 0 });
        let wanted = self.wanted;
        let cloud = &mut self.cloud;
        let classes = &mut self.classes;
        let mut keeps = |(class, withheld): (u8, bool)| {
            classes[usize::from(class)] = true;
            let is_wanted = wanted.map_or(!NOISE.contains(&class), |wanted| wanted.contains(&class));
            cloud.noise += usize::from(withheld || (wanted.is_none() && !is_wanted));
            cloud.of_other_classes += usize::from(!withheld && wanted.is_some() && !is_wanted);
            !withheld && is_wanted
        };
        let keep: Vec<bool> = piece.classification().zip(withheld).map(&mut keeps).collect();
        let places = piece.x().zip(piece.y()).zip(piece.z()).map(|((x, y), z)| [x, y, z]);
        self.cloud.positions.extend(kept(places, &keep));
        if let Some(colors) = piece.rgb() {
            self.colors.extend(kept(colors.map(|(r, g, b)| [r, g, b]), &keep));
        }
        fill(&mut self.intensity, piece.intensity().map(u16::to_le_bytes), &keep);
        fill(&mut self.class, piece.classification().map(u8::to_le_bytes), &keep);
        fill(&mut self.returns[0], piece.return_number().map(u8::to_le_bytes), &keep);
        fill(&mut self.returns[1], piece.number_of_returns().map(u8::to_le_bytes), &keep);
        fill(&mut self.source, piece.point_source_id().map(u16::to_le_bytes), &keep);
        if let Some(times) = piece.gps_time().filter(|_| !self.cloud.times_left_out) {
            fill(&mut self.time, times.map(f64::to_le_bytes), &keep);
        }
        if let Some(infrared) = piece.nir() {
            fill(&mut self.infrared, infrared.map(u16::to_le_bytes), &keep);
        }
    }

    fn finish(self, header: &las::Header) -> LasCloud {
        let mut cloud = self.cloud;
        cloud.classes = (0..=u8::MAX).filter(|&class| self.classes[usize::from(class)]).collect();
        // Sixteen bits, says the specification; many programs write eight.
        let shift = if self.colors.iter().flatten().any(|v| *v > 255) { 8 } else { 0 };
        cloud.colors = self.colors.iter().map(|color| color.map(|v| (v >> shift) as u8)).collect();
        if header.point_format().has_color && cloud.colors.iter().all(|color| *color == [0; 3]) {
            cloud.colors.clear();
        }
        let [first, second] = self.returns;
        let fields = [self.intensity, self.class, first, second, self.source, self.time, self.infrared];
        // Columns of zeros say nothing.
        cloud.fields = fields.into_iter().filter(|field| field.bytes.iter().any(|byte| *byte != 0)).collect();
        cloud
    }
}

/// Adds the values of kept points, as the bytes that their field has of each.
fn fill<const N: usize>(field: &mut CloudField, values: impl Iterator<Item = [u8; N]>, keep: &[bool]) {
    field.bytes.reserve(N * keep.len());
    kept(values, keep).for_each(|value| field.bytes.extend_from_slice(&value));
}

fn kept<T>(values: impl Iterator<Item = T>, keep: &[bool]) -> impl Iterator<Item = T> {
    values.zip(keep).filter(|(_, keep)| **keep).map(|(value, _)| value)
}

/// Keys of GeoTIFF (OGC 19-008), and the codes of units that clouds come in.
const GEOGRAPHIC_KEY: u16 = 2048;
const PROJECTED_KEY: u16 = 3072;
const UNIT_KEY: u16 = 3076;
const VERTICAL_UNIT_KEY: u16 = 4099;
const USER_DEFINED: u16 = 32767;
const UNITS: [(u16, &str, f64); 3] =
    [(9001, "metre", 1.0), (9002, "foot", 0.3048), (9003, "US survey foot", 1200.0 / 3937.0)];

fn crs(header: &las::Header) -> Option<LasCrs> {
    let wkt =
        header.get_wkt_crs_bytes().map(|bytes| String::from_utf8_lossy(bytes).trim_matches(['\0', ' ']).to_owned());
    if let Some(text) = wkt.filter(|text| !text.is_empty()) {
        return Some(LasCrs { understood: wkt_crs(&text), text });
    }
    let keys = header.get_geotiff_crs().ok()??.entries;
    let number = |id: u16| {
        keys.iter().find(|key| key.id == id).and_then(|key| match key.data {
            GeoTiffData::U16(value) if value != 0 && value != USER_DEFINED => Some(value),
            _ => None,
        })
    };
    let unit = |id: u16| {
        let (_, name, metres) = *UNITS.iter().find(|(code, _, _)| Some(*code) == number(id))?;
        Some(WktUnit { name: name.into(), metres })
    };
    let (projected, geographic) = (number(PROJECTED_KEY), number(GEOGRAPHIC_KEY));
    let understood = WktCrs {
        epsg: projected.or(geographic).map(u32::from),
        compound_epsg: None,
        vertical_epsg: None,
        is_geographic: projected.is_none() && geographic.is_some() && unit(UNIT_KEY).is_none(),
        horizontal: unit(UNIT_KEY),
        vertical: unit(VERTICAL_UNIT_KEY),
    };
    let text = match understood.epsg {
        Some(code) => format!("EPSG:{code}"),
        None => keys.iter().find_map(|key| match &key.data {
            GeoTiffData::String(text) => Some(text.trim_end_matches(['|', '\0']).to_owned()),
            _ => None,
        })?,
    };
    Some(LasCrs { text, understood })
}

#[cfg(test)]
mod tests;
