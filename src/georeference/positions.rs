//! From positions of photographs to a start.
//!
//! Question     where does the reconstruction stand, given where its photographs were taken?
//! Input        positions in some frame, with gravity where it was measured; the city, and its coordinate system where it is known
//! Output       [`Estimate`]
//! Method       names are matched, places projected, the cameras levelled (`level.rs`), heading, scale and shift fitted by consensus
//!              (`level_fit.rs`); of several directions that up may have, the one is taken whose positions fit best
//! Assumptions  positions share an error besides their own: satellites, atmosphere, antenna
//! Fails when   no more than one position is matched, or all are so near to each other that their noise hides heading and scale

use super::GeoreferenceError;
use super::estimate::Estimate;
use super::extent::middle;
use super::heights::reading;
use super::level::{Levelled, levelled};
use super::level_fit::{Couple, LevelFit, level_fit};
use super::matched::{Matched, matched};
use super::projection::ToCity;
use crate::city::CityModel;
use crate::format::positions::{Frame, PositionsFile, StoredPosition};
use crate::geometry::{Point3, Rotation3, Similarity, Start, StartSigmas, Vector3};
use crate::limits::Limits;
use crate::reconstruction::Reconstruction;
use crate::robust::median;

/// What all positions of a receiver are off together, one sigma, metres, where the file does not say how good they are. Chosen: what
/// phones and drones without a base station have.
const SHARED_M: f64 = 4.0;
/// Programs state what a receiver believes; datum and antenna come besides.
const LEAST_SHARED_M: f64 = 0.5;
/// Heights are two or three times worse, and what they are above is often not said.
const HEIGHT_M: f64 = 10.0;
/// So many positions tell their own noise by their residuals; of fewer it is at least this, metres. Chosen.
const ENOUGH_POSITIONS: usize = 6;
const USUAL_NOISE_M: f64 = 5.0;
/// So many of the positions must fit together: of positions of other photographs half can be made to. Chosen.
const LEAST_SHARE: f64 = 0.66;
/// The most that noise may be of the cameras' spread. Derived: positions that have nothing to do with the cameras are fitted with a spread of
/// three times their noise at most, in 99 of 100 cases.
const MOST_NOISE: f64 = 0.25;
/// Errors of a receiver drift: those of neighbouring photographs are alike, so many tell less than if each erred by itself. Chosen: of 20
/// starts with a telephone's noise one was 3.3 sigmas of heading off without it, of 40 others with it none more than 2.7.
const DRIFT: f64 = 1.5;
/// No heading and scale are better than this: reconstructions bend.
const LEAST_HEADING_RAD: f64 = 1.0 * std::f64::consts::PI / 180.0;
const LEAST_LOG_SCALE: f64 = 0.01;

/// Sets the cameras of a reconstruction on their measured positions. `city_frame`: the city's coordinate system where it is known.
pub fn from_positions(
    file: &PositionsFile,
    source_name: &str,
    sfm: &Reconstruction,
    city: &CityModel,
    city_frame: Option<&Frame>,
) -> Result<Estimate, GeoreferenceError> {
    if sfm.images.is_empty() {
        return Err(GeoreferenceError::NoCameras { source_name: source_name.into() });
    }
    let to_city = ToCity::new(&file.frame, city_frame, source_name)?;
    let matched = matched(file, source_name, sfm, &to_city)?;
    let Some((level, fit)) = best_fit(&matched, sfm, city, &Limits::default()) else {
        let has_heights = matched.iter().any(|m| m.height_m.is_some());
        return Err(if has_heights {
            too_near(0.0, 0.0, source_name)
        } else {
            GeoreferenceError::NoHeights { source_name: source_name.into() }
        });
    };
    let noise_m = noise_of(&fit, file);
    if let Some(error) = misfit(&fit, noise_m, &matched, source_name) {
        let exchanged: Vec<Matched> = matched.iter().map(Matched::with_axes_exchanged).collect();
        let fits_exchanged = best_fit(&exchanged, sfm, city, &Limits::default())
            .is_some_and(|(_, fit)| misfit(&fit, noise_of(&fit, file), &exchanged, source_name).is_none());
        return Err(if fits_exchanged {
            GeoreferenceError::Mirrored { source_name: source_name.into() }
        } else {
            error
        });
    }
    let local = city_from_sfm(&level, &fit);
    let heights = reading(&to_city, &sfm.points, &local, city);
    let shift = city.origin + Vector3::z() * heights.shift_m;
    let pose = Similarity { translation: local.translation + shift, ..local };
    let cameras = Cameras { middle: middle_of(&fit, &matched, sfm), noise_m, fit: &fit, level: &level };
    let sigmas = cameras.sigmas(file, &pose, &middle(&sfm.points), heights.is_foreign);
    let start = Start::new(pose, sigmas)
        .map_err(|error| GeoreferenceError::Start { source_name: source_name.into(), error })?;
    let source = format!(
        "positions of {} photographs ({}, {source_name}{}), {noise_m:.2} m about them",
        fit.believed.len(),
        file.format,
        heights.words
    );
    let warnings = warnings(file, &matched, &fit, &level, sfm, city);
    Ok(Estimate { start, middle: middle(&sfm.points), source, warnings, points: Vec::new() })
}

