//! A reconstruction that was read: finite, and every index within its list.

use cityweld::{Image, Reconstruction};

use super::{finite, told, within};

pub fn check(sfm: &Reconstruction) -> Result<(), String> {
    finite("a point", sfm.points.iter().flat_map(|point| point.iter().copied()))?;
    finite("a normal", sfm.normals.iter().flat_map(|normal| normal.iter().copied()))?;
    finite("a reprojection error", sfm.point_errors_px.iter().copied())?;
    for camera in &sfm.cameras {
        finite("a camera", camera.params.iter().copied())?;
    }
    sfm.images.iter().try_for_each(|image| check_image(image, sfm))?;
    check_lengths(sfm)?;
    for (image, observation) in &sfm.track_elements {
        within("a track's image", image.0 as usize, sfm.images.len())?;
        let keypoints = &sfm.images[image.0 as usize].observations;
        within("a track's keypoint", *observation as usize, keypoints.len())?;
    }
    if let Some(known) = &sfm.positions {
        finite("a reference", known.reference_lla.into_iter().flatten())?;
        finite("a known position", known.of_images.iter().flatten().flatten().copied())?;
        equal("known positions", known.of_images.len(), sfm.images.len())?;
    }
    sfm.warnings.iter().try_for_each(|warning| told::check(&warning.to_string()))
}

fn check_image(image: &Image, sfm: &Reconstruction) -> Result<(), String> {
    let rotation = image.cam_from_sfm_rotation.matrix();
    finite("a pose", rotation.iter().chain(image.cam_from_sfm_translation.iter()).copied())?;
    let off = (rotation * rotation.transpose() - cityweld::Matrix3::identity()).abs().max();
    if off > 1e-6 {
        return Err(format!("a rotation that is none, off by {off}"));
    }
    within("an image's camera", image.camera.0 as usize, sfm.cameras.len())?;
    for seen in &image.observations {
        finite("a keypoint", [seen.x_px, seen.y_px])?;
        seen.point.map_or(Ok(()), |point| within("a keypoint's point", point.0 as usize, sfm.points.len()))?;
    }
    Ok(())
}

/// Lists that go with the points, or are empty.
fn check_lengths(sfm: &Reconstruction) -> Result<(), String> {
    let count = sfm.points.len();
    for (what, length) in [
        ("ids", sfm.point_ids.len()),
        ("errors", sfm.point_errors_px.len()),
        ("colours", sfm.colors.len()),
        ("normals", sfm.normals.len()),
        ("tracks", sfm.track_starts.len().saturating_sub(1)),
    ] {
        if length != 0 {
            equal(what, length, count)?;
        }
    }
    equal("ids of cameras", sfm.camera_ids.len(), sfm.cameras.len())
        .or_else(|told| if sfm.camera_ids.is_empty() { Ok(()) } else { Err(told) })?;
    sfm.fields.iter().try_for_each(|field| equal(&field.name, field.len(), count))
}

fn equal(what: &str, found: usize, expected: usize) -> Result<(), String> {
    if found == expected { Ok(()) } else { Err(format!("{what}: {found}, expected {expected}")) }
}
