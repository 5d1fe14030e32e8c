//! A reconstruction as a COLMAP model.

use std::fs;
use std::io::Write;
use std::path::Path;

use super::ExportError;
use super::file::write_file;
use crate::format::colmap::{
    CAMERA_MODELS, CameraRecord, Encoding, ImageHead, NO_POINT, ObservationRecord, PointHead, RigRecord, cameras_file,
    can_be_named, frames_file, rigs_file, write_images, write_points,
};
use crate::format::escaped;
use crate::reconstruction::{ColmapParts, PointIndex, Reconstruction};

/// Writes `r`, in the frame in which it stands, into `folder` (made where missing): the encoding it came in, rigs and
/// frames if they came with it. A reconstruction that came from elsewhere is written as binary without them.
pub fn write_colmap(folder: &Path, r: &Reconstruction) -> Result<(), ExportError> {
    check(folder, r)?;
    fs::create_dir_all(folder).map_err(|source| ExportError::Unwritable { path: folder.into(), source })?;
    let plain = ColmapParts { encoding: Encoding::Binary, rigs: None, frames: None };
    let parts = r.colmap.as_ref().unwrap_or(&plain);
    let encoding = parts.encoding;
    let path = |stem: &str| folder.join(format!("{stem}.{}", encoding.extension()));
    write_file(&path("cameras"), |out| out.write_all(&cameras_file(encoding, &camera_records(r))))?;
    if let Some(rigs) = &parts.rigs {
        write_file(&path("rigs"), |out| out.write_all(&rigs_file(encoding, rigs)))?;
    }
    if let Some(frames) = &parts.frames {
        write_file(&path("frames"), |out| out.write_all(&frames_file(encoding, frames)))?;
    }
    write_file(&path("images"), |out| write_images(out, encoding, r.images.len(), |i| image_record(r, i)))?;
    write_file(&path("points3D"), |out| write_points(out, encoding, r.points.len(), |i| point_record(r, i)))
}

fn image_record(
    r: &Reconstruction,
    number: usize,
) -> (ImageHead<'_>, impl ExactSizeIterator<Item = ObservationRecord>) {
    let image = &r.images[number];
    let head = ImageHead {
        id: image.id,
        cam_from_world: image.pose(),
        camera_id: r.camera_ids[image.camera.0 as usize],
        name: image.name.as_bytes(),
    };
    let point_id = |point: PointIndex| r.point_ids[point.0 as usize];
    let observations = image.observations.iter().map(move |o| ObservationRecord {
        x: o.x_px,
        y: o.y_px,
        point_id: o.point.map_or(NO_POINT, point_id),
    });
    (head, observations)
}

fn point_record(r: &Reconstruction, number: usize) -> (PointHead, impl ExactSizeIterator<Item = (u32, u32)>) {
    let head = PointHead {
        id: r.point_ids[number],
        position: r.points[number].into(),
        color: r.colors.get(number).copied().unwrap_or_default(),
        error: r.point_errors_px.get(number).copied().unwrap_or(UNKNOWN_ERROR),
    };
    let track = r.track(PointIndex(number as u32)).iter();
    (head, track.map(|(image, keypoint)| (r.images[image.0 as usize].id, *keypoint)))
}

/// What COLMAP writes where it has not computed a reprojection error.
const UNKNOWN_ERROR: f64 = -1.0;

/// Ids and indices that a hand-made reconstruction may lack.
fn check(folder: &Path, r: &Reconstruction) -> Result<(), ExportError> {
    let unfit = |expected, got| Err(ExportError::Unfit { path: folder.into(), expected, got });
    if r.point_ids.len() != r.points.len() || r.camera_ids.len() != r.cameras.len() {
        let got = format!("{} ids for {} points", r.point_ids.len(), r.points.len());
        return unfit("an id for every point and camera", got);
    }
    let points = r.points.len();
    for image in &r.images {
        if image.camera.0 as usize >= r.cameras.len() {
            return unfit("a camera for every image", format!("image {} without one", image.id));
        }
        let is_missing = |point: PointIndex| point.0 as usize >= points;
        if image.observations.iter().any(|o| o.point.is_some_and(is_missing)) {
            return unfit("keypoints of points that are there", format!("others in image {}", image.id));
        }
    }
    if r.track_elements.iter().any(|(image, _)| image.0 as usize >= r.images.len()) {
        return unfit("tracks over images that are there", "others".into());
    }
    let encoding = r.colmap.as_ref().map_or(Encoding::Binary, |parts| parts.encoding);
    if let Some(image) = r.images.iter().find(|image| !can_be_named(encoding, image.name.as_bytes())) {
        let got = format!("`{}` of image {}", escaped(&image.name), image.id);
        return unfit("names of images that the encoding can hold; rename the image", got);
    }
    match first_not_finite(r) {
        Some(object) => unfit("finite coordinates; the scale of the move is too large for this reconstruction", object),
        None => Ok(()),
    }
}

/// The first point, image, frame or rig that is nowhere, as when a move has carried it beyond the largest numbers.
fn first_not_finite(r: &Reconstruction) -> Option<String> {
    let is_finite = |place: &[f64]| place.iter().all(|v| v.is_finite());
    if let Some(object) = first_point_not_finite(r) {
        return Some(object);
    }
    if let Some(image) = r.images.iter().find(|image| !is_finite(image.cam_from_sfm_translation.as_slice())) {
        return Some(format!("image {} at infinity", image.id));
    }
    let parts = r.colmap.as_ref()?;
    if let Some(frame) = parts.frames.iter().flatten().find(|frame| !is_finite(&frame.rig_from_world.translation)) {
        return Some(format!("frame {} at infinity", frame.id));
    }
    let mut rigs = parts.rigs.iter().flatten();
    let is_torn =
        |rig: &&RigRecord| rig.others.iter().flat_map(|(_, pose)| pose).any(|pose| !is_finite(&pose.translation));
    rigs.find(is_torn).map(|rig| format!("a sensor of rig {} at infinity", rig.id))
}

/// The first point that is nowhere.
pub(super) fn first_point_not_finite(r: &Reconstruction) -> Option<String> {
    let index = r.points.iter().position(|point| !point.iter().all(|v| v.is_finite()))?;
    let id = r.point_ids.get(index).map_or(index as u64, |id| *id);
    Some(format!("point {id} at infinity"))
}

fn camera_records(r: &Reconstruction) -> Vec<CameraRecord> {
    let cameras = r.cameras.iter().zip(&r.camera_ids).map(|(camera, id)| CameraRecord {
        id: *id,
        model: &CAMERA_MODELS[camera.model as usize],
        width: camera.width_px,
        height: camera.height_px,
        params: camera.params.clone(),
    });
    cameras.collect()
}

#[cfg(test)]
mod tests;
