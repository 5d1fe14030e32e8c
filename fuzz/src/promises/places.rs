//! Starts, positions of photographs, control points: finite.

use cityweld::output::StoredAlignment;
use cityweld::types::{ControlFile, Frame, PointSight, PositionsFile};
use cityweld::{Similarity, Start};

use super::{finite, told};

pub fn check_start(start: &Start) -> Result<(), String> {
    let sigmas = start.sigmas();
    check_similarity(start.city_from_sfm())?;
    let all = [sigmas.position_m, sigmas.height_m, sigmas.heading_rad, sigmas.tilt_rad, sigmas.log_scale];
    finite("a sigma", all)?;
    if all.iter().all(|sigma| *sigma > 0.0) { Ok(()) } else { Err(format!("a sigma of zero: {sigmas:?}")) }
}

pub fn check_alignment(stored: &StoredAlignment) -> Result<(), String> {
    check_similarity(&stored.city_from_sfm)?;
    finite("a radius", stored.spread.map(|spread| spread.radius_m))
}

fn check_similarity(similarity: &Similarity) -> Result<(), String> {
    finite("a similarity", similarity.translation.iter().copied().chain([similarity.scale]))?;
    finite("a rotation", similarity.rotation.matrix().iter().copied())?;
    if similarity.scale > 0.0 { Ok(()) } else { Err(format!("a scale of {}", similarity.scale)) }
}

pub fn check_positions(file: &PositionsFile) -> Result<(), String> {
    check_frame(&file.frame)?;
    for place in &file.positions {
        finite("a position", place.east_north.into_iter().flatten().chain(place.height_m))?;
        finite("a position's sigma", place.sigma_m.into_iter().chain(place.height_sigma_m))?;
        finite("gravity", place.gravity_in_cam.into_iter().flatten())?;
    }
    file.warnings.iter().try_for_each(|warning| told::check(warning))
}

pub fn check_points(file: &ControlFile) -> Result<(), String> {
    check_frame(&file.frame)?;
    for point in &file.points {
        finite("a control point", point.east_north.into_iter().chain([point.height_m]).chain(point.sigma_m))?;
        match &point.sight {
            PointSight::At(place) => finite("a control point", *place)?,
            PointSight::In(sights) => finite("a pixel", sights.iter().flat_map(|(pixel, _)| *pixel))?,
        }
    }
    Ok(())
}

fn check_frame(frame: &Frame) -> Result<(), String> {
    match frame {
        Frame::Tangent { latitude_deg, longitude_deg, height_m } => {
            finite("a frame", [*latitude_deg, *longitude_deg, *height_m])
        }
        _ => Ok(()),
    }
}
