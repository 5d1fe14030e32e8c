//! The folder that an alignment becomes.

use std::io::Write;
use std::path::Path;

use super::colmap::write_colmap;
use super::file::{ExportError, write_file};
use super::gltf::{Placed, Scene, write_scene};
use super::ply::write_ply;
use super::report::alignment_report;
use super::report_input::InputSummary;
use crate::city::CityModel;
use crate::geometry::Similarity;
use crate::reconstruction::Reconstruction;
use crate::verdict::{Alignment, Verdict};

pub const REPORT_FILE: &str = "alignment.json";
pub const SCENE_FILE: &str = "scene.glb";
pub const COLMAP_FOLDER: &str = "sfm";
pub const POINTS_FILE: &str = "points.ply";

/// Which of the files with geometry are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Formats {
    /// `scene.glb`
    pub glb: bool,
    /// `sfm/`; without effect for a reconstruction without images
    pub colmap: bool,
    /// `points.ply`
    pub ply: bool,
}

impl Formats {
    pub const ALL: Formats = Formats { glb: true, colmap: true, ply: true };
}

/// Writes everything that an alignment is told by into an existing folder; returns the names of what it wrote.
pub fn write_alignment(
    folder: &Path,
    alignment: &Alignment,
    input: &InputSummary,
    city: &CityModel,
    reconstruction: &Reconstruction,
) -> Result<Vec<&'static str>, ExportError> {
    let report = alignment_report(alignment, input)?;
    write_file(&folder.join(REPORT_FILE), |out| out.write_all(report.as_bytes()))?;
    let mut files = vec![REPORT_FILE];
    let title = scene_title(alignment.verdict, &alignment.reason);
    match alignment.best_candidate {
        Some(best) => files.extend(write_placed(folder, &title, city, reconstruction, &best, Formats::ALL)?),
        None => {
            write_scene(&folder.join(SCENE_FILE), &Scene { title: &title, city: Some(city), placed: None })?;
            files.push(SCENE_FILE);
        }
    }
    Ok(files)
}

/// Writes a reconstruction at its place in the city; returns the names of what it wrote.
pub fn write_placed(
    folder: &Path,
    title: &str,
    city: &CityModel,
    reconstruction: &Reconstruction,
    city_from_sfm: &Similarity,
    formats: Formats,
) -> Result<Vec<&'static str>, ExportError> {
    let mut files = Vec::new();
    if formats.glb {
        let placed =
            Some(Placed { reconstruction, point_colors: &reconstruction.colors, city_from_sfm: *city_from_sfm });
        write_scene(&folder.join(SCENE_FILE), &Scene { title, city: Some(city), placed })?;
        files.push(SCENE_FILE);
    }
    let colmap = formats.colmap && !reconstruction.images.is_empty();
    if colmap || formats.ply {
        let moved = reconstruction.transformed(city_from_sfm);
        if colmap {
            write_colmap(&folder.join(COLMAP_FOLDER), &moved)?;
            files.push(COLMAP_FOLDER);
        }
        if formats.ply {
            write_ply(&folder.join(POINTS_FILE), &moved)?;
            files.push(POINTS_FILE);
        }
    }
    Ok(files)
}

/// The name of a scene's root node: a picture of a pose that the program does not stand behind says so itself.
fn scene_title(verdict: Verdict, reason: &str) -> String {
    match verdict {
        Verdict::Aligned => "aligned".into(),
        Verdict::Failed => format!("NOT aligned, failed: {reason}"),
        other => format!("best candidate, NOT aligned ({}): {reason}", other.word()),
    }
}
