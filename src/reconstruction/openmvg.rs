//! From OpenMVG's records to a reconstruction: x_cam = R (X - centre), pixels from the corner.

use std::collections::HashMap;
use std::path::Path;

use super::posed::{Posed, PosedImage, PosedPoint, rotation, warn};
use super::{Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind};
use crate::format::openmvg::{OpenMvgIntrinsic, OpenMvgModel};
use crate::geometry::{Camera, CameraModel, Vector3};

pub(super) fn reconstruction(path: &Path, model: &OpenMvgModel) -> Result<Reconstruction, ReconstructionError> {
    let mut posed = Posed::default();
    let mut warnings = Vec::new();
    let cameras = cameras(model);
    let poses: HashMap<u32, _> = model.extrinsics.iter().map(|pose| (pose.key, pose.value)).collect();
    let mut image_of_view = HashMap::new();
    for view in &model.views {
        let data = view.value.data();
        let name = if data.local_path.is_empty() {
            data.filename.clone()
        } else {
            format!("{}/{}", data.local_path.trim_end_matches(['/', '\\']), data.filename)
        };
        let Some(pose) = poses.get(&data.id_pose) else {
            warn(&mut warnings, WarningKind::ImagesWithoutPose, || name);
            continue;
        };
        let camera = match cameras.get(&data.id_intrinsic) {
            Some(Ok(camera)) => camera.clone(),
            Some(Err(class)) => {
                warn(&mut warnings, WarningKind::CamerasNotHeld, || format!("{name}, camera `{class}`"));
                continue;
            }
            None => {
                warn(&mut warnings, WarningKind::CamerasNotHeld, || format!("{name}, which has no camera"));
                continue;
            }
        };
        let camera = posed.camera(camera);
        let image = rotation(&pose.rotation).map(|rotation| {
            let cam_from_sfm_translation = -(rotation * Vector3::from(pose.center));
            PosedImage { name, camera, cam_from_sfm_rotation: rotation, cam_from_sfm_translation }
        });
        let image = image.filter(PosedImage::is_placed).ok_or_else(|| ReconstructionError::Inconsistent {
            path: path.into(),
            object: format!("pose {}", data.id_pose),
            expected: "a rotation matrix and a finite centre".into(),
            got: format!("{:?} at {:?}", pose.rotation, pose.center),
        })?;
        image_of_view.insert(view.key, posed.images.len());
        posed.images.push(image);
    }
    posed.points = points(model, &image_of_view, &mut warnings);
    Ok(posed.into_reconstruction(SfmFormat::OpenMvg, warnings))
}

fn points(
    model: &OpenMvgModel,
    image_of_view: &HashMap<u32, usize>,
    warnings: &mut Vec<ReconstructionWarning>,
) -> Vec<PosedPoint> {
    let mut points = Vec::with_capacity(model.structure.len());
    for landmark in &model.structure {
        let mut track = Vec::with_capacity(landmark.value.observations.len());
        for observation in &landmark.value.observations {
            match image_of_view.get(&observation.key) {
                Some(image) => track.push((*image, observation.value.x)),
                None => warn(warnings, WarningKind::TracksOfMissingImages, || {
                    format!("view {} in the track of landmark {}", observation.key, landmark.key)
                }),
            }
        }
        // The format has no colours; grey is what OpenMVG's own viewers start from.
        points.push(PosedPoint { position: landmark.value.position, color: [128; 3], track });
    }
    points
}

/// The cameras by their key; the class of one that is not known.
fn cameras(model: &OpenMvgModel) -> HashMap<u32, Result<Camera, String>> {
    let classes = model.intrinsic_classes();
    let camera_of =
        |intrinsic: &OpenMvgIntrinsic, class: &str| camera(intrinsic, class).ok_or_else(|| class.to_owned());
    model.intrinsics.iter().zip(classes).map(|(i, class)| (i.key, camera_of(i.value.data(), class))).collect()
}

/// Distortion is a polynomial in the normalised plane, tangential terms as OpenCV has them.
fn camera(intrinsic: &OpenMvgIntrinsic, class: &str) -> Option<Camera> {
    let (width_px, height_px) = intrinsic.size().filter(|(width, height)| *width > 0 && *height > 0)?;
    let f = intrinsic.focal_length;
    let [cx, cy] = intrinsic.principal_point;
    let coefficients = |values: &Option<Vec<f64>>| values.clone().unwrap_or_default();
    let (model, params) = match class {
        "pinhole" => (CameraModel::SimplePinhole, vec![f, cx, cy]),
        "pinhole_radial_k1" => match coefficients(&intrinsic.disto_k1).as_slice() {
            [k1] => (CameraModel::SimpleRadial, vec![f, cx, cy, *k1]),
            _ => return None,
        },
        "pinhole_radial_k3" => match coefficients(&intrinsic.disto_k3).as_slice() {
            [k1, k2, k3] => (CameraModel::FullOpencv, vec![f, f, cx, cy, *k1, *k2, 0.0, 0.0, *k3, 0.0, 0.0, 0.0]),
            _ => return None,
        },
        "pinhole_brown_t2" => match coefficients(&intrinsic.disto_t2).as_slice() {
            [k1, k2, k3, t1, t2] => {
                (CameraModel::FullOpencv, vec![f, f, cx, cy, *k1, *k2, *t1, *t2, *k3, 0.0, 0.0, 0.0])
            }
            _ => return None,
        },
        "fisheye" => match coefficients(&intrinsic.fisheye).as_slice() {
            [k1, k2, k3, k4] => (CameraModel::OpencvFisheye, vec![f, f, cx, cy, *k1, *k2, *k3, *k4]),
            _ => return None,
        },
        "spherical" => (CameraModel::Equirectangular, vec![width_px as f64, height_px as f64]),
        _ => return None,
    };
    let camera = Camera { model, width_px, height_px, params };
    super::posed::usable(camera)
}
