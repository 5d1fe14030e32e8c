//! What kind of reconstruction lies at a path, by content.

use std::collections::VecDeque;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::ReconstructionError;
use crate::format::bundler::is_bundler;
use crate::format::colmap::missing_files;
use crate::format::e57::is_e57;
use crate::format::file::{is_there, open_regular};
use crate::format::las::is_las;
use crate::format::nerfstudio::is_nerfstudio;
use crate::format::nvm::is_nvm;
use crate::format::openmvg::is_openmvg;
use crate::format::opensfm::is_opensfm;
use crate::format::ply::is_ply;

/// What is to be read, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SfmSource {
    /// The folder of its files.
    Colmap(PathBuf),
    Ply(PathBuf),
    Las(PathBuf),
    E57(PathBuf),
    OpenSfm(PathBuf),
    Nerfstudio(PathBuf),
    OpenMvg(PathBuf),
    Bundler(PathBuf),
    Nvm(PathBuf),
}

/// Where COLMAP models lie below a folder that a user names.
const MODEL_SUBFOLDERS: [&str; 9] =
    ["", "sparse/0", "sparse", "0", "colmap/sparse/0", "colmap/sparse", "colmap/0", "colmap", "dense/sparse"];

/// Files of a COLMAP model, one of which may stand for all.
const MODEL_STEMS: [&str; 5] = ["cameras", "images", "points3D", "rigs", "frames"];

/// Where the files of other tools lie below a folder that a user names.
const KNOWN_FILES: [&str; 8] = [
    "reconstruction.json",
    "opensfm/reconstruction.json",
    "transforms.json",
    "sfm_data.json",
    "reconstruction/sfm_data.json",
    "bundle.out",
    "bundle/bundle.out",
    "reconstruction.nvm",
];

/// Bytes of a file that are looked at.
const LOOKED_AT: u64 = 1 << 20;

/// Folders below one that are looked at, and how deep; a wrong path may lead to a whole disk.
const MOST_FOLDERS: usize = 1000;
const DEPTH: usize = 4;

/// Finds what lies at a path: a file of any kind that is read, or a folder that holds one, or one alone somewhere below.
pub fn recognise(path: &Path) -> Result<SfmSource, ReconstructionError> {
    match path.is_dir() {
        true => in_folder(path),
        false => file(path),
    }
}

fn file(path: &Path) -> Result<SfmSource, ReconstructionError> {
    let mut start = Vec::new();
    open_regular(path)
        .and_then(|file| file.take(LOOKED_AT).read_to_end(&mut start))
        .map_err(|source| ReconstructionError::Unreadable { path: path.into(), source })?;
    if let Some(source) = by_content(path, &start) {
        return Ok(source);
    }
    let is_model_file =
        path.file_stem().is_some_and(|stem| MODEL_STEMS.iter().any(|known| stem.to_str() == Some(known)));
    match path.parent() {
        Some(folder) if is_model_file && is_model(folder) => Ok(SfmSource::Colmap(folder.into())),
        _ => Err(ReconstructionError::NotAReconstruction { path: path.into(), got: other_kind(path, &start) }),
    }
}

fn by_content(path: &Path, start: &[u8]) -> Option<SfmSource> {
    let path = path.to_path_buf();
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start).trim_ascii_start();
    Some(match start {
        _ if is_ply(start) => SfmSource::Ply(path),
        _ if is_las(start) => SfmSource::Las(path),
        _ if is_e57(start) => SfmSource::E57(path),
        _ if is_nvm(text) => SfmSource::Nvm(path),
        _ if is_bundler(text) => SfmSource::Bundler(path),
        _ if !text.starts_with(b"{") && !text.starts_with(b"[") => return None,
        _ if is_openmvg(text) => SfmSource::OpenMvg(path),
        _ if is_opensfm(text) => SfmSource::OpenSfm(path),
        _ if is_nerfstudio(text) => SfmSource::Nerfstudio(path),
        _ => return None,
    })
}

