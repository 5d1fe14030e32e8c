//! The report of an alignment, read back: where it puts the reconstruction, and whether the program stood behind it.

use std::path::Path;

use serde::Deserialize;

use super::json_kind::JsonKind;
use super::placement::{PlacementError, SimilarityRecord, parse_json, read_named};
use crate::geometry::{Similarity, StartSigmas};

const EXPECTED: &str = "an alignment.json as `cityweld align` writes it, with a transform or a best_candidate";

/// What `alignment.json` says about the place of the reconstruction.
#[derive(Clone, Debug)]
pub struct StoredAlignment {
    /// The report's own word: "aligned", "undetermined", ...; empty where the file has none.
    pub verdict: String,
    /// Absolute city coordinates.
    pub city_from_sfm: Similarity,
    /// True where it stood under `transform`, false where only under `best_candidate`.
    pub is_transform: bool,
    /// How far it may be off, where the report says so.
    pub spread: Option<Spread>,
}

/// How far an alignment may be off about its own centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Of the scene about its centre; an angle of x moves its points by x radii.
    pub radius_m: f64,
    /// Those of position and tilt are along the horizontal axis that is worse.
    pub sigmas: StartSigmas,
}

/// Only what is asked for: the rest of a report may be edited or left out.
#[derive(Deserialize)]
#[serde(expecting = "an object")]
struct AlignmentRecord {
    #[serde(default)]
    verdict: String,
    transform: Option<SimilarityRecord>,
    best_candidate: Option<SimilarityRecord>,
    /// Over (rotation vector, translation, log scale); of any form, since a report without a usable one still places.
    #[serde(default)]
    covariance: serde_json::Value,
    #[serde(default)]
    center: serde_json::Value,
    #[serde(default)]
    radius: serde_json::Value,
}

/// Reads the transform of a report, or its best candidate where it has no transform.
pub fn read_alignment(path: &Path) -> Result<StoredAlignment, PlacementError> {
    let text = read_named(path, "alignment")?;
    let (kind, remedy) = match JsonKind::of(&text) {
        None | Some(JsonKind::Alignment) => return parse_alignment(&text, path),
        Some(JsonKind::Start) => (JsonKind::Start, "write it as {\"transform\": {\"scale\": .., ..}} to place by it"),
        Some(kind) => (kind, "give OUT/alignment.json of `cityweld align`"),
    };
    Err(PlacementError::OtherKind { path: path.into(), kind, expected: EXPECTED, remedy })
}

pub(super) fn parse_alignment(text: &str, path: &Path) -> Result<StoredAlignment, PlacementError> {
    let record: AlignmentRecord = parse_json(text, path, "alignment", EXPECTED)?;
    let Some(similarity) = record.transform.or(record.best_candidate) else {
        return Err(PlacementError::Empty { path: path.into(), verdict: record.verdict });
    };
    Ok(StoredAlignment {
        city_from_sfm: similarity.check("alignment", path)?,
        is_transform: record.transform.is_some(),
        spread: record.spread(),
        verdict: record.verdict,
    })
}

impl AlignmentRecord {
    /// `None` where the file does not say what its covariance is about, or the covariance is none.
    fn spread(&self) -> Option<Spread> {
        let c: [[f64; 7]; 7] = serde_json::from_value(self.covariance.clone()).ok()?;
        let _center: [f64; 3] = serde_json::from_value(self.center.clone()).ok()?;
        let radius_m: f64 = serde_json::from_value(self.radius.clone()).ok()?;
        let sigmas = StartSigmas {
            position_m: larger_sigma(c[3][3], c[4][4], c[3][4]),
            height_m: c[5][5].sqrt(),
            heading_rad: c[2][2].sqrt(),
            tilt_rad: larger_sigma(c[0][0], c[1][1], c[0][1]),
            log_scale: c[6][6].sqrt(),
        };
        let StartSigmas { position_m, height_m, heading_rad, tilt_rad, log_scale } = sigmas;
        let all = [radius_m, position_m, height_m, heading_rad, tilt_rad, log_scale];
        // A matrix of zeros is what stands there where nothing could be said.
        all.iter().all(|value| value.is_finite() && *value > 0.0).then_some(Spread { radius_m, sigmas })
    }
}

