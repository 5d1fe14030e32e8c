//! A reconstruction as a COLMAP model.

use std::fs;
use std::io::Write;
use std::path::Path;

use super::ExportError;
use super::file::write_file;
use crate::format::colmap::{
    CAMERA_MODELS, CameraRecord, Encoding, ImageHead, NO_POINT, ObservationRecord, PointHead, cameras_file,
    frames_file, rigs_file, write_images, write_points,
};
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
            return unfit("a camera for every image", format!("image {} without one", image.name));
        }
        let is_missing = |point: PointIndex| point.0 as usize >= points;
        if image.observations.iter().any(|o| o.point.is_some_and(is_missing)) {
            return unfit("keypoints of points that are there", format!("others in image {}", image.name));
        }
    }
    if r.track_elements.iter().any(|(image, _)| image.0 as usize >= r.images.len()) {
        return unfit("tracks over images that are there", "others".into());
    }
    Ok(())
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
