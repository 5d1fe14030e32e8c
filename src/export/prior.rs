//! The start that a search began with, as `alignment.json` and `--dry-run` tell it: a start file with its source.

use serde::Serialize;

use super::similarity::SimilarityJson;
use crate::georeference::Estimate;

/// With the keys of a start file, so that it can be used as one.
#[derive(Serialize)]
pub(super) struct PriorJson<'a> {
    source: &'a str,
    #[serde(flatten)]
    pose: SimilarityJson,
    position_sigma: f64,
    height_sigma: f64,
    rotation_sigma_deg: f64,
    tilt_sigma_deg: f64,
    scale_sigma: f64,
    /// Of the reconstruction, city frame: what the sigmas are about.
    middle: [f64; 3],
}

impl PriorJson<'_> {
    pub(super) fn of(estimate: &Estimate) -> Result<PriorJson<'_>, serde_json::Error> {
        let (pose, sigmas) = (estimate.start.city_from_sfm(), estimate.start.sigmas());
        Ok(PriorJson {
            source: &estimate.source,
            pose: SimilarityJson::of(pose)?,
            position_sigma: sigmas.position_m,
            height_sigma: sigmas.height_m,
            rotation_sigma_deg: sigmas.heading_rad.to_degrees(),
            tilt_sigma_deg: sigmas.tilt_rad.to_degrees(),
            scale_sigma: sigmas.log_scale,
            middle: pose.apply(&estimate.middle).into(),
        })
    }
}
