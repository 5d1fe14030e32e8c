//! From nerfstudio's `transforms.json` to a reconstruction: camera to world with the axes of OpenGL, in a world that
//! `applied_transform` turned and `applied_scale` scaled. Both are undone, for cameras and points.

use std::path::Path;

use super::posed::{Posed, PosedImage, rotation, usable, warn};
use super::{Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind, ply};
use crate::format::file::is_there;
use crate::format::nerfstudio::{NerfstudioCamera, NerfstudioModel};
use crate::format::picture_size::picture_size;
use crate::format::ply::read_ply;
use crate::geometry::{Camera, CameraModel, Matrix3, Rotation3, Similarity, Vector3};

/// The PLY file that nerfstudio makes where the file names none.
const USUAL_CLOUD: &str = "sparse_pc.ply";

pub(super) fn reconstruction(path: &Path, model: &NerfstudioModel) -> Result<Reconstruction, ReconstructionError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let odd = |object: String, expected: &str, got: String| ReconstructionError::Inconsistent {
        path: path.into(),
        object,
        expected: expected.into(),
        got,
    };
    let sfm_from_file = sfm_from_file(model).ok_or_else(|| {
        let got = format!("{:?}, applied_scale {:?}", model.applied_transform, model.applied_scale);
        odd(
            "applied_transform".into(),
            "a rotation and a translation, in three rows or four, and a scale above zero",
            got,
        )
    })?;
    let mut posed = Posed::default();
    let mut warnings = Vec::new();
    for frame in &model.frames {
        let object = || format!("frame {}", crate::format::escaped(&frame.file_path));
        let no_pose = || {
            let expected = "a rotation and a finite place in its transform_matrix";
            odd(object(), expected, format!("{:?}", frame.transform_matrix))
        };
        let (rotation, center) = camera_to_world(&frame.transform_matrix).ok_or_else(no_pose)?;
        let told = frame.own.or(&model.shared);
        let name = frame.file_path.strip_prefix("./").unwrap_or(&frame.file_path).to_owned();
        let camera = camera(&told, || picture_size(&folder.join(&name)));
        let Some(camera) = camera else {
            warn(&mut warnings, WarningKind::CamerasNotHeld, || format!("{name}: {}", words(&told)));
            continue;
        };
        let camera = posed.camera(camera);
        // x right, y up, z back: half a turn about x from x right, y down, z ahead.
        let half_turn = Rotation3::from_matrix_unchecked(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)));
        let cam_from_sfm_rotation = half_turn * rotation.inverse() * sfm_from_file.rotation.inverse();
        let cam_from_sfm_translation = -(cam_from_sfm_rotation * sfm_from_file.apply(&center.into()).coords);
        let image = PosedImage { name, camera, cam_from_sfm_rotation, cam_from_sfm_translation };
        if !image.is_placed() {
            return Err(no_pose());
        }
        posed.images.push(image);
    }
    let cameras = posed.into_reconstruction(SfmFormat::Nerfstudio, warnings);
    let cloud = folder.join(model.ply_file_path.as_deref().unwrap_or(USUAL_CLOUD));
    with_points(cameras, &cloud, &sfm_from_file)
}

/// The points of the cloud beside it, if that is there.
fn with_points(
    mut cameras: Reconstruction,
    cloud: &Path,
    sfm_from_file: &Similarity,
) -> Result<Reconstruction, ReconstructionError> {
    if !is_there(cloud) {
        let example = format!("{}, which is not there", cloud.display());
        cameras.warnings.push(ReconstructionWarning { kind: WarningKind::NoPoints, count: 1, example });
        return Ok(cameras);
    }
    let mut points = ply::reconstruction(cloud, read_ply(cloud)?)?;
    points.transform(sfm_from_file);
    if let Some(number) = points.points.iter().position(|point| !point.iter().all(|v| v.is_finite())) {
        return Err(ReconstructionError::Inconsistent {
            path: cloud.into(),
            object: format!("point {number}"),
            expected: "a finite place after applied_transform and applied_scale are taken back".into(),
            got: "one beyond all numbers".into(),
        });
    }
    cameras.point_ids = (1..=points.points.len() as u64).collect();
    cameras.warnings.append(&mut points.warnings);
    let Reconstruction { points, colors, normals, fields, .. } = points;
    Ok(Reconstruction { points, colors, normals, fields, ..cameras })
}

