//! The start: a coarse similarity in JSON, and how far it may be off. The report of an earlier alignment is one, too, and so is a matrix
//! of 4 x 4 as text.

use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::alignment::{Spread, StoredAlignment, parse_alignment};
use super::json_kind::JsonKind;
use super::matrix::{looks_like_matrix, parse_matrix};
use super::placement::{PlacementError, SimilarityRecord, parse_json, read_named};
use crate::geometry::{LEAST_SPREAD_M, Start, StartError, StartSigmas};

const EXPECTED: &str = "{\"scale\": s, \"rotation\": [[..],[..],[..]], \"translation\": [x, y, z]} and, where wanted, \
                        position_sigma, height_sigma, rotation_sigma_deg, tilt_sigma_deg, scale_sigma";

/// The file's own keys. Unknown ones are refused: a misspelt sigma that is silently left out would move the search.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct StartRecord {
    scale: f64,
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    position_sigma: Option<f64>,
    height_sigma: Option<f64>,
    rotation_sigma_deg: Option<f64>,
    tilt_sigma_deg: Option<f64>,
    scale_sigma: Option<f64>,
    // What `align` tells of a start besides: under `prior`, and with --dry-run.
    #[serde(rename = "source")]
    _source: Option<IgnoredAny>,
    #[serde(rename = "middle")]
    _middle: Option<IgnoredAny>,
    #[serde(rename = "distance")]
    _distance: Option<IgnoredAny>,
    #[serde(rename = "warnings")]
    _warnings: Option<IgnoredAny>,
}

/// Reads a start, or takes an alignment's transform (or best candidate) for one; sigmas that the file does not name have
/// their defaults.
pub fn read_start(path: &Path) -> Result<Start, PlacementError> {
    let text = read_named(path, "start")?;
    if looks_like_matrix(&text) {
        return Ok(Start::with_default_sigmas(parse_matrix(&text, path)?));
    }
    match JsonKind::of(&text) {
        None | Some(JsonKind::Start) => parse_start(&text, path),
        Some(JsonKind::Alignment) => start_from(&parse_alignment(&text, path)?).map_err(at(path)),
        Some(kind) => {
            let remedy = match kind {
                JsonKind::Merge => "write the transform of one part into a start",
                _ => "`cityweld align --help` shows a start",
            };
            Err(PlacementError::OtherKind { path: path.into(), kind, expected: EXPECTED, remedy })
        }
    }
}

fn parse_start(text: &str, path: &Path) -> Result<Start, PlacementError> {
    let record: StartRecord = parse_json(text, path, "start", EXPECTED)?;
    let similarity =
        SimilarityRecord { scale: record.scale, rotation: record.rotation, translation: record.translation };
    let default = StartSigmas::default();
    let degree = 1f64.to_radians();
    let sigmas = StartSigmas {
        position_m: record.position_sigma.unwrap_or(default.position_m),
        height_m: record.height_sigma.unwrap_or(default.height_m),
        heading_rad: record.rotation_sigma_deg.map_or(default.heading_rad, |v| v * degree),
        tilt_rad: record.tilt_sigma_deg.map_or(default.tilt_rad, |v| v * degree),
        log_scale: record.scale_sigma.unwrap_or(default.log_scale),
    };
    Start::new(similarity.check("start", path)?, sigmas).map_err(at(path))
}

/// With the sigmas of the alignment, which are about the scene's centre and so nearly about the reconstruction's. Those of
/// an ambiguous one say nothing of the other poses.
fn start_from(stored: &StoredAlignment) -> Result<Start, StartError> {
    let Some(Spread { radius_m, sigmas }) = stored.spread.filter(|_| stored.verdict != "ambiguous") else {
        return Ok(Start::with_default_sigmas(stored.city_from_sfm));
    };
    Start::new(stored.city_from_sfm, sigmas.at_least(LEAST_SPREAD_M, radius_m))
}

