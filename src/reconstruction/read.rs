//! Finds out what a path holds, and reads it.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::{Reconstruction, ReconstructionWarning, WarningKind, colmap, ply};
use crate::format::colmap::{ColmapError, missing_files, read_model};
use crate::format::file::open_regular;
use crate::format::ply::{PlyError, is_ply, read_ply};

/// Why a reconstruction could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReconstructionError {
    #[error("cannot read {path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error(
        "{path}: expected a folder with cameras, images and points3D (.bin or .txt; also in its sparse/0, sparse or 0), \
         or a PLY file, got {got}"
    )]
    NotAReconstruction { path: PathBuf, got: String },
    #[error(transparent)]
    Colmap(#[from] ColmapError),
    #[error(transparent)]
    Ply(#[from] PlyError),
    #[error("{path}, {object}: expected {expected}, got {got}; export the model again from COLMAP")]
    Inconsistent { path: PathBuf, object: String, expected: String, got: String },
    #[error("{path}: the reconstruction has no points; give one that has")]
    NoPoints { path: PathBuf },
}

/// Where models lie below a folder that a user names.
const MODEL_SUBFOLDERS: [&str; 4] = ["", "sparse/0", "sparse", "0"];

/// A folder with a COLMAP model (bin or txt; the folder itself, or its sparse/0, sparse or 0 subfolder), or one PLY
/// file. By content, not only by name. One file of a model stands for its folder.
pub fn read_reconstruction(path: &Path) -> Result<Reconstruction, ReconstructionError> {
    if !path.is_dir() {
        return read_file(path);
    }
    let folders = MODEL_SUBFOLDERS.iter().map(|sub| if sub.is_empty() { path.into() } else { path.join(sub) });
    match folders.into_iter().find(|folder: &PathBuf| is_model(folder)) {
        Some(folder) => read_colmap(&folder),
        None => {
            let got = format!("a folder without {}", missing_files(path).join(" and "));
            Err(ReconstructionError::NotAReconstruction { path: path.into(), got })
        }
    }
}

fn is_model(folder: &Path) -> bool {
    missing_files(folder).is_empty()
}

fn read_file(path: &Path) -> Result<Reconstruction, ReconstructionError> {
    let mut start = Vec::new();
    open_regular(path)
        .and_then(|file| file.take(4).read_to_end(&mut start))
        .map_err(|source| ReconstructionError::Unreadable { path: path.into(), source })?;
    if is_ply(&start) {
        return ply::reconstruction(path, read_ply(path)?);
    }
    let is_model_file = path.file_stem().is_some_and(|stem| {
        ["cameras", "images", "points3D", "rigs", "frames"].iter().any(|known| stem.to_str() == Some(known))
    });
    match path.parent() {
        Some(folder) if is_model_file && is_model(folder) => read_colmap(folder),
        _ => Err(ReconstructionError::NotAReconstruction { path: path.into(), got: "another kind of file".into() }),
    }
}

fn read_colmap(folder: &Path) -> Result<Reconstruction, ReconstructionError> {
    let mut reconstruction = colmap::reconstruction(folder, read_model(folder)?)?;
    reconstruction.warnings.extend(further_models(folder));
    Ok(reconstruction)
}

/// COLMAP writes the pieces that it could not connect as 0, 1, 2, ...; only one is read.
fn further_models(folder: &Path) -> Option<ReconstructionWarning> {
    let number: u32 = folder.file_name()?.to_str()?.parse().ok()?;
    let beside = |n: u32| folder.with_file_name(n.to_string());
    let mut further = (0..).take_while(|n| *n == number || is_model(&beside(*n))).filter(|n| *n != number);
    let first = further.next()?;
    let example = beside(first).display().to_string();
    Some(ReconstructionWarning { kind: WarningKind::FurtherModels, count: 1 + further.count(), example })
}
