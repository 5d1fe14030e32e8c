//! Reads a reconstruction, whatever kind it is, and holds it against itself.

use std::path::{Path, PathBuf};

use super::consistency::PoseReading;
use super::recognise::{SfmSource, recognise};
use super::{Reconstruction, ReconstructionWarning, WarningKind};
use super::{bundler, cloud, colmap, consistency, nerfstudio, nvm, openmvg, opensfm, ply};
use crate::format::colmap::{ColmapError, cloud_file, missing_files, read_model};
use crate::format::e57::{E57Error, read_e57};
use crate::format::las::{LasError, read_las};
use crate::format::nerfstudio::read_nerfstudio;
use crate::format::nvm::read_nvm;
use crate::format::openmvg::read_openmvg;
use crate::format::ply::{PlyError, read_ply};
use crate::format::sfm_file::SfmFileError;

/// Why a reconstruction could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReconstructionError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error(
        "{path}: expected a folder with cameras, images and points3D (.bin or .txt; also in its sparse/0, sparse or 0), a file of \
         points (PLY, LAS, LAZ, E57), or a reconstruction of OpenSfM, ODM, nerfstudio, OpenMVG, Bundler or VisualSFM (NVM), got {got}"
    )]
    NotAReconstruction { path: PathBuf, got: String },
    #[error(transparent)]
    Colmap(#[from] ColmapError),
    #[error(transparent)]
    Ply(#[from] PlyError),
    #[error(transparent)]
    Las(#[from] LasError),
    #[error(transparent)]
    E57(#[from] E57Error),
    #[error(transparent)]
    File(#[from] SfmFileError),
    #[error("{path}, {object}: expected {expected}, got {got}; write the model again with the program that made it")]
    Inconsistent { path: PathBuf, object: String, expected: String, got: String },
    #[error("{path}: the reconstruction has no points; give one that has")]
    NoPoints { path: PathBuf },
    #[error("{path}: the cloud has no points of the classes {wanted}; it has the classes {found}")]
    NoPointsOfClasses { path: PathBuf, wanted: String, found: String },
    #[error(
        "{path}: classes were asked for, which points of LAS, LAZ and COPC have; these have none, leave --classes out"
    )]
    NoClasses { path: PathBuf },
    #[error(
        "{path}: the coordinates are latitude and longitude in degrees, which make no shape; project them first \
         (pdal translate IN OUT reprojection --filters.reprojection.out_srs=EPSG:...)"
    )]
    Degrees { path: PathBuf },
    #[error(
        "{path}: the model contradicts itself: {told}; {reading}; write world-to-camera poses with x right, y down and z ahead, \
         as COLMAP does"
    )]
    Contradiction { path: PathBuf, told: String, reading: PoseReading },
}

/// A folder with a COLMAP model (bin or txt; the folder itself, or where tools put it below), a cloud (PLY, LAS, LAZ, COPC, E57), or
/// what OpenSfM, ODM, nerfstudio, OpenMVG, Bundler or VisualSFM wrote. By content, not only by name. One file of a COLMAP model
/// stands for its folder.
pub fn read_reconstruction(path: &Path) -> Result<Reconstruction, ReconstructionError> {
    read_reconstruction_with(path, &SfmOptions::default())
}

/// How a reconstruction is to be taken.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SfmOptions {
    /// The classes of LAS, LAZ and COPC whose points take part; where `None`, all but noise (7, 18).
    pub classes: Option<Vec<u8>>,
}

impl SfmOptions {
    pub fn with_classes(self, classes: impl Into<Vec<u8>>) -> SfmOptions {
        SfmOptions { classes: Some(classes.into()) }
    }
}

/// As [`read_reconstruction`], taken as the options say.
pub fn read_reconstruction_with(path: &Path, options: &SfmOptions) -> Result<Reconstruction, ReconstructionError> {
    let source = recognise(path)?;
    let classes = options.classes.as_deref();
    if classes.is_some() && !matches!(source, SfmSource::Las(_)) {
        return Err(ReconstructionError::NoClasses { path: path.into() });
    }
    let mut reconstruction = match &source {
        SfmSource::Colmap(folder) => read_colmap(folder)?,
        SfmSource::Ply(path) => ply::reconstruction(path, read_ply(path)?)?,
        SfmSource::Las(path) => cloud::of_las(path, read_las(path, classes)?, classes)?,
        SfmSource::E57(path) => cloud::of_e57(path, read_e57(path)?)?,
        SfmSource::OpenSfm(path) => opensfm::read(path)?,
        SfmSource::Nerfstudio(path) => nerfstudio::reconstruction(path, &read_nerfstudio(path)?)?,
        SfmSource::OpenMvg(path) => openmvg::reconstruction(path, &read_openmvg(path)?)?,
        SfmSource::Bundler(path) => bundler::read(path)?,
        SfmSource::Nvm(path) => nvm::reconstruction(path, &read_nvm(path)?)?,
    };
    consistency::check(source.path(), &mut reconstruction)?;
    Ok(reconstruction)
}

fn read_colmap(folder: &Path) -> Result<Reconstruction, ReconstructionError> {
    let model = read_model(folder)?;
    let mut reconstruction = colmap::reconstruction(folder, model)?;
    if let Some(cloud) = cloud_file(folder) {
        add_cloud(&mut reconstruction, &cloud)?;
    }
    if reconstruction.points.is_empty() {
        return Err(ReconstructionError::NoPoints { path: folder.into() });
    }
    reconstruction.warnings.extend(further_models(folder));
    Ok(reconstruction)
}

/// Points that stand in a PLY file beside cameras and images.
fn add_cloud(model: &mut Reconstruction, path: &Path) -> Result<(), ReconstructionError> {
    let cloud = ply::reconstruction(path, read_ply(path)?)?;
    let count = cloud.points.len();
    model.point_ids = (1..=count as u64).collect();
    (model.points, model.colors, model.normals, model.fields) =
        (cloud.points, cloud.colors, cloud.normals, cloud.fields);
    (model.track_starts, model.track_elements, model.point_errors_px) = (Vec::new(), Vec::new(), Vec::new());
    // Keypoints cannot name points of a file without ids.
    model.images.iter_mut().flat_map(|image| &mut image.observations).for_each(|o| o.point = None);
    model.warnings.retain(|warning| warning.kind != WarningKind::ObservationsOfMissingPoints);
    model.warnings.extend(cloud.warnings);
    let example = path.display().to_string();
    model.warnings.push(ReconstructionWarning { kind: WarningKind::PointsFromPly, count, example });
    Ok(())
}

/// COLMAP writes the pieces that it could not connect as 0, 1, 2, ...; only one is read.
fn further_models(folder: &Path) -> Option<ReconstructionWarning> {
    let number: u32 = folder.file_name()?.to_str()?.parse().ok()?;
    let beside = |n: u32| folder.with_file_name(n.to_string());
    let is_model = |folder: &Path| missing_files(folder).is_empty();
    let mut further = (0..).take_while(|n| *n == number || is_model(&beside(*n))).filter(|n| *n != number);
    let first = further.next()?;
    let example = beside(first).display().to_string();
    Some(ReconstructionWarning { kind: WarningKind::FurtherModels, count: 1 + further.count(), example })
}
