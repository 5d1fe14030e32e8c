//! What is missing in models that real tools wrote: points and poses that are not numbers, errors that nobody computed.
//!
//! Merged models hold NaN points (colmap/colmap#640, #720), exporters NaN errors. COLMAP reads both; what is not a number is
//! left out here and counted.

use super::WarningKind;
use super::checker::Checker;
use super::frames::FramePoses;
use super::transform::rotation_of;
use crate::format::colmap::{ImageRecord, PointRecords, PoseRecord};

/// What COLMAP writes where it has not computed a reprojection error.
const UNKNOWN_ERROR: f64 = -1.0;

/// The points with a finite position; errors that are no numbers become unknown.
pub(super) fn present_points(check: &mut Checker, mut points: PointRecords) -> PointRecords {
    let mut odd_errors = 0;
    let mut first_odd = 0;
    for (error, id) in points.errors.iter_mut().zip(&points.ids).filter(|(error, _)| !error.is_finite()) {
        *error = UNKNOWN_ERROR;
        first_odd = if odd_errors == 0 { *id } else { first_odd };
        odd_errors += 1;
    }
    check.warn(WarningKind::ErrorsNotFinite, odd_errors, || format!("that of point {first_odd}"));
    let is_there = |position: &[f64; 3]| position.iter().all(|v| v.is_finite());
    match points.positions.iter().position(|p| !is_there(p)) {
        None => points,
        Some(first) => {
            let count = points.positions.iter().filter(|p| !is_there(p)).count();
            let (id, place) = (points.ids[first], points.positions[first]);
            check.warn(WarningKind::PointsWithoutPosition, count, || format!("point {id} at {place:?}"));
            kept(&points, |i| is_there(&points.positions[i]))
        }
    }
}

/// The points that `keep` names by their index, with their tracks.
fn kept(points: &PointRecords, keep: impl Fn(usize) -> bool) -> PointRecords {
    let mut left = PointRecords::with_capacity(points.ids.len(), points.track_elements.len());
    for i in (0..points.ids.len()).filter(|i| keep(*i)) {
        left.ids.push(points.ids[i]);
        left.positions.push(points.positions[i]);
        left.colors.push(points.colors[i]);
        left.errors.push(points.errors[i]);
        let track = points.track_starts[i] as usize..points.track_starts[i + 1] as usize;
        left.track_elements.extend_from_slice(&points.track_elements[track]);
        left.track_starts.push(left.track_elements.len() as u32);
    }
    left
}

/// The images with a pose: their own, or that of their frame.
pub(super) fn posed_images(
    check: &mut Checker,
    images: Vec<ImageRecord>,
    frame_poses: &FramePoses,
) -> Vec<ImageRecord> {
    let mut posed = Vec::with_capacity(images.len());
    for mut image in images {
        if !is_pose(&image.cam_from_world) {
            match frame_poses.contradicting(&image.cam_from_world, image.id, image.camera_id) {
                Some(pose) => image.cam_from_world = pose,
                None => {
                    let PoseRecord { quaternion_wxyz, translation } = image.cam_from_world;
                    check.warn(WarningKind::ImagesWithoutPose, 1, || {
                        format!(
                            "image {} with quaternion {quaternion_wxyz:?} and translation {translation:?}",
                            image.id
                        )
                    });
                    continue;
                }
            }
        }
        posed.push(image);
    }
    posed
}

fn is_pose(pose: &PoseRecord) -> bool {
    rotation_of(&pose.quaternion_wxyz).is_some() && pose.translation.iter().all(|v| v.is_finite())
}
