//! Carries superpixels over to the points of a reconstruction.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::folder::{find_pictures, looked_for};
use super::labels::{decode_labels, open_labels};
use super::memory::Budget;
use super::photos::{decode_photo, open_photo};
use super::size;
use super::superpixels::{SuperpixelOptions, cut_superpixels};
use super::{ImageryError, ImageryWarning, LabelMap, SuperpixelSource};
use crate::observer::{Observer, Stage, check_cancelled};
use crate::reconstruction::{Image, ImageIndex, NameMatch, PointIndex, Reconstruction};

/// One superpixel of one image with the points whose observations fall on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Superpixel {
    pub image: ImageIndex,
    pub label: u32,
    /// Sorted, each once, at least one.
    pub points: Vec<PointIndex>,
}

/// What the superpixels of all images hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LiftedSuperpixels {
    /// By image, then by label; those without points are left out.
    pub superpixels: Vec<Superpixel>,
    pub warnings: Vec<ImageryWarning>,
    /// Images whose file was read.
    pub images_read: usize,
    /// Images with observed points for which no file was found.
    pub images_missing: usize,
}

/// Memory for pictures that are decoded at once. Chosen: nine photographs of 12 megapixels. One that asks for more is decoded
/// while no other is.
const DECODING_LIMIT_BYTES: u64 = 1 << 30;

/// Finds, for every superpixel of every image, the points that are seen on it. The observer is told of images.
/// Images that see no point are not looked for.
pub fn lift_superpixels(
    reconstruction: &Reconstruction,
    source: &SuperpixelSource,
    options: &SuperpixelOptions,
    observer: &dyn Observer,
) -> Result<LiftedSuperpixels, ImageryError> {
    lift_superpixels_of(reconstruction, &|_| true, source, options, observer)
}

/// [`lift_superpixels`] of those images alone that are `wanted`; the others are taken as if they were not there.
pub fn lift_superpixels_of(
    reconstruction: &Reconstruction,
    wanted: &dyn Fn(&Image) -> bool,
    source: &SuperpixelSource,
    options: &SuperpixelOptions,
    observer: &dyn Observer,
) -> Result<LiftedSuperpixels, ImageryError> {
    let files = find_files(reconstruction, wanted, source)?;
    let done = AtomicUsize::new(0);
    let memory = Budget::new(DECODING_LIMIT_BYTES);
    // Every image has its slot, so that neither the result nor the error that is told depends on the threads; a thread
    // holds one picture at a time.
    let lifted: Vec<Result<LiftedImage, ImageryError>> = files
        .found
        .par_iter()
        .map(|(index, path)| {
            check_cancelled(observer)?;
            let lifted = lift_image(reconstruction, *index, path, source, options, &memory);
            observer.progress(Stage::Superpixels, done.fetch_add(1, Ordering::Relaxed) + 1, files.found.len());
            lifted
        })
        .collect();
    let lifted = lifted.into_iter().collect::<Result<Vec<_>, _>>()?;
    let warnings = gather_warnings(reconstruction, source, &files, &lifted);
    Ok(LiftedSuperpixels {
        images_read: files.found.len(),
        images_missing: files.missing.len(),
        superpixels: lifted.into_iter().flat_map(|image| image.superpixels).collect(),
        warnings,
    })
}

#[derive(Default)]
struct Files {
    found: Vec<(ImageIndex, PathBuf)>,
    /// Those of `found` that have another path than their image's name.
    elsewhere: Vec<(usize, NameMatch)>,
    missing: Vec<ImageIndex>,
}

fn find_files(
    reconstruction: &Reconstruction,
    wanted: &dyn Fn(&Image) -> bool,
    source: &SuperpixelSource,
) -> Result<Files, ImageryError> {
    let (noun, folder) = (source.noun(), source.folder());
    if let Err(error) = std::fs::read_dir(folder) {
        return Err(ImageryError::Folder { noun, folder: folder.to_path_buf(), reason: error.to_string() });
    }
    let mut files = Files::default();
    let is_sought = |image: &Image| wanted(image) && image.observations.iter().any(|seen| seen.point.is_some());
    let sought: Vec<(ImageIndex, &str)> = (0..)
        .zip(&reconstruction.images)
        .filter(|(_, image)| is_sought(image))
        .map(|(index, image)| (ImageIndex(index), image.name.as_str()))
        .collect();
    let names: Vec<&str> = sought.iter().map(|(_, name)| *name).collect();
    for ((index, _), found) in sought.iter().zip(find_pictures(source, &names)?) {
        match found {
            Some((path, how)) => {
                if how != NameMatch::Path {
                    files.elsewhere.push((files.found.len(), how));
                }
                files.found.push((*index, path));
            }
            None => files.missing.push(*index),
        }
    }
    match files.missing.first() {
        _ if !files.found.is_empty() => Ok(files),
        Some(first) => Err(ImageryError::NothingFound {
            noun,
            images: files.missing.len(),
            example: looked_for(source, &reconstruction.images[first.0 as usize].name),
            folder: folder.to_path_buf(),
        }),
        None => Err(ImageryError::NoImages { noun, folder: folder.to_path_buf() }),
    }
}

