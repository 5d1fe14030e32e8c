//! The start file: a coarse similarity in JSON, and how far it may be off.

use std::path::Path;

use serde::Deserialize;

use super::placement::{PlacementError, SimilarityRecord, read_json};
use crate::geometry::{Start, StartSigmas};

const EXPECTED: &str = "{\"scale\": s, \"rotation\": [[..],[..],[..]], \"translation\": [x, y, z]} and, where wanted, \
                        position_sigma, height_sigma, rotation_sigma_deg, tilt_sigma_deg, scale_sigma";

/// The file's own keys. Unknown ones are refused: a misspelt sigma that is silently left out would move the search.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StartRecord {
    scale: f64,
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    position_sigma: Option<f64>,
    height_sigma: Option<f64>,
    rotation_sigma_deg: Option<f64>,
    tilt_sigma_deg: Option<f64>,
    scale_sigma: Option<f64>,
}

/// Reads a start; sigmas that it does not name have their defaults.
pub fn read_start(path: &Path) -> Result<Start, PlacementError> {
    let record: StartRecord = read_json(path, "start", EXPECTED)?;
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
    Start::new(similarity.check("start", path)?, sigmas).map_err(|source| PlacementError::Start { path: path.into(), source })
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

    #[test]
    fn names_a_key_that_it_does_not_know() {
        let message = read(&format!(r#"{{"scale": 2, {TURN}, "sigma": 3}}"#)).unwrap_err();
        assert!(message.contains("unknown field `sigma`") && message.contains("line 1"), "{message}");
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
            (String::new(), "EOF"),
        ] {
            let message = read(&text).unwrap_err();
            assert!(message.contains(says), "{text}: {message}");
        }
    }
}
