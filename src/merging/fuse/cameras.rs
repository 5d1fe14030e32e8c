//! Which cameras of several parts are the same.

use std::collections::{BTreeMap, BTreeSet};

use super::moved::Moved;
use crate::format::colmap::SENSOR_CAMERA;
use crate::geometry::Camera;
use crate::reconstruction::Reconstruction;

/// Which cameras are the same, and which belong to rigs of several.
pub(super) struct Cameras {
    pub cameras: Vec<Camera>,
    /// Index by part and camera, into `cameras`.
    pub index: Vec<Vec<u32>>,
    /// For each part and camera whether its rig has no other sensor.
    pub alone: Vec<Vec<bool>>,
}

impl Cameras {
    pub fn of(moved: &[Moved<'_>]) -> Cameras {
        let mut found = Cameras { cameras: Vec::new(), index: Vec::new(), alone: Vec::new() };
        let mut known: BTreeMap<(i32, u64, u64, Vec<u64>), u32> = BTreeMap::new();
        for part in moved.iter().map(|m| m.given) {
            let in_rigs = cameras_in_rigs(part);
            let alone: Vec<bool> = part.camera_ids.iter().map(|id| !in_rigs.contains(id)).collect();
            let index = part.cameras.iter().zip(&alone).map(|(camera, alone)| {
                let bits = camera.params.iter().map(|v| v.to_bits()).collect();
                let key = (camera.model.colmap_id(), camera.width_px, camera.height_px, bits);
                let next = found.cameras.len() as u32;
                let index = if *alone { *known.entry(key).or_insert(next) } else { next };
                if index == next {
                    found.cameras.push(camera.clone());
                }
                index
            });
            let index = index.collect();
            found.index.push(index);
            found.alone.push(alone);
        }
        found
    }
}

/// Ids of cameras that share a rig with another sensor.
fn cameras_in_rigs(part: &Reconstruction) -> BTreeSet<u32> {
    let rigs = part.colmap.iter().flat_map(|c| c.rigs.iter().flatten()).filter(|rig| !rig.others.is_empty());
    let sensors = rigs.flat_map(|rig| rig.reference.into_iter().chain(rig.others.iter().map(|(s, _)| *s)));
    sensors.filter(|s| s.kind == SENSOR_CAMERA).map(|s| s.id).collect()
}

#[cfg(test)]
mod tests;
