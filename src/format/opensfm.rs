//! Reconstructions of OpenSfM, and so of ODM: `reconstruction.json`, with `tracks.csv` beside it
//! (<https://opensfm.org/docs/dataset.html>), as they stand.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::sfm_file::{Fault, SfmFileError, bytes_of, json_of};

/// One of the pieces of a file, which are not connected with each other.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct OpenSfmPiece {
    pub cameras: BTreeMap<String, OpenSfmCamera>,
    pub shots: BTreeMap<String, OpenSfmShot>,
    #[serde(default)]
    pub points: BTreeMap<String, OpenSfmPoint>,
    pub reference_lla: Option<OpenSfmReference>,
}

/// The numbers of a camera, whatever its projection.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct OpenSfmCamera {
    pub projection_type: String,
    #[serde(default)]
    pub width: u64,
    #[serde(default)]
    pub height: u64,
    /// As shares of the longer side, like `c_x` and `c_y`, which count from the middle.
    pub focal: Option<f64>,
    pub focal_x: Option<f64>,
    pub focal_y: Option<f64>,
    #[serde(default)]
    pub c_x: f64,
    #[serde(default)]
    pub c_y: f64,
    #[serde(default)]
    pub k1: f64,
    #[serde(default)]
    pub k2: f64,
    #[serde(default)]
    pub k3: f64,
    #[serde(default)]
    pub k4: f64,
    #[serde(default)]
    pub p1: f64,
    #[serde(default)]
    pub p2: f64,
}

#[derive(Clone, Debug, Deserialize)]
pub struct OpenSfmShot {
    /// Rotation vector, world to camera.
    pub rotation: [f64; 3],
    pub translation: [f64; 3],
    pub camera: String,
    /// East, north, up of the reference, metres.
    pub gps_position: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub struct OpenSfmPoint {
    pub coordinates: [f64; 3],
    #[serde(default)]
    pub color: [f64; 3],
}

/// Degrees, and metres above the ellipsoid.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub struct OpenSfmReference {
    pub latitude: f64,
    pub longitude: f64,
    #[serde(default)]
    pub altitude: f64,
}

/// A point as a photograph shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenSfmObservation {
    pub shot: String,
    pub track: String,
    /// Shares of the longer side, right and down from the middle.
    pub place: [f64; 2],
}

pub fn is_opensfm(start: &[u8]) -> bool {
    let has = |key: &[u8]| memchr::memmem::find(start, key).is_some();
    start.trim_ascii_start().starts_with(b"[") && (has(b"\"projection_type\"") || has(b"\"shots\""))
}

pub fn read_opensfm(path: &Path) -> Result<Vec<OpenSfmPiece>, SfmFileError> {
    json_of(path, "OpenSfM's reconstruction.json")
}

/// The observations in `tracks.csv` that `wanted` says of a shot and a track.
pub fn read_opensfm_tracks(
    path: &Path,
    wanted: impl Fn(&str, &str) -> bool,
) -> Result<Vec<OpenSfmObservation>, SfmFileError> {
    tracks(&bytes_of(path)?, wanted).map_err(|fault| fault.in_file(path, "OpenSfM's tracks.csv"))
}

fn tracks(bytes: &[u8], wanted: impl Fn(&str, &str) -> bool) -> Result<Vec<OpenSfmObservation>, Fault> {
    let mut observations = Vec::new();
    for (line, raw) in (1..).zip(bytes.split(|b| *b == b'\n')) {
        let text = String::from_utf8_lossy(raw);
        let text = text.trim_end();
        if text.is_empty() || (line == 1 && text.starts_with("OPENSFM_TRACKS_VERSION")) {
            continue;
        }
        let fields: Vec<&str> = text.split('\t').collect();
        let observation = match fields.as_slice() {
            [shot, track, _feature, x, y, ..] => {
                x.parse().ok().zip(y.parse().ok()).map(|(x, y)| (*shot, *track, [x, y]))
            }
            _ => None,
        };
        let Some((shot, track, place)) = observation else {
            let got = format!("`{}`", text.chars().take(60).collect::<String>().escape_debug());
            return Err(Fault::new(format!("line {line}"), "a shot, a track, a feature, X and Y, apart by tabs", got));
        };
        if wanted(shot, track) {
            observations.push(OpenSfmObservation { shot: shot.into(), track: track.into(), place });
        }
    }
    Ok(observations)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::sfm_file::json;

    const FILE: &str = r#"[{"cameras": {"c": {"projection_type": "brown", "width": 40, "height": 30, "focal_x": 0.9, "focal_y": 0.9,
        "c_x": 0.01, "c_y": 0, "k1": 0.1, "k2": 0, "p1": 0, "p2": 0, "k3": 0}}, "shots": {"a.jpg": {"rotation": [0.1, 0, 0],
        "translation": [1, 2, 3], "camera": "c", "gps_position": [4, 5, 6]}}, "points": {"7": {"color": [1, 2, 3],
        "coordinates": [0, 0, 9]}}, "reference_lla": {"latitude": 52.5, "longitude": 13.4, "altitude": 0.0}}]"#;

    #[test]
    fn pieces_are_read_with_what_positions_they_have() {
        let pieces: Vec<OpenSfmPiece> = json(FILE.as_bytes()).unwrap();
        let shot = &pieces[0].shots["a.jpg"];
        assert_eq!((shot.translation, shot.gps_position), ([1.0, 2.0, 3.0], Some([4.0, 5.0, 6.0])));
        assert_eq!(pieces[0].cameras["c"].focal_x, Some(0.9));
        assert_eq!(pieces[0].reference_lla.unwrap().latitude, 52.5);
        assert!(is_opensfm(FILE.as_bytes()));
    }

    #[test]
    fn tracks_are_read_with_and_without_their_version() {
        let rows = "a.jpg\t7\t0\t-0.25\t0.125\t0.001\t1\t2\t3\nb.jpg\t7\t1\t0\t0\t0.001\t1\t2\t3\n";
        for file in [rows.to_string(), format!("OPENSFM_TRACKS_VERSION_v1\n{rows}")] {
            let found = tracks(file.as_bytes(), |shot, track| shot == "a.jpg" && track == "7").unwrap();
            assert_eq!(found, [OpenSfmObservation { shot: "a.jpg".into(), track: "7".into(), place: [-0.25, 0.125] }]);
        }
        let fault = tracks(b"a.jpg\t7\t0\t1\t2\nb.jpg\t7\n", |_, _| true).unwrap_err();
        assert_eq!((fault.place.as_str(), fault.got.as_str()), ("line 2", "`b.jpg\\t7`"));
    }

    #[test]
    fn cut_and_changed_files_never_panic() {
        for cut in 0..FILE.len() {
            assert!(json::<Vec<OpenSfmPiece>>(&FILE.as_bytes()[..cut]).is_err());
            for value in *b"\0-9]}\"x" {
                let mut changed = FILE.as_bytes().to_vec();
                changed[cut] = value;
                let _ = json::<Vec<OpenSfmPiece>>(&changed);
                let _ = tracks(&changed, |_, _| true);
            }
        }
    }
}