/// Why positions do not fit the cameras.
fn misfit(fit: &LevelFit, noise_m: f64, matched: &[Matched], source_name: &str) -> Option<GeoreferenceError> {
    let (believed, all) = (fit.believed.len(), placed(matched).len());
    if (believed as f64) < LEAST_SHARE * all as f64 {
        return Some(GeoreferenceError::Scattered { believed, all, source_name: source_name.into() });
    }
    let spread_m = fit.spread_m / (believed as f64).sqrt();
    (noise_m > MOST_NOISE * fit.spread_m).then(|| too_near(spread_m, noise_m, source_name))
}

/// Of a position, metres; where they are few, no less than is stated of them or usual.
fn noise_of(fit: &LevelFit, file: &PositionsFile) -> f64 {
    if fit.believed.len() >= ENOUGH_POSITIONS {
        return fit.noise_m;
    }
    fit.noise_m.max(stated(file, |p| p.sigma_m).unwrap_or(USUAL_NOISE_M))
}

fn too_near(spread_m: f64, noise_m: f64, source_name: &str) -> GeoreferenceError {
    GeoreferenceError::TooNear { spread_m, noise_m, source_name: source_name.into() }
}

/// Under the direction of up whose positions fit best.
fn best_fit(
    matched: &[Matched],
    sfm: &Reconstruction,
    city: &CityModel,
    limits: &Limits,
) -> Option<(Levelled, LevelFit)> {
    let fits = levelled(matched, sfm, limits).into_iter().filter_map(|level| {
        let fit = level_fit(&couples(matched, &level, sfm, city))?;
        Some((level, fit))
    });
    fits.min_by(|a, b| a.1.middling_m.total_cmp(&b.1.middling_m))
}

/// Positions in the city's local frame, in the order of `matched`, which all have one.
fn couples(matched: &[Matched], level: &Levelled, sfm: &Reconstruction, city: &CityModel) -> Vec<Couple> {
    let turn = turn_upright(&level.up);
    let couple = |m: &Matched| {
        let [east, north] = m.east_north?;
        Some(Couple {
            level: turn * sfm.images[m.image.0 as usize].center(),
            east_north: [east - city.origin.x, north - city.origin.y],
            height_m: m.height_m.map(|height| height - city.origin.z),
        })
    };
    matched.iter().filter_map(couple).collect()
}

