//! Holds a reconstruction against itself, before anybody searches with it.
//!
//! Question     do points, poses and keypoints belong together?
//! Input        a reconstruction with tracks; keypoints in pixels
//! Output       warnings with figures; lines of sight denied where they cannot be right; a refusal where the poses are written the
//!              wrong way round
//! Method       points of an even sample of observations are projected: how many lie behind their camera, how far the others fall
//!              from their keypoints. Where that is bad, the poses are read in the other ways in which exporters write them
//!              (colmap/colmap#1839, #2727): camera to world, and with the axes of OpenGL (y up, z back). One that makes all well is
//!              what they are.
//! Assumptions  keypoints are in the pixels of their camera
//! Fails when   nearly all tracks are wrong alike; then they say nothing, and a warning says that

use std::path::Path;

use nalgebra::Vector3;

use super::{
    Image, ImageIndex, PointIndex, Reconstruction, ReconstructionError, ReconstructionWarning, Sight, WarningKind,
};
use crate::geometry::{CameraModel, Point3};

/// Observations that are looked at, at most. Chosen: shares are right to a third of a percent.
const MOST_OBSERVATIONS: usize = 20_000;

/// Fewer say nothing. Chosen.
const FEWEST_OBSERVATIONS: usize = 30;

/// What a sound reconstruction stays within: the share of observations behind their camera (COLMAP filters them out), and the median
/// distance of a projected point from its keypoint as a share of the picture's diagonal (0.1 % is usual, 12 pixels of 1200 here).
const SOUND: Figures = Figures { behind: 0.01, off: 0.01 };

/// Beyond this who saw a point is not believed. Chosen: a fifth of the lines of sight would come from the wrong side; or the points fall
/// elsewhere in the picture.
const BELIEVABLE: Figures = Figures { behind: 0.2, off: 0.05 };

/// How well points and keypoints go together.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    /// Share of observations whose point lies behind the camera.
    behind: f64,
    /// Median distance of projected points from their keypoints, of those ahead, as a share of the picture's diagonal.
    off: f64,
}

impl Figures {
    fn within(&self, limit: Figures) -> bool {
        self.behind <= limit.behind && self.off <= limit.off
    }
}

/// How a pose may have been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseReading {
    /// World to camera, x right, y down, z ahead: as it should be.
    AsGiven,
    /// Camera to world.
    Inverted,
    /// World to camera, y up and z back.
    OpenGl,
    /// Camera to world, y up and z back.
    InvertedOpenGl,
}

impl std::fmt::Display for PoseReading {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            PoseReading::AsGiven => "the poses are world-to-camera",
            PoseReading::Inverted => "the poses look inverted: they are camera-to-world",
            PoseReading::OpenGl => "the cameras have the axes of OpenGL: y up and z back",
            PoseReading::InvertedOpenGl => {
                "the poses look inverted: camera-to-world with the axes of OpenGL, y up and z back"
            }
        })
    }
}

/// Warns of what contradicts itself, and refuses poses that are written the wrong way round. `path` is for the message.
pub(super) fn check(path: &Path, r: &mut Reconstruction) -> Result<(), ReconstructionError> {
    r.warnings.extend(names_twice(r));
    let sample = sample(r);
    if sample.len() < FEWEST_OBSERVATIONS {
        r.warnings.extend(blind_cameras(r));
        return Ok(());
    }
    let given = figures(r, &sample, PoseReading::AsGiven);
    if given.within(SOUND) {
        return Ok(());
    }
    let told = told(r, &sample, given);
    let others = [PoseReading::Inverted, PoseReading::OpenGl, PoseReading::InvertedOpenGl];
    if let Some(reading) = others.into_iter().find(|reading| figures(r, &sample, *reading).within(SOUND)) {
        return Err(ReconstructionError::Contradiction { path: path.into(), told, reading });
    }
    if !given.within(BELIEVABLE) {
        r.sight = Sight::Denied;
    }
    let kind = if r.sight == Sight::Denied { WarningKind::SightDenied } else { WarningKind::LooseFit };
    r.warnings.push(ReconstructionWarning { kind, count: sample.len(), example: told });
    Ok(())
}

/// Observations, evenly over the tracks.
fn sample(r: &Reconstruction) -> Vec<(PointIndex, ImageIndex, u32)> {
    let step = r.track_elements.len().div_ceil(MOST_OBSERVATIONS).max(1);
    let mut point = 0;
    let elements = (0..r.track_elements.len()).step_by(step).map(|element| {
        while r.track_starts.get(point + 1).is_some_and(|end| *end as usize <= element) {
            point += 1;
        }
        let (image, keypoint) = r.track_elements[element];
        (PointIndex(point as u32), image, keypoint)
    });
    elements.collect()
}