struct LiftedImage {
    index: ImageIndex,
    superpixels: Vec<Superpixel>,
    truncated: Option<PathBuf>,
    /// Size of the photograph and of its camera, where they differ.
    scaled: Option<((u32, u32), (u32, u32))>,
    observations_outside: usize,
}

fn lift_image(
    reconstruction: &Reconstruction,
    index: ImageIndex,
    path: &Path,
    source: &SuperpixelSource,
    options: &SuperpixelOptions,
    memory: &Budget,
) -> Result<LiftedImage, ImageryError> {
    let image = &reconstruction.images[index.0 as usize];
    let camera = reconstruction.cameras.get(image.camera.0 as usize).and_then(size::of_camera);
    let picture = match source {
        SuperpixelSource::Labels(_) => open_labels(path, camera)?,
        SuperpixelSource::Photos(_) => open_photo(path, camera)?,
    };
    let (found, image_size) = (picture.size, picture.image_size);
    let _share = memory.take(picture.decoding_bytes());
    let (map, truncated, scaled) = match source {
        // Labels of another size are the rule for segmenters, so that is nothing to warn of.
        SuperpixelSource::Labels(_) => (decode_labels(picture)?, false, None),
        SuperpixelSource::Photos(_) => {
            let photo = decode_photo(picture)?;
            let scaled = (found != image_size).then_some((found, image_size));
            let keypoints = if options.by_keypoints { keypoints_in(image, image_size, found) } else { Vec::new() };
            (cut_superpixels(&photo.pixels, &keypoints, options), photo.truncated, scaled)
        }
    };
    let (superpixels, observations_outside) = points_on_labels(index, image, &map, image_size);
    let truncated = truncated.then(|| path.to_path_buf());
    Ok(LiftedImage { index, superpixels, truncated, scaled, observations_outside })
}

/// The observations that have points, scaled from the image of `image_size` to a picture of `size`.
fn keypoints_in(image: &Image, image_size: (u32, u32), size: (u32, u32)) -> Vec<(f64, f64)> {
    let (across, down) = (f64::from(size.0) / f64::from(image_size.0), f64::from(size.1) / f64::from(image_size.1));
    let observed = image.observations.iter().filter(|observation| observation.point.is_some());
    observed.map(|observation| (observation.x_px * across, observation.y_px * down)).collect()
}

/// The superpixels that hold points, by label, and the number of observations outside the image.
fn points_on_labels(
    index: ImageIndex,
    image: &Image,
    map: &LabelMap,
    image_size: (u32, u32),
) -> (Vec<Superpixel>, usize) {
    let mut points_of_label: BTreeMap<u32, Vec<PointIndex>> = BTreeMap::new();
    let mut outside = 0;
    for observation in &image.observations {
        let Some(point) = observation.point else { continue };
        match map.label_at(observation.x_px, observation.y_px, image_size) {
            None => outside += 1,
            Some(0) => {}
            Some(label) => points_of_label.entry(label).or_default().push(point),
        }
    }
    let superpixels = points_of_label.into_iter().map(|(label, mut points)| {
        points.sort_unstable();
        points.dedup();
        Superpixel { image: index, label, points }
    });
    (superpixels.collect(), outside)
}

fn gather_warnings(
    reconstruction: &Reconstruction,
    source: &SuperpixelSource,
    files: &Files,
    lifted: &[LiftedImage],
) -> Vec<ImageryWarning> {
    let name = |index: ImageIndex| reconstruction.images[index.0 as usize].name.clone();
    let mut warnings = Vec::new();
    if let Some(&first) = files.missing.first() {
        let (noun, count) = (source.noun(), files.missing.len());
        warnings.push(ImageryWarning::Missing { noun, count, example: name(first) });
    }
    if let Some((first, _)) = files.elsewhere.first() {
        let (index, path) = &files.found[*first];
        let (noun, count) = (source.noun(), files.elsewhere.len());
        let by_stem = files.elsewhere.iter().filter(|(_, how)| *how == NameMatch::Stem).count();
        warnings.push(ImageryWarning::OtherPath { noun, count, by_stem, example: (name(*index), path.clone()) });
    }
    let truncated: Vec<&PathBuf> = lifted.iter().filter_map(|image| image.truncated.as_ref()).collect();
    if let Some(&first) = truncated.first() {
        warnings.push(ImageryWarning::Truncated { count: truncated.len(), example: first.clone() });
    }
    if let Some((first, (found, camera))) = lifted.iter().find_map(|image| Some((image.index, image.scaled?))) {
        let count = lifted.iter().filter(|image| image.scaled.is_some()).count();
        warnings.push(ImageryWarning::Scaled { count, example: name(first), found, camera });
    }
    if let Some(first) = lifted.iter().find(|image| image.observations_outside > 0) {
        let count = lifted.iter().map(|image| image.observations_outside).sum();
        warnings.push(ImageryWarning::OutsideImage { count, example: name(first.index) });
    }
    warnings
}

#[cfg(test)]
mod tests;