/// Names a file that is none of those that are read, with what to do.
fn other_kind(path: &Path, start: &[u8]) -> String {
    let has = |key: &str| memchr::memmem::find(start, key.as_bytes()).is_some();
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let told = match extension.as_str() {
        "psx" | "psz" => "a Metashape project; export cameras and points as COLMAP, or the points as LAS or PLY",
        "rcproj" | "rsproj" => "a RealityScan project; export the registration as COLMAP, or the points as LAS or PLY",
        "p4d" => "a Pix4D project; export the points as LAS",
        "xyz" | "pts" | "ptx" | "asc" => "a text cloud; save it as LAS, E57 or PLY (CloudCompare does)",
        "rcp" | "rcs" => "a ReCap project; export E57",
        "splat" | "spz" | "ksplat" | "sog" => "packed Gaussian splats; save them as PLY (SuperSplat does)",
        "db" => "a COLMAP database, which holds no points; give the model's folder",
        "abc" | "sfm" => "a Meshroom scene; export it with its nodes ConvertSfMFormat or ExportColmap",
        _ if has("# .PCD") => "a PCD cloud; save it as PLY or LAS (CloudCompare does)",
        _ if has("<document version") && has("<chunk") => {
            "cameras of Metashape (XML), which hold no points; export COLMAP, or the points as LAS or PLY"
        }
        _ if has("\"featuresFolders\"") => "a Meshroom scene; export it with its node ConvertSfMFormat",
        _ if has("\"CityJSON\"") || has("<CityModel") || has(":CityModel") => "a city model; the city comes first",
        _ => "another kind of file",
    };
    told.into()
}

fn is_model(folder: &Path) -> bool {
    missing_files(folder).is_empty()
}

fn in_folder(path: &Path) -> Result<SfmSource, ReconstructionError> {
    if let Some(source) = at_hand(path) {
        return Ok(source);
    }
    let not_here = |got: String| ReconstructionError::NotAReconstruction { path: path.into(), got };
    let mut found = below(path);
    match found.len() {
        0 => {
            let missing = missing_files(path);
            let got = match missing.len() {
                3 => "a folder without any of these".into(),
                _ => format!("a folder without {}", missing.join(" and ")),
            };
            Err(not_here(got))
        }
        1 => Ok(found.swap_remove(0)),
        count => Err(not_here(format!(
            "a folder with {count} of them, {} and {}; name one",
            found[0].path().display(),
            found[1].path().display()
        ))),
    }
}

/// What lies where tools put it.
fn at_hand(folder: &Path) -> Option<SfmSource> {
    let below = |sub: &str| if sub.is_empty() { folder.to_path_buf() } else { folder.join(sub) };
    if let Some(model) = MODEL_SUBFOLDERS.iter().map(|sub| below(sub)).find(|folder| is_model(folder)) {
        return Some(SfmSource::Colmap(model));
    }
    KNOWN_FILES.iter().map(|name| folder.join(name)).filter(|path| is_there(path)).find_map(|path| file(&path).ok())
}

/// Everything that could be read below a folder: what tools put there, or files of clouds. Models that COLMAP numbered side by side
/// are one, the first.
fn below(top: &Path) -> Vec<SfmSource> {
    let mut found = Vec::new();
    let mut looked_at = 0;
    let mut folders = VecDeque::from([(top.to_path_buf(), 0)]);
    while let Some((folder, depth)) = folders.pop_front().filter(|_| looked_at < MOST_FOLDERS) {
        looked_at += 1;
        if let Some(source) = at_hand(&folder).filter(|_| depth > 0) {
            found.push(source);
            continue;
        }
        for path in entries(&folder) {
            if path.is_dir() && depth < DEPTH {
                folders.push_back((path, depth + 1));
            } else if has_cloud_name(&path) {
                found.extend(file(&path).ok());
            }
        }
    }
    found
}

fn has_cloud_name(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    extension.is_some_and(|e| ["ply", "las", "laz", "e57", "nvm", "out"].contains(&e.as_str()))
}

/// In the order of their names; empty where they cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

impl SfmSource {
    pub fn path(&self) -> &Path {
        match self {
            SfmSource::Colmap(path)
            | SfmSource::Ply(path)
            | SfmSource::Las(path)
            | SfmSource::E57(path)
            | SfmSource::OpenSfm(path)
            | SfmSource::Nerfstudio(path)
            | SfmSource::OpenMvg(path)
            | SfmSource::Bundler(path)
            | SfmSource::Nvm(path) => path,
        }
    }
}

#[cfg(test)]
mod tests;
