//! `reconstruction.json` of OpenSfM and ODM: every shot's `gps_position`, metres east, north and up of `reference_lla`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::error::PositionsError;
use super::frame::Frame;
use super::record::{PositionsFile, StoredPosition, sigma};

const EXPECTED: &str = "reconstruction.json of OpenSfM with reference_lla and the gps_position of its shots";

#[derive(Deserialize)]
struct Model {
    reference_lla: Option<Reference>,
    #[serde(default)]
    shots: BTreeMap<String, Shot>,
}

#[derive(Clone, Copy, Deserialize)]
struct Reference {
    latitude: f64,
    longitude: f64,
    #[serde(default)]
    altitude: f64,
}

#[derive(Deserialize)]
struct Shot {
    gps_position: Option<[f64; 3]>,
    gps_dop: Option<f64>,
}

pub(super) fn parse(text: &str, path: &Path) -> Result<PositionsFile, PositionsError> {
    let models: Vec<Model> =
        serde_json::from_str(text).map_err(|source| PositionsError::Json { path: path.into(), source })?;
    let fault = |found: &str| PositionsError::Content { path: path.into(), found: found.into(), expected: EXPECTED };
    let reference =
        models.iter().find_map(|model| model.reference_lla).ok_or_else(|| fault("it has no reference_lla"))?;
    let Reference { latitude, longitude, altitude } = reference;
    if !(latitude.abs() <= 90.0 && longitude.abs() <= 360.0 && altitude.is_finite()) {
        return Err(fault("reference_lla is no place on Earth"));
    }
    let shots = models.into_iter().flat_map(|model| model.shots);
    let positions = shots.filter_map(|(name, shot)| {
        let [east, north, up] = shot.gps_position?;
        let start = StoredPosition::at(&name, [east, north], Some(up));
        Some(StoredPosition { sigma_m: sigma(shot.gps_dop), ..start })
    });
    Ok(PositionsFile {
        format: "OpenSfM reconstruction",
        frame: Frame::Tangent { latitude_deg: latitude, longitude_deg: longitude, height_m: altitude },
        positions: positions.collect(),
        warnings: Vec::new(),
    })
}