fn at(path: &Path) -> impl Fn(StartError) -> PlacementError {
    |source| PlacementError::Start { path: path.into(), source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Vector3};

    fn read(text: &str) -> Result<Start, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_start(file.path()).map_err(|e| {
            let message = e.to_string();
            assert!(message.contains(file.path().to_str().unwrap()), "{message} does not name the file");
            message
        })
    }

    const TURN: &str = r#""rotation": [[0,-1,0],[1,0,0],[0,0,1]], "translation": [1, 2, 3]"#;

    #[test]
    fn reads_a_start_row_by_row_with_default_sigmas() {
        let start = read(&format!(r#"{{"scale": 2, {TURN}}}"#)).unwrap();
        let p = start.city_from_sfm().apply(&Point3::new(1.0, 0.0, 0.0));
        assert!((p.coords - Vector3::new(1.0, 4.0, 3.0)).norm() < 1e-12);
        assert_eq!(start, Start::with_default_sigmas(*start.city_from_sfm()));
    }

    #[test]
    fn turns_degrees_of_the_file_into_radians() {
        let start = read(&format!(
            r#"{{"scale": 2, {TURN}, "position_sigma": 4.5, "rotation_sigma_deg": 180, "tilt_sigma_deg": 90, "scale_sigma": 0}}"#
        ))
        .unwrap();
        assert_eq!(start.sigmas().position_m, 4.5);
        assert_eq!(start.sigmas().heading_rad, std::f64::consts::PI);
        assert!((start.sigmas().tilt_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(start.sigmas().log_scale, 1e-4);
    }

    const MOVED: &str = r#"{"scale": 2, "rotation": [[0,-1,0],[1,0,0],[0,0,1]], "translation": [1, 2, 3]}"#;

    #[test]
    fn takes_an_alignment_for_a_start_whatever_its_verdict() {
        for (verdict, key) in [("aligned", "transform"), ("undetermined", "best_candidate")] {
            let text = format!(
                r#"{{"schema": "cityweld.alignment/1", "verdict": "{verdict}", "{key}": {MOVED}, "warnings": []}}"#
            );
            assert_eq!(read(&text), read(MOVED), "{verdict}");
        }
        let failed =
            r#"{"schema": "cityweld.alignment/1", "verdict": "failed", "transform": null, "best_candidate": null}"#;
        assert!(read(failed).unwrap_err().contains("the alignment (failed) has neither"));
    }

    #[test]
    fn takes_the_sigmas_of_an_alignment_and_believes_none_to_the_last_millimetre() {
        let alignment = |verdict: &str| {
            // 4 m along x, everything else to a millimetre or a thousandth.
            let row = |i: usize| {
                let sigma_sq = if i == 3 { 16.0 } else { 1e-6 };
                let cells: Vec<_> = (0..7).map(|j| if i == j { sigma_sq } else { 0.0 }.to_string()).collect();
                format!("[{}]", cells.join(","))
            };
            let covariance = (0..7).map(row).collect::<Vec<_>>().join(",");
            read(&format!(
                r#"{{"schema": "cityweld.alignment/1", "verdict": "{verdict}", "best_candidate": {MOVED}, "center": [0,0,0],
                     "radius": 70, "covariance": [{covariance}]}}"#
            ))
            .unwrap()
        };
        let start = alignment("undetermined");
        let sigmas = start.sigmas();
        assert!((sigmas.position_m - 4.0).abs() < 1e-12, "{sigmas:?}");
        assert_eq!((sigmas.height_m, sigmas.heading_rad), (0.35, 0.35 / 70.0));
        assert_eq!((sigmas.tilt_rad, sigmas.log_scale), (0.35 / 70.0, 0.35 / 70.0));
        assert_eq!(alignment("ambiguous"), Start::with_default_sigmas(*start.city_from_sfm()));
    }

    #[test]
    fn names_other_json_files_of_the_project_for_what_they_are() {
        for (text, says) in [
            (r#"{"schema": "cityweld.merge/1", "parts": []}"#, "the report of a merge"),
            (r#"{"schema": "cityweld.planes/1", "planes": []}"#, "the planes of a city"),
            (r#"{"kind": "rigid", "points": [], "planes": [], "pairs": []}"#, "a problem of"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(says) && message.contains("expected {\"scale\": s"), "{message}");
        }
    }

    #[test]
    fn names_a_key_that_it_does_not_know() {
        let message = read(&format!(r#"{{"scale": 2, {TURN}, "sigma": 3}}"#)).unwrap_err();
        assert!(message.contains("unknown field `sigma`") && message.contains("line 1"), "{message}");
    }

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        for text in ["{\"scale\": 2, \"\u{9b}31m\": 3}", "1 0 0 0\n0 1 0 0\n0 0 1 \u{9b}31m\n0 0 0 1\n"] {
            let message = read(text).unwrap_err();
            assert!(message.contains("\\u{9b}31m") && !message.contains('\u{9b}'), "{message}");
        }
    }

    #[test]
    fn names_a_key_that_is_missing() {
        let message = read(r#"{"scale": 2, "translation": [0,0,0]}"#).unwrap_err();
        assert!(message.contains("missing field `rotation`"), "{message}");
    }

    #[test]
    fn refuses_what_is_no_similarity() {
        for (text, says) in [
            (format!(r#"{{"scale": 0, {TURN}}}"#), "scale is 0"),
            (format!(r#"{{"scale": -1, {TURN}}}"#), "scale is -1"),
            (format!(r#"{{"scale": NaN, {TURN}}}"#), "line 1 column"),
            (format!(r#"{{"scale": 1e999, {TURN}}}"#), "out of range"),
            (r#"{"scale": 1, "rotation": [[1,0,0],[0,1,0],[0,0,-1]], "translation": [0,0,0]}"#.into(), "reflection"),
            (r#"{"scale": 1, "rotation": [[1,0,0],[0,1,0],[0,0,2]], "translation": [0,0,0]}"#.into(), "orthonormal"),
            (r#"{"scale": 1, "rotation": [[1,0,0],[0,1,0]], "translation": [0,0,0]}"#.into(), "invalid length 2"),
            (format!(r#"{{"scale": 1, {TURN}, "height_sigma": -2}}"#), "height_sigma is -2"),
            ("[]".into(), "not a valid start"),
            ("5".into(), "expected an object"),
            (String::new(), "EOF"),
        ] {
            let message = read(&text).unwrap_err();
            assert!(message.contains(says), "{text}: {message}");
        }
    }
}
