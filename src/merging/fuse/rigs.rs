//! Rigs and frames of several parts in one model.

use std::collections::BTreeMap;

use super::cameras::Cameras;
use super::moved::Moved;
use super::photographs::Photo;
use crate::format::colmap::{Encoding, FrameRecord, RigRecord, SENSOR_CAMERA, SensorRecord};
use crate::reconstruction::{ColmapParts, Reconstruction};

/// Rigs and frames, where any part has them: a camera alone has a rig of its own, rigs of several are kept.
pub(super) fn colmap_parts(moved: &[Moved<'_>], cameras: &Cameras, photos: &[Photo]) -> ColmapParts {
    let is_text = |part: &Moved<'_>| part.given.colmap.as_ref().is_some_and(|c| c.encoding == Encoding::Text);
    let encoding = if moved.iter().all(is_text) { Encoding::Text } else { Encoding::Binary };
    if !moved.iter().any(|part| part.given.colmap.as_ref().is_some_and(|c| c.rigs.is_some())) {
        return ColmapParts { encoding, rigs: None, frames: None };
    }
    let mut rigs = Vec::new();
    let mut rig_of_camera: Vec<Option<u32>> = vec![None; cameras.cameras.len()];
    let mut rig_of: BTreeMap<(usize, u32), u32> = BTreeMap::new();
    for (part, sfm) in moved.iter().map(|m| &m.posed).enumerate() {
        for (camera, index) in cameras.index[part].iter().enumerate() {
            let known = &mut rig_of_camera[*index as usize];
            if cameras.alone[part][camera] && known.is_none() {
                let id = rigs.len() as u32 + 1;
                *known = Some(id);
                let reference = Some(SensorRecord { kind: SENSOR_CAMERA, id: index + 1 });
                rigs.push(RigRecord { id, reference, others: Vec::new() });
            }
        }
        let of_several = sfm.colmap.iter().flat_map(|c| c.rigs.iter().flatten()).filter(|r| !r.others.is_empty());
        for rig in of_several {
            let id = rigs.len() as u32 + 1;
            rig_of.insert((part, rig.id), id);
            let sensor = |s: SensorRecord| renumbered(s, sfm, &cameras.index[part]);
            let others = rig.others.iter().map(|(s, pose)| (sensor(*s), *pose)).collect();
            rigs.push(RigRecord { id, reference: rig.reference.map(sensor), others });
        }
    }
    let frames = frames(moved, cameras, photos, &rig_of_camera, &rig_of);
    ColmapParts { encoding, rigs: Some(rigs), frames: Some(frames) }
}

fn renumbered(sensor: SensorRecord, sfm: &Reconstruction, index: &[u32]) -> SensorRecord {
    let place = sfm.camera_ids.iter().position(|id| *id == sensor.id);
    match place.filter(|_| sensor.kind == SENSOR_CAMERA) {
        Some(place) => SensorRecord { id: index[place] + 1, ..sensor },
        None => sensor,
    }
}

fn frames(
    moved: &[Moved<'_>],
    cameras: &Cameras,
    photos: &[Photo],
    rig_of_camera: &[Option<u32>],
    rig_of: &BTreeMap<(usize, u32), u32>,
) -> Vec<FrameRecord> {
    let mut frames: Vec<FrameRecord> = Vec::new();
    let mut number_of: BTreeMap<(usize, u32), usize> = BTreeMap::new();
    // The frame of every image of a rig, by part and image id.
    let mut frame_of: BTreeMap<(usize, u64), &FrameRecord> = BTreeMap::new();
    for (part, sfm) in moved.iter().map(|m| &m.posed).enumerate() {
        for frame in sfm.colmap.iter().flat_map(|c| c.frames.iter().flatten()) {
            if rig_of.contains_key(&(part, frame.rig_id)) {
                let images = frame.data.iter().filter(|(sensor, _)| sensor.kind == SENSOR_CAMERA);
                frame_of.extend(images.map(|(_, id)| ((part, *id), frame)));
            }
        }
    }
    for (number, photo) in photos.iter().enumerate() {
        let own = moved[photo.part].pose(photo.image);
        let camera = cameras.index[photo.part][own.camera.0 as usize];
        let data = (SensorRecord { kind: SENSOR_CAMERA, id: camera + 1 }, number as u64 + 1);
        let id = frames.len() as u32 + 1;
        match (frame_of.get(&(photo.part, u64::from(own.id))), rig_of_camera[camera as usize]) {
            (Some(frame), _) => {
                let place = *number_of.entry((photo.part, frame.id)).or_insert(frames.len());
                if place == frames.len() {
                    let rig_id = rig_of[&(photo.part, frame.rig_id)];
                    frames.push(FrameRecord { id, rig_id, rig_from_world: frame.rig_from_world, data: Vec::new() });
                }
                frames[place].data.push(data);
            }
            (None, Some(rig_id)) => {
                frames.push(FrameRecord { id, rig_id, rig_from_world: own.pose(), data: vec![data] });
            }
            // A camera of a rig whose image no frame holds: the reader would not have let it pass.
            (None, None) => {}
        }
    }
    frames
}
