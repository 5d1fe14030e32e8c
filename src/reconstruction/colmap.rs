//! From COLMAP's records to a reconstruction: ids become indices, and what the records say together is checked.

use std::path::Path;

use rayon::prelude::*;

use super::checker::Checker;
use super::colmap_gaps::{posed_images, present_points};
use super::frames::FramePoses;
use super::ids::IdIndex;
use super::tracks::{Links, tracks};
use super::*;
use crate::format::colmap::{CameraRecord, ImageRecord, Miscount, Model, NO_POINT, ObservationRecord, PointRecords};
use crate::geometry::{Camera, CameraModel, Point3};

/// How far a quaternion's length may be from one without a word: text of few digits.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// The model of a folder.
pub(super) fn reconstruction(folder: &Path, model: Model) -> Result<Reconstruction, ReconstructionError> {
    let mut check = Checker { folder: folder.into(), warnings: Vec::new() };
    check_counts(&mut check, &model.miscounts);
    let frame_poses = FramePoses::new(&check, model.rigs.as_deref(), model.frames.as_deref())?;
    let points = present_points(&mut check, model.points);
    let image_records = posed_images(&mut check, model.images, &frame_poses);
    let camera_index = check.index("cameras", "camera", model.cameras.iter().map(|c| c.id.into()))?;
    let image_index = check.index("images", "image", image_records.iter().map(|i| i.id.into()))?;
    if points.ids.contains(&NO_POINT) {
        let got = "18446744073709551615, which marks keypoints without a point";
        return Err(check.fault("points3D", format!("point {NO_POINT}"), "an id below 2^64 - 1", got));
    }
    let point_index = check.index("points3D", "point", points.ids.iter().copied())?;
    let camera_ids = model.cameras.iter().map(|c| c.id).collect();
    let cameras = model.cameras.into_iter().map(|record| camera(&check, record)).collect::<Result<_, _>>()?;
    let (images, links) = images(&mut check, image_records, &camera_index, &point_index, &frame_poses)?;
    check.warn(WarningKind::NoImages, usize::from(images.is_empty()), || folder.display().to_string());
    let tracks = tracks(&mut check, &points, &image_index, &images, links);
    if !images.is_empty() {
        warn_of_lonely_points(&mut check, &points.ids, &tracks.starts);
    }
    let PointRecords { ids, positions, colors, errors, .. } = points;
    Ok(Reconstruction {
        format: SfmFormat::Colmap,
        cameras,
        camera_ids,
        images,
        points: positions.into_iter().map(Point3::from).collect(),
        point_ids: ids,
        point_errors_px: errors,
        colors,
        track_starts: tracks.starts,
        track_elements: tracks.elements,
        colmap: Some(ColmapParts { encoding: model.encoding, rigs: model.rigs, frames: model.frames }),
        warnings: check.warnings,
        ..Reconstruction::default()
    })
}

fn check_counts(check: &mut Checker, miscounts: &[Miscount]) {
    for Miscount { stem, announced, found } in miscounts {
        let kind = if found < announced { WarningKind::FewerThanAnnounced } else { WarningKind::MoreThanAnnounced };
        let example = || format!("{stem}.txt says {announced} and holds {found}");
        check.warn(kind, found.abs_diff(*announced), example);
    }
}

fn camera(check: &Checker, record: CameraRecord) -> Result<Camera, ReconstructionError> {
    let object = || format!("camera {}", record.id);
    let model = CameraModel::from_colmap_id(record.model.id)
        .ok_or_else(|| check.fault("cameras", object(), "a known model", record.model.name))?;
    if record.width == 0 || record.height == 0 {
        let got = format!("{} x {} pixels", record.width, record.height);
        return Err(check.fault("cameras", object(), "a picture of at least one pixel", got));
    }
    if !record.params.iter().all(|v| v.is_finite()) {
        return Err(check.fault("cameras", object(), "finite parameters", format!("{:?}", record.params)));
    }
    let camera = Camera { model, width_px: record.width, height_px: record.height, params: record.params };
    match camera.focal_px() {
        Some(focal_px) if focal_px > 0.0 && focal_px.is_finite() => Ok(camera),
        _ => Err(check.fault(
            "cameras",
            object(),
            "a focal length above zero, and finite",
            format!("{:?}", camera.params),
        )),
    }
}

