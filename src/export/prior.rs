//! The start that a search began with, as `alignment.json` and `--dry-run` tell it: a start file with its source.

use serde::Serialize;

use serde_json::value::{RawValue, to_raw_value};

use super::report_input::InputSummary;
use super::similarity::SimilarityJson;
use crate::georeference::{ControlUse, Estimate};
use crate::verdict::Alignment;

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

/// A control or check point, and how far the result puts it from where it was measured.
#[derive(Serialize)]
struct PointJson<'a> {
    name: &'a str,
    /// `control`, `check`, or `left out` where the others contradict it.
    role: &'a str,
    sfm: [f64; 3],
    city: [f64; 3],
    /// Measured less found, metres: east, north, up; `null` where nothing was found.
    residual: Option<[f64; 3]>,
    distance: Option<f64>,
    sigma: f64,
}

/// The points of the start that were used so, a line each.
pub(super) fn residuals(
    alignment: &Alignment,
    input: &InputSummary,
    is_wanted: impl Fn(ControlUse) -> bool,
) -> Result<Vec<Box<RawValue>>, serde_json::Error> {
    let points = input.prior.iter().flat_map(|prior| &prior.points).filter(|point| is_wanted(point.use_of));
    points
        .map(|point| {
            let residual = alignment.best_candidate.map(|pose| point.in_city - pose.apply(&point.in_sfm));
            to_raw_value(&PointJson {
                name: &point.name,
                role: match point.use_of {
                    ControlUse::Control => "control",
                    ControlUse::Check => "check",
                    ControlUse::LeftOut => "left out",
                },
                sfm: point.in_sfm.into(),
                city: point.in_city.into(),
                residual: residual.map(Into::into),
                distance: residual.map(|r| r.norm()),
                sigma: point.sigma_m,
            })
        })
        .collect()
}
