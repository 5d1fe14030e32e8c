//! What an earlier run made, told from what somebody else put there: only the first may be replaced.
//!
//! A file is ours by its content where its format leaves room to say so: the reports by their schema, `scene.glb` by its
//! generator, `points.ply` by a remark. COLMAP's files have no such room; in `sfm/` they are ours by their names, where one of
//! the others stands beside it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::folder::{COLMAP_FOLDER, POINTS_FILE, REPORT_FILE, SCENE_FILE};
use super::merge_report::MERGE_REPORT_FILE;
use super::ply::REMARK;
use crate::format::city_index::is_city_index;
use crate::format::{JsonKind, LARGEST_TEXT_BYTES, read_text};

/// A file that a command unpacks beside its results: its path in the output, parts between slashes, and its content.
pub type UnpackedFile = (&'static str, &'static [u8]);

const COLMAP_STEMS: [&str; 5] = ["cameras", "images", "points3D", "rigs", "frames"];
const COLMAP_ENDINGS: [&str; 2] = ["bin", "txt"];

/// Bytes in which a header says who wrote the file.
const HEADER_BYTES: u64 = 1024;

/// The longest JSON chunk of a GLB that is looked into; a scene of a large city has some megabytes.
const LARGEST_JSON_BYTES: u64 = 64 << 20;

/// A file in `output` that no earlier run made, and that would be lost with it; `None` where there is none.
pub(super) fn foreign_file(output: &Path, unpacked: &[UnpackedFile]) -> io::Result<Option<PathBuf>> {
    let found = output.symlink_metadata()?;
    if found.is_file() {
        let is_index = || start_of(output).is_ok_and(|start| is_city_index(&start));
        let is_ours = is_our_glb(output) || is_index() || json_kind(output) == Some(JsonKind::Planes);
        return Ok((!is_ours).then(|| output.into()));
    }
    if !found.is_dir() {
        return Ok(Some(output.into()));
    }
    let earlier = Earlier { output, unpacked };
    if let Some(foreign) = earlier.foreign_in("")? {
        return Ok(Some(foreign));
    }
    // Every file at the top was told by its content, so one of them is enough.
    let is_proven = entries(output)?.iter().any(|path| path.is_file());
    Ok(if is_proven { None } else { first_file(output)? })
}

struct Earlier<'a> {
    output: &'a Path,
    unpacked: &'a [UnpackedFile],
}

impl Earlier<'_> {
    /// `place` is the folder looked through: its parts between slashes, empty for the output itself.
    fn foreign_in(&self, place: &str) -> io::Result<Option<PathBuf>> {
        for path in entries(&self.output.join(place))? {
            let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(Some(path)) };
            let inner = if place.is_empty() { name.to_owned() } else { format!("{place}/{name}") };
            let kind = path.symlink_metadata()?.file_type();
            let foreign = match (kind.is_dir(), kind.is_file()) {
                (true, _) if self.is_our_folder(&inner) => self.foreign_in(&inner)?,
                (true, _) => first_file(&path)?.or(Some(path)),
                (_, true) if self.is_our_file(&inner, &path) => None,
                _ => Some(path),
            };
            if foreign.is_some() {
                return Ok(foreign);
            }
        }
        Ok(None)
    }

    fn is_our_folder(&self, inner: &str) -> bool {
        let holds = |(path, _): &UnpackedFile| path.strip_prefix(inner).is_some_and(|rest| rest.starts_with('/'));
        inner == COLMAP_FOLDER || self.unpacked.iter().any(holds)
    }

    fn is_our_file(&self, inner: &str, path: &Path) -> bool {
        match inner {
            REPORT_FILE => json_kind(path) == Some(JsonKind::Alignment),
            MERGE_REPORT_FILE => json_kind(path) == Some(JsonKind::Merge),
            SCENE_FILE => is_our_glb(path),
            POINTS_FILE => {
                start_of(path).is_ok_and(|start| start.windows(REMARK.len()).any(|w| w == REMARK.as_bytes()))
            }
            _ => {
                is_colmap_file(inner) || self.unpacked.iter().any(|(at, content)| *at == inner && holds(path, content))
            }
        }
    }
}

fn is_colmap_file(inner: &str) -> bool {
    let name = inner.strip_prefix(COLMAP_FOLDER).and_then(|rest| rest.strip_prefix('/'));
    let parts = name.and_then(|name| name.split_once('.'));
    parts.is_some_and(|(stem, ending)| COLMAP_STEMS.contains(&stem) && COLMAP_ENDINGS.contains(&ending))
}

/// The kind that a report names itself; a file without its schema may be anybody's.
fn json_kind(path: &Path) -> Option<JsonKind> {
    JsonKind::by_schema(&read_text(path, LARGEST_TEXT_BYTES).ok()?)
}

fn holds(path: &Path, content: &[u8]) -> bool {
    path.metadata().is_ok_and(|found| found.len() == content.len() as u64)
        && fs::read(path).is_ok_and(|is| is == content)
}

fn start_of(path: &Path) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    File::open(path)?.take(HEADER_BYTES).read_to_end(&mut start)?;
    Ok(start)
}

/// True for a GLB whose generator is this program.
fn is_our_glb(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Gltf {
        asset: Asset,
    }
    #[derive(Deserialize)]
    struct Asset {
        #[serde(default)]
        generator: String,
    }
    let read = || -> io::Result<Vec<u8>> {
        let mut file = File::open(path)?;
        // Magic, version, length; then the JSON chunk's length and kind.
        let mut head = [0; 20];
        file.read_exact(&mut head)?;
        let [a, b, c, d] = [head[12], head[13], head[14], head[15]];
        let length = u64::from(u32::from_le_bytes([a, b, c, d])).min(LARGEST_JSON_BYTES);
        let mut json = Vec::new();
        if head.starts_with(b"glTF") {
            file.take(length).read_to_end(&mut json)?;
        }
        Ok(json)
    };
    let gltf: Option<Gltf> = read().ok().and_then(|json| serde_json::from_slice(&json).ok());
    gltf.is_some_and(|gltf| gltf.asset.generator.starts_with("cityweld "))
}

/// In the order of their names, so that the same file is named every time.
fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

/// Any file at or below a folder, not looking through links.
fn first_file(folder: &Path) -> io::Result<Option<PathBuf>> {
    for path in entries(folder)? {
        let found = if path.symlink_metadata()?.is_dir() { first_file(&path)? } else { Some(path) };
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}