/// The least turn that makes a direction of the sfm frame upright.
fn turn_upright(up: &Vector3<f64>) -> Rotation3<f64> {
    Rotation3::rotation_between(up, &Vector3::z())
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

fn city_from_sfm(level: &Levelled, fit: &LevelFit) -> Similarity {
    let heading = Rotation3::from_axis_angle(&Vector3::z_axis(), fit.heading_rad);
    Similarity { scale: fit.scale, rotation: heading * turn_upright(&level.up), translation: fit.shift }
}

fn placed(matched: &[Matched]) -> Vec<&Matched> {
    matched.iter().filter(|m| m.east_north.is_some()).collect()
}

/// Of the cameras that were believed, sfm frame.
fn middle_of(fit: &LevelFit, matched: &[Matched], sfm: &Reconstruction) -> Point3<f64> {
    let placed = placed(matched);
    let centers = fit.believed.iter().map(|&i| sfm.images[placed[i].image.0 as usize].center().coords);
    Point3::from(centers.sum::<Vector3<f64>>() / fit.believed.len() as f64)
}

/// What the cameras say of the place of the cloud.
struct Cameras<'a> {
    middle: Point3<f64>,
    noise_m: f64,
    fit: &'a LevelFit,
    level: &'a Levelled,
}

impl Cameras<'_> {
    /// About the cloud's middle, which lies off that of the cameras: turns and scale move it.
    fn sigmas(&self, file: &PositionsFile, pose: &Similarity, cloud: &Point3<f64>, is_foreign: bool) -> StartSigmas {
        let relative = DRIFT * self.noise_m / self.fit.spread_m;
        let (heading_rad, log_scale) = (relative.max(LEAST_HEADING_RAD), relative.max(LEAST_LOG_SCALE));
        let tilt_rad = self.level.sigma_rad;
        let arm = pose.apply(cloud) - pose.apply(&self.middle);
        let (beside_m, above_m) = (arm.xy().norm(), arm.z.abs());
        let of_mean = self.noise_m / (self.fit.believed.len() as f64).sqrt();
        let shared_m = stated(file, |p| p.sigma_m).map_or(SHARED_M, |sigma| sigma.max(LEAST_SHARED_M));
        let height_m = match stated(file, |p| p.height_sigma_m) {
            Some(sigma) if !is_foreign => sigma.max(LEAST_SHARED_M),
            Some(sigma) => sigma.max(HEIGHT_M),
            None => HEIGHT_M,
        };
        let horizontal = [shared_m, of_mean, beside_m * heading_rad.max(log_scale), above_m * tilt_rad];
        let vertical = [height_m, of_mean, beside_m * tilt_rad, above_m * log_scale];
        StartSigmas { position_m: norm(&horizontal), height_m: norm(&vertical), heading_rad, tilt_rad, log_scale }
    }
}

fn norm(parts: &[f64]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// The median of what the file says of its positions.
fn stated(file: &PositionsFile, of: impl Fn(&StoredPosition) -> Option<f64>) -> Option<f64> {
    median(&mut file.positions.iter().filter_map(of).collect::<Vec<f64>>())
}

fn warnings(
    file: &PositionsFile,
    matched: &[Matched],
    fit: &LevelFit,
    level: &Levelled,
    sfm: &Reconstruction,
    city: &CityModel,
) -> Vec<String> {
    let mut warnings = file.warnings.clone();
    let (given, known) = (file.positions.len(), matched.len());
    if known < given {
        warnings.push(format!(
            "{} of {given} positions are of photographs that the reconstruction does not have, or has already",
            given - known
        ));
    }
    let pose = city_from_sfm(level, fit);
    let off = |i: usize, m: &Matched| {
        let place = pose.apply(&sfm.images[m.image.0 as usize].center());
        let [east, north] = m.east_north?;
        let distance = (place.x + city.origin.x - east).hypot(place.y + city.origin.y - north);
        (!fit.believed.contains(&i)).then(|| (distance, m.name.clone()))
    };
    let wrong: Vec<(f64, String)> = placed(matched).iter().enumerate().filter_map(|(i, m)| off(i, m)).collect();
    if let Some((distance, name)) = wrong.iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
        let (count, all) = (wrong.len(), placed(matched).len());
        warnings.push(format!(
            "{count} of {all} positions are far from where the others put them, left out (the farthest: {name}, {distance:.1} m)"
        ));
    }
    warnings
}
