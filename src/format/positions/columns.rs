//! Which column of a table holds what, by the names that programs give them.

/// What a table has, by the index of its column.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Columns {
    pub name: usize,
    pub east: usize,
    pub north: usize,
    pub height: Option<usize>,
    pub sigma: Option<usize>,
    pub height_sigma: Option<usize>,
    pub enabled: Option<usize>,
    /// The header itself says that east and north are longitude and latitude.
    pub are_degrees: bool,
}

const NAMES: &[&str] =
    &["label", "name", "image", "imagename", "filename", "file", "photo", "photoname", "cameralabel", "camera"];
const LONGITUDES: &[&str] = &["longitude", "lon", "lng", "long"];
const LATITUDES: &[&str] = &["latitude", "lat"];
const EASTS: &[&str] = &["x", "easting", "east", "xlongitude", "xeasting", "xeast", "geox"];
const NORTHS: &[&str] = &["y", "northing", "north", "ylatitude", "ynorthing", "ynorth", "geoy"];
const HEIGHTS: &[&str] = &["z", "altitude", "alt", "height", "elevation", "zaltitude", "zheight", "geoz"];
const SIGMAS: &[&str] = &[
    "accuracyx",
    "xaccuracy",
    "accuracyxy",
    "accuracy",
    "accuracym",
    "accuracyxm",
    "accuracyxym",
    "sigmax",
    "horizontalaccuracy",
];
const HEIGHT_SIGMAS: &[&str] = &["accuracyz", "zaccuracy", "accuracyzm", "sigmaz", "verticalaccuracy", "altaccuracy"];

impl Columns {
    /// `None` where the words are no header of a table of positions.
    pub fn of(header: &[String]) -> Option<Columns> {
        let plain: Vec<String> = header.iter().map(|word| letters(word)).collect();
        let find = |names: &[&str]| plain.iter().position(|word| names.contains(&word.as_str()));
        let degrees = find(LONGITUDES).zip(find(LATITUDES));
        let (east, north) = degrees.or_else(|| find(EASTS).zip(find(NORTHS)))?;
        Some(Columns {
            name: find(NAMES)?,
            east,
            north,
            height: find(HEIGHTS),
            sigma: find(SIGMAS),
            height_sigma: find(HEIGHT_SIGMAS),
            enabled: find(&["enabled", "enable"]),
            are_degrees: degrees.is_some(),
        })
    }
}

/// Letters alone, small: "#X/Longitude" and "Accuracy_X (m)" are written in many ways.
fn letters(word: &str) -> String {
    word.chars().filter(|c| c.is_alphabetic()).flat_map(char::to_lowercase).collect()
}
