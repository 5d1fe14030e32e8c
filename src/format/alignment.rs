//! The report of an alignment, read back: where it puts the reconstruction, and whether the program stood behind it.

use std::path::Path;

use serde::Deserialize;

use super::placement::{PlacementError, SimilarityRecord, read_json};
use crate::geometry::Similarity;

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
}

/// Only what is asked for: the rest of a report may be edited or left out.
#[derive(Deserialize)]
struct AlignmentRecord {
    #[serde(default)]
    verdict: String,
    transform: Option<SimilarityRecord>,
    best_candidate: Option<SimilarityRecord>,
}

/// Reads the transform of a report, or its best candidate where it has no transform.
pub fn read_alignment(path: &Path) -> Result<StoredAlignment, PlacementError> {
    let record: AlignmentRecord = read_json(path, "alignment", EXPECTED)?;
    let similarity = record.transform.or(record.best_candidate);
    let similarity = similarity.ok_or_else(|| PlacementError::Empty { path: path.into() })?;
    Ok(StoredAlignment {
        city_from_sfm: similarity.check("alignment", path)?,
        is_transform: record.transform.is_some(),
        verdict: record.verdict,
    })
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
    fn says_that_a_failed_alignment_places_nothing() {
        let message = read(r#"{"verdict": "failed", "transform": null, "best_candidate": null}"#).unwrap_err();
        assert!(message.contains("neither a transform nor a best_candidate"), "{message}");
        assert!(read("{").unwrap_err().contains("not a valid alignment"));
        assert!(read(&MOVED.replace("\"scale\": 2", "\"scale\": 0")).is_err());
    }
}
