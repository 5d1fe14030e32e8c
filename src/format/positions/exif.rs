//! GPS positions in photographs (EXIF 3.0, section 4.6.7: latitude, longitude, altitude and how far they may be off).

use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use exif::{Exif, In, Tag, Value};

use super::error::PositionsError;
use super::frame::GEOGRAPHIC;
use super::record::{PositionsFile, StoredPosition, sigma};
use crate::format::file::open_regular;

const EXPECTED: &str = "photographs with EXIF GPS positions";

/// Folders below the one that is given.
const DEEPEST: usize = 8;
/// What is read of a JPEG, bytes: its EXIF segment is 64 KiB at most and stands among the first (EXIF 3.0, 4.7.1).
const START_OF_JPEG: u64 = 1 << 20;
/// Other files hold it anywhere; a larger one is no photograph.
const LARGEST_BYTES: u64 = 256 << 20;
const ENDINGS: [&str; 8] = ["jpg", "jpeg", "png", "tif", "tiff", "webp", "heic", "heif"];

/// Metres below the reference where `GPSAltitudeRef` is one of these (1: sea level, 3: ellipsoid).
const BELOW: [u32; 2] = [1, 3];

/// Reads what the photographs of a folder, and of those in it, say of their places.
pub(super) fn read(folder: &Path) -> Result<PositionsFile, PositionsError> {
    let photographs = photographs_in(folder).map_err(|source| PositionsError::Io {
        what: "folder of photographs",
        path: folder.into(),
        source,
    })?;
    let mut positions = Vec::new();
    for path in &photographs {
        let name = path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned();
        let exif =
            read_exif(path).map_err(|source| PositionsError::Io { what: "photograph", path: path.clone(), source })?;
        positions.extend(exif.and_then(|exif| position(&exif, &name)));
    }
    if positions.is_empty() {
        let found = format!("none of its {} photographs says where it was taken", photographs.len());
        return Err(PositionsError::Content { path: folder.into(), found, expected: EXPECTED });
    }
    let without = photographs.len() - positions.len();
    let warnings = if without > 0 { vec![format!("{without} photographs without a GPS position")] } else { vec![] };
    Ok(PositionsFile { format: "EXIF GPS", frame: GEOGRAPHIC, positions, warnings })
}

/// The photographs of a folder and of those in it, by their names' endings, in the order of their paths.
pub fn photographs_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut photographs = Vec::new();
    collect(folder, DEEPEST, &mut photographs)?;
    Ok(photographs)
}

fn collect(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut paths = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
    paths.sort();
    for path in paths {
        let has_ending = path.extension().is_some_and(|e| ENDINGS.iter().any(|known| e.eq_ignore_ascii_case(known)));
        if path.is_dir() && depth > 0 {
            collect(&path, depth - 1, found)?;
        } else if path.is_file() && has_ending {
            found.push(path);
        }
    }
    Ok(())
}

/// `None` where the file has no EXIF that can be made out; damaged ones are common, and no reason to stop.
fn read_exif(path: &Path) -> std::io::Result<Option<Exif>> {
    let mut file = open_regular(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(START_OF_JPEG).read_to_end(&mut bytes)?;
    if !bytes.starts_with(&[0xFF, 0xD8]) {
        file.take(LARGEST_BYTES).read_to_end(&mut bytes)?;
    }
    Ok(parse(bytes))
}

/// Entries that cannot be read are left out (files of piexif end with an unexpected directory).
pub(super) fn parse(bytes: Vec<u8>) -> Option<Exif> {
    let mut reader = exif::Reader::new();
    reader.continue_on_error(true);
    let read = reader.read_from_container(&mut Cursor::new(bytes));
    read.or_else(|error| error.distill_partial_result(|_| ())).ok()
}

pub(super) fn position(exif: &Exif, name: &str) -> Option<StoredPosition> {
    let latitude = angle(exif, Tag::GPSLatitude, Tag::GPSLatitudeRef, 'S')?;
    let longitude = angle(exif, Tag::GPSLongitude, Tag::GPSLongitudeRef, 'W')?;
    // Cameras without a fix write zeros.
    if latitude.abs() > 90.0 || longitude.abs() > 180.0 || (latitude == 0.0 && longitude == 0.0) {
        return None;
    }
    let below = exif.get_field(Tag::GPSAltitudeRef, In::PRIMARY).and_then(|f| f.value.get_uint(0));
    let sign = if below.is_some_and(|reference| BELOW.contains(&reference)) { -1.0 } else { 1.0 };
    let height_m = rational(exif, Tag::GPSAltitude, 0).map(|altitude| sign * altitude);
    let start = StoredPosition::at(name, [longitude, latitude], height_m);
    Some(StoredPosition { sigma_m: sigma(rational(exif, Tag::GPSHPositioningError, 0)), ..start })
}

/// Degrees, minutes and seconds.
fn angle(exif: &Exif, tag: Tag, reference: Tag, negative: char) -> Option<f64> {
    let parts = [0, 1, 2].map(|k| rational(exif, tag, k));
    let degrees = parts[0]? + parts[1].unwrap_or(0.0) / 60.0 + parts[2].unwrap_or(0.0) / 3600.0;
    let half = match &exif.get_field(reference, In::PRIMARY)?.value {
        Value::Ascii(texts) => texts.first()?.first()?.to_ascii_uppercase(),
        _ => return None,
    };
    Some(if char::from(half) == negative { -degrees } else { degrees })
}

fn rational(exif: &Exif, tag: Tag, index: usize) -> Option<f64> {
    let value = match &exif.get_field(tag, In::PRIMARY)?.value {
        Value::Rational(values) => values.get(index)?.to_f64(),
        Value::SRational(values) => values.get(index)?.to_f64(),
        _ => return None,
    };
    Some(value).filter(|v| v.is_finite())
}