fn figures(r: &Reconstruction, sample: &[(PointIndex, ImageIndex, u32)], reading: PoseReading) -> Figures {
    let mut off = Vec::with_capacity(sample.len());
    let mut behind = 0;
    for (point, image_index, keypoint) in sample {
        let image = &r.images[image_index.0 as usize];
        let Some(observation) = image.observations.get(*keypoint as usize) else { continue };
        let camera = r.camera_of(*image_index);
        let x_in_cam = in_cam(image, &r.points[point.0 as usize], reading);
        if camera.model != CameraModel::Equirectangular && x_in_cam.z <= 0.0 {
            behind += 1;
            continue;
        }
        let diagonal = (camera.width_px as f64).hypot(camera.height_px as f64);
        // What the lens shows nowhere is as far off as can be.
        let distance = camera
            .project(&x_in_cam)
            .map_or(1.0, |[x, y]| (x - observation.x_px).hypot(y - observation.y_px) / diagonal);
        off.push(distance);
    }
    let off = median(&mut off).unwrap_or(f64::INFINITY);
    Figures { behind: f64::from(behind) / sample.len().max(1) as f64, off }
}

fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// A point in the camera's frame (x right, y down, z ahead), if the image's pose is to be read so.
fn in_cam(image: &Image, point: &Point3<f64>, reading: PoseReading) -> Point3<f64> {
    let x = match reading {
        PoseReading::AsGiven | PoseReading::OpenGl => image.cam_from_sfm(point),
        PoseReading::Inverted | PoseReading::InvertedOpenGl => {
            image.cam_from_sfm_rotation.inverse() * (point - image.cam_from_sfm_translation)
        }
    };
    match reading {
        PoseReading::AsGiven | PoseReading::Inverted => x,
        PoseReading::OpenGl | PoseReading::InvertedOpenGl => {
            Point3::from(x.coords.component_mul(&Vector3::new(1.0, -1.0, -1.0)))
        }
    }
}

/// Cameras and points that are looked at where no tracks are, at most, and points below which nothing is said. Chosen.
const MOST_CAMERAS: usize = 100;
const MOST_POINTS: usize = 500;
const FEWEST_POINTS: usize = 50;

/// Without tracks a picture in which no point lies is all that tells of poses written the wrong way round. It is told where half of the
/// pictures are empty as the poses are given; a way to read them that leaves hardly any empty is named.
fn blind_cameras(r: &Reconstruction) -> Option<ReconstructionWarning> {
    if r.images.is_empty() || r.points.len() < FEWEST_POINTS {
        return None;
    }
    let cameras: Vec<usize> = (0..r.images.len()).step_by(r.images.len().div_ceil(MOST_CAMERAS)).collect();
    let blind = |reading| cameras.iter().filter(|image| !sees_any(r, **image, reading)).count();
    let given = blind(PoseReading::AsGiven);
    if 2 * given < cameras.len() {
        return None;
    }
    let others = [PoseReading::Inverted, PoseReading::OpenGl, PoseReading::InvertedOpenGl];
    let better = others.into_iter().find(|reading| 10 * blind(*reading) <= cameras.len());
    let reading = better.map(|reading| format!(": {reading}")).unwrap_or_default();
    let example = format!("of {} that were looked at{reading}", cameras.len());
    Some(ReconstructionWarning { kind: WarningKind::BlindCameras, count: given, example })
}

fn sees_any(r: &Reconstruction, image: usize, reading: PoseReading) -> bool {
    let camera = r.camera_of(ImageIndex(image as u32));
    let (width, height) = (camera.width_px as f64, camera.height_px as f64);
    let is_inside = |[x, y]: [f64; 2]| (0.0..width).contains(&x) && (0.0..height).contains(&y);
    let step = r.points.len().div_ceil(MOST_POINTS).max(1);
    let mut points = r.points.iter().step_by(step);
    points.any(|point| camera.project(&in_cam(&r.images[image], point, reading)).is_some_and(is_inside))
}

/// The figures as a person says them, in pixels of the first camera of the sample.
fn told(r: &Reconstruction, sample: &[(PointIndex, ImageIndex, u32)], figures: Figures) -> String {
    let behind = format!("{:.0} % of the observed points lie behind their camera", 100.0 * figures.behind);
    let Some((_, image, _)) = sample.first().filter(|_| figures.off.is_finite()) else { return behind };
    let camera = r.camera_of(*image);
    let diagonal = (camera.width_px as f64).hypot(camera.height_px as f64);
    format!("{behind}, the others have a median reprojection error of {:.0} pixels", figures.off * diagonal)
}

fn names_twice(r: &Reconstruction) -> Option<ReconstructionWarning> {
    let mut names: Vec<&str> =
        r.images.iter().map(|image| image.name.as_str()).filter(|name| !name.is_empty()).collect();
    names.sort_unstable();
    let mut twice = names.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
    let first = twice.next()?.to_string();
    Some(ReconstructionWarning { kind: WarningKind::NamesTwice, count: 1 + twice.count(), example: first })
}

#[cfg(test)]
mod tests;