/// Root of the larger eigenvalue of the symmetric matrix [[a, c], [c, b]].
fn larger_sigma(a: f64, b: f64, c: f64) -> f64 {
    ((a + b) / 2.0 + ((a - b) / 2.0).hypot(c)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<StoredAlignment, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_alignment(file.path()).map_err(|e| e.to_string())
    }

    const MOVED: &str = r#"{"scale": 2, "rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [1,2,3]}"#;

    #[test]
    fn takes_the_transform_and_else_the_best_candidate() {
        let stored = read(&format!(r#"{{"verdict": "aligned", "transform": {MOVED}, "best_candidate": null}}"#));
        assert!(stored.unwrap().is_transform);
        let stored = read(&format!(r#"{{"verdict": "ambiguous", "transform": null, "best_candidate": {MOVED}}}"#));
        let stored = stored.unwrap();
        assert!(!stored.is_transform);
        assert_eq!((stored.verdict.as_str(), stored.city_from_sfm.scale), ("ambiguous", 2.0));
    }

    #[test]
    fn knows_how_far_it_may_be_off_only_with_what_the_covariance_is_about() {
        let mut c = [[0.0; 7]; 7];
        for (i, sigma) in [0.01f64, 0.02, 0.03, 3.0, 3.0, 0.5, 0.04].into_iter().enumerate() {
            c[i][i] = sigma * sigma;
        }
        // One sigma of 4 m towards the north-east, of sqrt(2) m across.
        (c[3][4], c[4][3]) = (7.0, 7.0);
        let report = |center: &str, covariance: &[[f64; 7]; 7]| {
            let covariance = serde_json::to_string(covariance).unwrap();
            read(&format!(r#"{{"transform": {MOVED}, {center} "covariance": {covariance}}}"#)).unwrap().spread
        };
        let center = r#""center": [1, 2, 3], "radius": 40,"#;
        let spread = report(center, &c).unwrap();
        assert_eq!(spread.radius_m, 40.0);
        for (is, expected) in [
            (spread.sigmas.position_m, 4.0),
            (spread.sigmas.height_m, 0.5),
            (spread.sigmas.heading_rad, 0.03),
            (spread.sigmas.tilt_rad, 0.02),
            (spread.sigmas.log_scale, 0.04),
        ] {
            assert!((is - expected).abs() < 1e-12, "{spread:?}");
        }
        assert_eq!(report("", &c), None);
        assert_eq!(report(center, &[[0.0; 7]; 7]), None);
        assert_eq!(report(r#""center": null, "radius": "wide","#, &c), None);
        c[5][5] = -1.0;
        assert_eq!(report(center, &c), None);
    }

    #[test]
    fn names_other_json_files_of_the_project_for_what_they_are() {
        for (text, says) in [
            (MOVED, "this is a start,"),
            (r#"{"schema": "cityweld.merge/1", "parts": []}"#, "the report of a merge"),
            (r#"{"schema": "cityweld.planes/1"}"#, "the planes of a city"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(says) && message.contains("expected an alignment.json"), "{message}");
        }
    }

    #[test]
    fn says_that_a_failed_alignment_places_nothing() {
        let message = read(r#"{"verdict": "failed", "transform": null, "best_candidate": null}"#).unwrap_err();
        assert!(message.contains("alignment (failed) has neither a transform nor a best_candidate"), "{message}");
        assert!(read("{").unwrap_err().contains("not a valid alignment"));
        let shrunk = MOVED.replace("\"scale\": 2", "\"scale\": 0");
        assert!(read(&format!(r#"{{"transform": {shrunk}}}"#)).unwrap_err().contains("scale is 0"));
    }
}