fn images(
    check: &mut Checker,
    records: Vec<ImageRecord>,
    cameras: &IdIndex,
    points: &IdIndex,
    frame_poses: &FramePoses,
) -> Result<(Vec<Image>, Links), ReconstructionError> {
    let read: Vec<_> = records
        .into_par_iter()
        .enumerate()
        .map(|(image, mut record)| {
            let image = ImageIndex(image as u32);
            let observations = observations(image, std::mem::take(&mut record.observations), points);
            (record, observations)
        })
        .collect();
    let mut images = Vec::with_capacity(read.len());
    let mut links = Links::default();
    for (record, observed) in read {
        let mut image = image(check, record, cameras, frame_poses)?;
        let observed = observed.map_err(|keypoint| {
            let object = format!("keypoint {keypoint} of image {}", image.id);
            check.fault("images", object, "a finite position", "a number that is not finite")
        })?;
        check.warn(WarningKind::ObservationsOfMissingPoints, observed.missing, || format!("in image {}", image.id));
        let is_empty = observed.observations.is_empty();
        check.warn(WarningKind::ImagesWithoutObservations, is_empty.into(), || format!("image {}", image.id));
        image.observations = observed.observations;
        links.join(observed.links);
        images.push(image);
    }
    Ok((images, links))
}

/// What an image observed.
struct Observed {
    observations: Vec<Observation>,
    links: Links,
    /// Observations that name a point that is not there.
    missing: usize,
}

/// Indices for ids; or the number of the first keypoint that is not finite.
fn observations(image: ImageIndex, records: Vec<ObservationRecord>, points: &IdIndex) -> Result<Observed, usize> {
    if let Some(keypoint) = records.iter().position(|o| !(o.x.is_finite() && o.y.is_finite())) {
        return Err(keypoint);
    }
    let mut missing = 0;
    let mut links = Links::default();
    // Both types have the same size, so that collecting takes no further memory.
    let observations = records.into_iter().zip(0..).map(|(ObservationRecord { x, y, point_id }, keypoint)| {
        let point = if point_id == NO_POINT { None } else { points.get(point_id).map(PointIndex) };
        match point {
            Some(point) => links.add(image, keypoint, point),
            None => missing += usize::from(point_id != NO_POINT),
        }
        Observation { x_px: x, y_px: y, point }
    });
    Ok(Observed { observations: observations.collect(), links, missing })
}

/// An image without its observations.
fn image(
    check: &mut Checker,
    record: ImageRecord,
    cameras: &IdIndex,
    frame_poses: &FramePoses,
) -> Result<Image, ReconstructionError> {
    let object = || format!("image {}", record.id);
    let camera = cameras.get(record.camera_id.into()).map(CameraIndex).ok_or_else(|| {
        check.fault("images", object(), "a camera of the model", format!("camera {}", record.camera_id))
    })?;
    let length = record.cam_from_world.quaternion_wxyz.iter().map(|v| v * v).sum::<f64>().sqrt();
    let is_off = (length - 1.0).abs() > QUATERNION_TOLERANCE;
    check.warn(WarningKind::UnnormalizedQuaternions, usize::from(is_off), object);
    let name = match String::from_utf8(record.name) {
        Ok(name) => name,
        Err(error) => {
            check.warn(WarningKind::NamesNotUtf8, 1, object);
            error.into_bytes().into_iter().map(char::from).collect()
        }
    };
    let mut image = Image { id: record.id, camera, name, ..Image::default() };
    image.set_pose(&record.cam_from_world);
    if let Some(pose) = frame_poses.contradicting(&record.cam_from_world, record.id, record.camera_id) {
        check.warn(WarningKind::PosesThatFramesContradict, 1, || format!("image {}", image.id));
        image.set_pose(&pose);
    }
    Ok(image)
}

fn warn_of_lonely_points(check: &mut Checker, ids: &[u64], track_starts: &[u32]) {
    let is_alone = |ends: &&[u32]| ends[0] == ends[1];
    if let Some(first) = track_starts.windows(2).position(|ends| is_alone(&ends)) {
        let count = track_starts.windows(2).filter(is_alone).count();
        check.warn(WarningKind::PointsWithoutTrack, count, || format!("point {}", ids[first]));
    }
}
