//! From VisualSFM's records to a reconstruction: quaternions world to camera, then the camera's centre.
//!
//! Two things are not told by the file and found by reprojection. Measurements count from the middle of the picture or from its
//! corner: where the principal point seems to lie tells. The radial distortion d acts on the measurement; 1 - d r^2 on the normalised
//! plane fits the sample of this format best (0.49 px; 8.4 px without, 0.7 px by a division, 16.8 px with the other sign).

use std::path::Path;

use super::picture_sizes::{median_place, middle, size_of_photograph, sizes_by_halves, warn_of_guess};
use super::posed::{Posed, PosedImage, PosedPoint, color, usable, warn};
use super::transform::rotation_of;
use super::{Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind};
use crate::format::nvm::{NvmCamera, NvmModel};
use crate::geometry::{Camera, CameraModel, Point3, Rotation3, Vector3};

/// A principal point nearer to the origin than this share of how far measurements reach is one in the middle. Chosen: a corner lies at
/// half of that, the middle at nothing.
const MIDDLE_SHARE: f64 = 0.15;

pub(super) fn reconstruction(path: &Path, model: &NvmModel) -> Result<Reconstruction, ReconstructionError> {
    let mut warnings = Vec::new();
    let rotations = rotations(path, model)?;
    let offsets = offsets(model, &rotations);
    let reach = model
        .points
        .iter()
        .flat_map(|p| &p.measurements)
        .flat_map(|(_, place)| place)
        .fold(0.0, |reach: f64, v| if v.is_finite() { reach.max(v.abs()) } else { reach });
    let all: Vec<[f64; 2]> = offsets.iter().flatten().copied().collect();
    // Of each camera one, so that few cameras tell it as well.
    let offset = median_place(&all).unwrap_or_default();
    let from_corner = offset[0].hypot(offset[1]) > MIDDLE_SHARE * reach;
    let sizes = sizes(path, model, &offsets, from_corner, &mut warnings);
    let mut posed = Posed::default();
    let mut image_of_camera = Vec::new();
    for ((record, rotation), size) in model.cameras.iter().zip(&rotations).zip(&sizes) {
        let Some(camera) = size.and_then(|size| camera(model, record, size)) else {
            warn(&mut warnings, WarningKind::CamerasNotHeld, || {
                format!("{}, focal length {}", record.name, record.focal_px)
            });
            image_of_camera.push(None);
            continue;
        };
        image_of_camera.push(Some(posed.images.len()));
        let camera = posed.camera(camera);
        let cam_from_sfm_translation = -(rotation * Vector3::from(record.center));
        let name = record.name.clone();
        posed.images.push(PosedImage { name, camera, cam_from_sfm_rotation: *rotation, cam_from_sfm_translation });
    }
    for point in &model.points {
        let track = point.measurements.iter().filter_map(|(camera, [x, y])| {
            let image = image_of_camera[*camera]?;
            let (width, height) = sizes[*camera]?;
            let shift = if from_corner { [0.0; 2] } else { [0.5 * width as f64, 0.5 * height as f64] };
            Some((image, [x + shift[0], y + shift[1]]))
        });
        posed.points.push(PosedPoint { position: point.position, color: color(point.color), track: track.collect() });
    }
    if model.further_models > 0 {
        let example = format!("{} photographs in the largest", model.cameras.len());
        let (kind, count) = (WarningKind::PiecesLeftOut, model.further_models);
        warnings.push(ReconstructionWarning { kind, count, example });
    }
    Ok(posed.into_reconstruction(SfmFormat::Nvm, warnings))
}

fn rotations(path: &Path, model: &NvmModel) -> Result<Vec<Rotation3<f64>>, ReconstructionError> {
    let rotation = |camera: &NvmCamera| {
        let is_placed = camera.center.iter().all(|v| v.is_finite());
        rotation_of(&camera.quaternion_wxyz).filter(|_| is_placed).ok_or_else(|| ReconstructionError::Inconsistent {
            path: path.into(),
            object: format!("camera {}", crate::format::escaped(&camera.name)),
            expected: "a quaternion other than zero and a finite centre".into(),
            got: format!("{:?} at {:?}", camera.quaternion_wxyz, camera.center),
        })
    };
    model.cameras.iter().map(rotation).collect()
}

/// Where the principal point of each camera seems to lie, in its measurements.
fn offsets(model: &NvmModel, rotations: &[Rotation3<f64>]) -> Vec<Option<[f64; 2]>> {
    let mut found = vec![Vec::new(); model.cameras.len()];
    for point in &model.points {
        for (number, [x, y]) in &point.measurements {
            let camera = &model.cameras[*number];
            let x_in_cam = rotations[*number] * (Point3::from(point.position) - Point3::from(camera.center));
            if x_in_cam.z > 0.0 {
                let flat = x_in_cam.xy() / x_in_cam.z;
                let pixel = camera.focal_px * (1.0 - camera.distortion * flat.norm_squared()) * flat;
                found[*number].push([x - pixel.x, y - pixel.y]);
            }
        }
    }
    // A few observations are better than none where no camera has many.
    let is_poor = found.iter().all(|offsets| middle(offsets).is_none());
    let few = |offsets: &Vec<[f64; 2]>| if is_poor { offsets.first().copied() } else { None };
    found.iter().map(|offsets| middle(offsets).or_else(|| few(offsets))).collect()
}

/// The size of each picture, as far as anything tells.
fn sizes(
    path: &Path,
    model: &NvmModel,
    offsets: &[Option<[f64; 2]>],
    from_corner: bool,
    warnings: &mut Vec<ReconstructionWarning>,
) -> Vec<Option<(u64, u64)>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let photographs: Vec<_> = model.cameras.iter().map(|camera| size_of_photograph(folder, &camera.name)).collect();
    let mut reach = vec![None; model.cameras.len()];
    for (number, [x, y]) in model.points.iter().flat_map(|point| &point.measurements) {
        let far: &mut [f64; 2] = reach[*number].get_or_insert([0.0; 2]);
        (far[0], far[1]) = (far[0].max(x.abs()), far[1].max(y.abs()));
    }
    // From the corner the principal point is half the size; from the middle a measurement reaches half the size at most.
    let halves = if from_corner { offsets.to_vec() } else { reach };
    let estimated = sizes_by_halves(&halves);
    let mut sizes = photographs;
    for (number, size) in sizes.iter_mut().enumerate().filter(|(_, size)| size.is_none()) {
        *size = estimated.as_ref().map(|sizes| sizes[number]);
        if let Some(size) = size {
            warn_of_guess(warnings, &model.cameras[number].name, *size);
        }
    }
    sizes
}

fn camera(model: &NvmModel, record: &NvmCamera, (width_px, height_px): (u64, u64)) -> Option<Camera> {
    let (cx, cy) = (0.5 * width_px as f64, 0.5 * height_px as f64);
    let (model, params) = match model.fixed_calibration {
        Some([fx, cx, fy, cy]) => (CameraModel::Pinhole, vec![fx, fy, cx, cy]),
        None => (CameraModel::SimpleRadial, vec![record.focal_px, cx, cy, -record.distortion]),
    };
    usable(Camera { model, width_px, height_px, params })
}
