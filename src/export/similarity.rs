//! A similarity as the project's JSON files write it: matrices row by row, a row on a line.

use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use crate::geometry::Similarity;

#[derive(Serialize)]
pub(super) struct SimilarityJson {
    scale: f64,
    rotation: Vec<Box<RawValue>>,
    translation: Box<RawValue>,
}

impl SimilarityJson {
    pub(super) fn of(similarity: &Similarity) -> Result<SimilarityJson, serde_json::Error> {
        let r = similarity.rotation.matrix();
        let rows = (0..3).map(|i| to_raw_value(&[r[(i, 0)], r[(i, 1)], r[(i, 2)]]));
        Ok(SimilarityJson {
            scale: similarity.scale,
            rotation: rows.collect::<Result<_, _>>()?,
            translation: to_raw_value(&similarity.translation.as_slice())?,
        })
    }
}
