//! From OpenSfM's records to a reconstruction: rotation vectors world to camera, x_cam = R X + t; lengths of a picture are shares of
//! its longer side, from the middle.

use std::collections::HashMap;
use std::path::Path;

use super::posed::{Posed, PosedImage, PosedPoint, color, usable, warn};
use super::{KnownPositions, Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind};
use crate::format::opensfm::{OpenSfmCamera, OpenSfmObservation, OpenSfmPiece, read_opensfm, read_opensfm_tracks};
use crate::format::sfm_file::SfmFileError;
use crate::geometry::{Camera, CameraModel, Rotation3, Vector3};

/// The largest piece of a `reconstruction.json`, with the observations in the `tracks.csv` beside it, if there is one.
pub(super) fn read(path: &Path) -> Result<Reconstruction, ReconstructionError> {
    let mut pieces = read_opensfm(path)?;
    let largest = (0..pieces.len()).max_by_key(|i| (pieces[*i].shots.len(), std::cmp::Reverse(*i)));
    let Some(largest) = largest else { return Err(ReconstructionError::NoPoints { path: path.into() }) };
    let piece = pieces.swap_remove(largest);
    let tracks_path = path.with_file_name("tracks.csv");
    let observations = match crate::format::file::is_there(&tracks_path) {
        true => tracks_of(&tracks_path, &piece)?,
        false => Vec::new(),
    };
    let mut r = reconstruction(&piece, &observations);
    if !pieces.is_empty() {
        let shots: usize = pieces.iter().map(|piece| piece.shots.len()).sum();
        let example = format!("{shots} photographs in them, {} in the largest", piece.shots.len());
        r.warnings.push(ReconstructionWarning { kind: WarningKind::PiecesLeftOut, count: pieces.len(), example });
    }
    Ok(r)
}

fn tracks_of(path: &Path, piece: &OpenSfmPiece) -> Result<Vec<OpenSfmObservation>, SfmFileError> {
    read_opensfm_tracks(path, |shot, track| piece.shots.contains_key(shot) && piece.points.contains_key(track))
}

fn reconstruction(piece: &OpenSfmPiece, observations: &[OpenSfmObservation]) -> Reconstruction {
    let mut posed = Posed::default();
    let mut warnings = Vec::new();
    let mut image_of_shot = HashMap::new();
    let mut positions = Vec::new();
    for (name, shot) in &piece.shots {
        let camera = piece.cameras.get(&shot.camera).ok_or("none");
        let camera = camera.and_then(|camera| held(camera).ok_or(camera.projection_type.as_str()));
        let camera = match camera {
            Ok(camera) => posed.camera(camera),
            Err(projection) => {
                warn(&mut warnings, WarningKind::CamerasNotHeld, || format!("{name}, projection `{projection}`"));
                continue;
            }
        };
        let image = PosedImage {
            name: name.clone(),
            camera,
            cam_from_sfm_rotation: Rotation3::new(Vector3::from(shot.rotation)),
            cam_from_sfm_translation: shot.translation.into(),
        };
        if !image.is_placed() {
            warn(&mut warnings, WarningKind::ImagesWithoutPose, || name.clone());
            continue;
        }
        image_of_shot.insert(name.as_str(), posed.images.len());
        positions.push(shot.gps_position.filter(|place| place.iter().all(|v| v.is_finite())));
        posed.images.push(image);
    }
    let mut index_of_track = HashMap::new();
    for (id, point) in &piece.points {
        index_of_track.insert(id.as_str(), posed.points.len());
        posed.points.push(PosedPoint { position: point.coordinates, color: color(point.color), track: Vec::new() });
    }
    for OpenSfmObservation { shot, track, place: [x, y] } in observations {
        if let (Some(image), Some(point)) = (image_of_shot.get(shot.as_str()), index_of_track.get(track.as_str())) {
            let camera = &posed.cameras[posed.images[*image].camera];
            let (width, height) = (camera.width_px as f64, camera.height_px as f64);
            let side = width.max(height);
            posed.points[*point].track.push((*image, [x * side + 0.5 * width, y * side + 0.5 * height]));
        }
    }
    let reference_lla = piece.reference_lla.map(|r| [r.latitude, r.longitude, r.altitude]);
    let has_positions = positions.iter().any(Option::is_some);
    let positions = has_positions.then_some(KnownPositions { reference_lla, of_images: positions });
    Reconstruction { positions, ..posed.into_reconstruction(SfmFormat::OpenSfm, warnings) }
}

/// The camera, if there is a model for its projection (mapillary/OpenSfM, opensfm/src/geometry/camera.h).
fn held(camera: &OpenSfmCamera) -> Option<Camera> {
    use CameraModel as M;
    if let "spherical" | "equirectangular" = camera.projection_type.as_str() {
        return panorama(camera);
    }
    let OpenSfmCamera { width, height, c_x, c_y, k1, k2, k3, k4, p1, p2, .. } = *camera;
    let (width_px, height_px) = (width as f64, height as f64);
    let side = width_px.max(height_px);
    let one = camera.focal.or(camera.focal_x).map(|f| f * side);
    let (fx, fy) = (camera.focal_x.map(|f| f * side).or(one)?, camera.focal_y.map(|f| f * side).or(one)?);
    let (cx, cy) = (0.5 * width_px + c_x * side, 0.5 * height_px + c_y * side);
    let (model, params) = match camera.projection_type.as_str() {
        "perspective" => (M::Radial, vec![one?, cx, cy, k1, k2]),
        "simple_radial" => (M::Opencv, vec![fx, fy, cx, cy, k1, 0.0, 0.0, 0.0]),
        "radial" => (M::Opencv, vec![fx, fy, cx, cy, k1, k2, 0.0, 0.0]),
        "brown" => (M::FullOpencv, vec![fx, fy, cx, cy, k1, k2, p1, p2, k3, 0.0, 0.0, 0.0]),
        "fisheye" => (M::RadialFisheye, vec![one?, cx, cy, k1, k2]),
        "fisheye_opencv" => (M::OpencvFisheye, vec![fx, fy, cx, cy, k1, k2, k3, k4]),
        _ => return None,
    };
    usable(Camera { model, width_px: width, height_px: height, params })
}

fn panorama(camera: &OpenSfmCamera) -> Option<Camera> {
    let (width_px, height_px) = (camera.width, camera.height);
    let params = vec![width_px as f64, height_px as f64];
    usable(Camera { model: CameraModel::Equirectangular, width_px, height_px, params })
}
