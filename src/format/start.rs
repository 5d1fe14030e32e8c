//! The start file: a coarse similarity in JSON, and how far it may be off.

use std::path::Path;

use serde::Deserialize;

use super::placement::{PlacementError, SimilarityRecord, read_json};
use crate::geometry::Start;

/// A sigma of zero says "exactly known". A search divides by it, so it is taken as this instead: far below what any
/// reconstruction resolves. Metres, radians and log scale alike.
const SMALLEST_SIGMA: f64 = 1e-4;

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
    let default = Start::with_default_sigmas(similarity.check("start", path)?);
    let sigma = |key: &'static str, given: Option<f64>, unit: f64, default: f64| match given {
        None => Ok(default),
        Some(value) if value >= 0.0 => Ok((value * unit).max(SMALLEST_SIGMA)),
        Some(value) => Err(PlacementError::Sigma { path: path.into(), key, value }),
    };
    let degree = 1f64.to_radians();
    Ok(Start {
        position_sigma_m: sigma("position_sigma", record.position_sigma, 1.0, default.position_sigma_m)?,
        height_sigma_m: sigma("height_sigma", record.height_sigma, 1.0, default.height_sigma_m)?,
        heading_sigma_rad: sigma("rotation_sigma_deg", record.rotation_sigma_deg, degree, default.heading_sigma_rad)?,
        tilt_sigma_rad: sigma("tilt_sigma_deg", record.tilt_sigma_deg, degree, default.tilt_sigma_rad)?,
        log_scale_sigma: sigma("scale_sigma", record.scale_sigma, 1.0, default.log_scale_sigma)?,
        ..default
    })
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
        let p = start.city_from_sfm.apply(&Point3::new(1.0, 0.0, 0.0));
        assert!((p.coords - Vector3::new(1.0, 4.0, 3.0)).norm() < 1e-12);
        assert_eq!(start, Start::with_default_sigmas(start.city_from_sfm));
    }

    #[test]
    fn turns_degrees_of_the_file_into_radians() {
        let start = read(&format!(
            r#"{{"scale": 2, {TURN}, "position_sigma": 4.5, "rotation_sigma_deg": 180, "tilt_sigma_deg": 90, "scale_sigma": 0}}"#
        ))
        .unwrap();
        assert_eq!(start.position_sigma_m, 4.5);
        assert!(start.heading_is_unknown());
        assert!((start.tilt_sigma_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(start.log_scale_sigma, SMALLEST_SIGMA);
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
            (format!(r#"{{"scale": 1, {TURN}, "height_sigma": -2}}"#), "height_sigma of the start is -2"),
            ("[]".into(), "not a valid start"),
            (String::new(), "EOF"),
        ] {
            let message = read(&text).unwrap_err();
            assert!(message.contains(says), "{text}: {message}");
        }
    }
}
