//! Where superpixels come from, and what can go wrong.

use std::path::{Path, PathBuf};

use crate::format::escaped;
use crate::observer::Cancelled;

/// Where superpixels come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SuperpixelSource {
    /// A folder of label images: PNG, 8 or 16 bit grey, same path and stem as the photograph.
    Labels(PathBuf),
    /// A folder of photographs, JPEG or PNG, which are cut into superpixels.
    Photos(PathBuf),
}

impl SuperpixelSource {
    pub fn folder(&self) -> &Path {
        match self {
            SuperpixelSource::Labels(folder) | SuperpixelSource::Photos(folder) => folder,
        }
    }

    /// What one file of this source is called in messages.
    pub(super) fn noun(&self) -> &'static str {
        match self {
            SuperpixelSource::Labels(_) => "label image",
            SuperpixelSource::Photos(_) => "photograph",
        }
    }
}

/// Why superpixels could not be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageryError {
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error(
        "the reconstruction has no images, so {noun}s have nothing to refer to; give a COLMAP model, \
         or leave them out: {}",
        shown(folder)
    )]
    NoImages { noun: &'static str, folder: PathBuf },
    #[error("cannot read the folder of {noun}s, expected an existing folder ({reason}): {}", shown(folder))]
    Folder { noun: &'static str, folder: PathBuf, reason: String },
    #[error(
        "no {noun} found for any of the {images} images of the reconstruction; files go by the image's name, \
         for the first {} is looked for; give the folder which that path starts from: {}",
        escaped(example),
        shown(folder)
    )]
    NothingFound { noun: &'static str, images: usize, example: String, folder: PathBuf },
    #[error(
        "the {noun} of {} may be {} or {}; give it the path of the image, or take one away: {}",
        escaped(name),
        escaped(first),
        escaped(second),
        shown(folder)
    )]
    Ambiguous { noun: &'static str, name: String, first: String, second: String, folder: PathBuf },
    #[error("cannot read {noun} ({reason}): {}", shown(path))]
    Unreadable { noun: &'static str, reason: String, path: PathBuf },
    #[error(
        "cannot decode {noun} ({}); save it again as {expected}, or take it away: {}",
        escaped(reason),
        shown(path)
    )]
    Undecodable { noun: &'static str, reason: String, expected: &'static str, path: PathBuf },
    #[error(
        "{noun} claims to be {width} x {height} pixels, which takes more than {limit_mib} MiB; \
         if that is true, scale it down: {}",
        shown(path)
    )]
    TooLarge { noun: &'static str, width: u32, height: u32, limit_mib: u64, path: PathBuf },
    #[error(
        "{noun} is {} x {} pixels, more than {most_times} times the pixels of its camera's {} x {}; scale it down to what the \
         reconstruction used: {}", found.0, found.1, camera.0, camera.1, shown(path)
    )]
    FarLarger { noun: &'static str, found: (u32, u32), camera: (u32, u32), most_times: u64, path: PathBuf },
    #[error(
        "label image is {found}, expected 8 or 16 bit grey whose values are superpixel ids (0: none); \
         save it as grey PNG without colours, palette and alpha: {}",
        shown(path)
    )]
    NotGrey { found: String, path: PathBuf },
    #[error(
        "{noun} is {} x {} pixels, expected the shape of its camera's {} x {}{}; give it as the reconstruction \
         used it: {}", found.0, found.1, camera.0, camera.1,
        if *turned { " (it has been turned by 90 degrees, perhaps by its EXIF orientation)" } else { "" },
        shown(path)
    )]
    WrongShape { noun: &'static str, found: (u32, u32), camera: (u32, u32), turned: bool, path: PathBuf },
}

/// A path for messages: it may go by a name that came out of a file.
fn shown(path: &Path) -> String {
    escaped(&path.to_string_lossy()).to_string()
}

/// Something that was tolerated: how often, and the first case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageryWarning {
    /// Images of the reconstruction without a file; `example` is the first one's name.
    Missing { noun: &'static str, count: usize, example: String },
    /// Images whose file has another path than their name; `example` is the first one's name and file.
    OtherPath { noun: &'static str, count: usize, by_stem: usize, example: (String, PathBuf) },
    /// JPEG files without their end; what is missing was decoded as plain grey.
    Truncated { count: usize, example: PathBuf },
    /// Photographs of another size than their camera's, which are taken as scaled; the first one's name and sizes.
    Scaled { count: usize, example: String, found: (u32, u32), camera: (u32, u32) },
    /// Observations of points outside their image, which are left out; `example` is the first one's image.
    OutsideImage { count: usize, example: String },
}

impl std::fmt::Display for ImageryWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ImageryWarning::Missing { noun, count, example } => {
                write!(f, "{count} images have no {noun} and add no superpixels (first: {})", escaped(example))
            }
            ImageryWarning::OtherPath { noun, count, by_stem, example: (name, path) } => write!(
                f,
                "{count} images have their {noun} by the ending of the path, {by_stem} of them by the name without its \
                 extension (first: {} is {})",
                escaped(name),
                shown(path)
            ),
            ImageryWarning::Truncated { count, example } => write!(
                f,
                "{count} photographs end before their end marker and lack a part of the picture; copy them again \
                 (first: {})",
                shown(example)
            ),
            ImageryWarning::Scaled { count, example, found, camera } => write!(
                f,
                "{count} photographs have another size than their camera and are taken as scaled (first: {}, \
                 {} x {} for {} x {})",
                escaped(example),
                found.0,
                found.1,
                camera.0,
                camera.1
            ),
            ImageryWarning::OutsideImage { count, example } => {
                write!(
                    f,
                    "{count} observations lie outside their image and are left out (first: in {})",
                    escaped(example)
                )
            }
        }
    }
}