/// What undoes the applied transform, and before it the applied scale; `None` where that is no similarity.
fn sfm_from_file(model: &NerfstudioModel) -> Option<Similarity> {
    let scale = model.applied_scale.unwrap_or(1.0);
    let (turn, shift) = match &model.applied_transform {
        Some(rows) => camera_to_world(rows)?,
        None => (Rotation3::identity(), Vector3::zeros()),
    };
    let is_scale = scale.is_finite() && scale > 0.0 && scale.recip().is_finite();
    let rotation = turn.inverse();
    is_scale.then(|| Similarity { scale: scale.recip(), rotation, translation: -(rotation * shift) })
}

/// Rotation and translation of three rows or four.
fn camera_to_world(rows: &[[f64; 4]]) -> Option<(Rotation3<f64>, Vector3<f64>)> {
    let rows = match rows {
        [a, b, c] => [a, b, c],
        [a, b, c, [0.0, 0.0, 0.0, 1.0]] => [a, b, c],
        _ => return None,
    };
    let turn = rotation(&rows.map(|row| [row[0], row[1], row[2]]))?;
    let place = Vector3::from(rows.map(|row| row[3]));
    place.iter().all(|v| v.is_finite()).then_some((turn, place))
}

/// The camera, if there is a model for it. `size` looks at the picture, for files that do not tell.
fn camera(told: &NerfstudioCamera, size: impl FnOnce() -> Option<(u32, u32)>) -> Option<Camera> {
    let (w, h) = match told.w.zip(told.h) {
        Some(known) => known,
        None => size().map(|(w, h)| (f64::from(w), f64::from(h)))?,
    };
    let (width_px, height_px) = (w.round() as u64, h.round() as u64);
    let name = told.camera_model.as_deref().unwrap_or("OPENCV");
    if name == "EQUIRECTANGULAR" {
        return usable(Camera { model: CameraModel::Equirectangular, width_px, height_px, params: vec![w, h] });
    }
    let by_angle = || told.camera_angle_x.map(|angle| 0.5 * w / (0.5 * angle).tan());
    let fx = told.fl_x.or_else(by_angle)?;
    let fy = told.fl_y.unwrap_or(fx);
    let (cx, cy) = (told.cx.unwrap_or(0.5 * w), told.cy.unwrap_or(0.5 * h));
    let [k1, k2, k3, k4, p1, p2] =
        [told.k1, told.k2, told.k3, told.k4, told.p1, told.p2].map(|value| value.unwrap_or(0.0));
    let is_fisheye = name == "OPENCV_FISHEYE" || told.is_fisheye == Some(true);
    let (model, params) = match name {
        _ if is_fisheye => (CameraModel::OpencvFisheye, vec![fx, fy, cx, cy, k1, k2, k3, k4]),
        // A fourth coefficient of r^8 has no place in any model here.
        "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" | "PERSPECTIVE" if k4 == 0.0 => {
            (CameraModel::FullOpencv, vec![fx, fy, cx, cy, k1, k2, p1, p2, k3, 0.0, 0.0, 0.0])
        }
        _ => return None,
    };
    let plain = params[4..].iter().all(|v| *v == 0.0) && !is_fisheye;
    let (model, params) = match (plain, k3 == 0.0 && !is_fisheye) {
        (true, _) => (CameraModel::Pinhole, params[..4].to_vec()),
        (_, true) => (CameraModel::Opencv, params[..8].to_vec()),
        _ => (model, params),
    };
    usable(Camera { model, width_px, height_px, params })
}

/// What a camera lacks, or is.
fn words(told: &NerfstudioCamera) -> String {
    match (told.w.zip(told.h), told.fl_x.or(told.camera_angle_x)) {
        (None, _) => "neither w and h, nor the picture itself".into(),
        (_, None) => "neither fl_x nor camera_angle_x".into(),
        _ => format!("camera_model `{}`", told.camera_model.as_deref().unwrap_or("OPENCV")),
    }
}

#[cfg(test)]
mod tests;
