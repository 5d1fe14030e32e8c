//! From Bundler's records to a reconstruction: the camera looks along -z with y up, pixels count from the middle of the picture, up.

use std::path::{Path, PathBuf};

use super::picture_sizes::{size_of_photograph, sizes_by_halves, warn_of_guess};
use super::posed::{Posed, PosedImage, PosedPoint, color, rotation, usable, warn};
use super::{Reconstruction, ReconstructionError, ReconstructionWarning, SfmFormat, WarningKind};
use crate::format::bundler::{BundlerCamera, BundlerModel, read_bundler, read_bundler_list};
use crate::format::file::is_there;
use crate::geometry::{Camera, CameraModel, Matrix3, Rotation3, Vector3};

/// The names under which lists of photographs lie beside a `bundle.out`, or in the folder above it.
const LISTS: [&str; 4] = ["list.txt", "bundle.out.list.txt", "list.rd.out.list.txt", "image_list.txt"];

/// A `bundle.out` with the list of photographs that lies beside it or above it.
pub(super) fn read(path: &Path) -> Result<Reconstruction, ReconstructionError> {
    let model = read_bundler(path)?;
    let list = list_of(path);
    let names = match &list {
        Some(list) => read_bundler_list(list)?,
        None => Vec::new(),
    };
    if let Some(list) = list.as_ref().filter(|_| names.len() != model.cameras.len()) {
        return Err(ReconstructionError::Inconsistent {
            path: list.clone(),
            object: "list of photographs".into(),
            expected: format!("{} names, as many as {} has cameras", model.cameras.len(), path.display()),
            got: names.len().to_string(),
        });
    }
    let folder = list.as_deref().unwrap_or(path).parent().unwrap_or(Path::new(""));
    reconstruction(path, folder, &model, &names)
}

fn list_of(path: &Path) -> Option<PathBuf> {
    let own = PathBuf::from(format!("{}.list.txt", path.display()));
    let folder = path.parent()?;
    let places = [Some(folder), folder.parent()].into_iter().flatten();
    let known = places.flat_map(|folder| LISTS.iter().map(|name| folder.join(name)));
    std::iter::once(own).chain(known).find(|path| is_there(path))
}

fn reconstruction(
    path: &Path,
    folder: &Path,
    model: &BundlerModel,
    names: &[String],
) -> Result<Reconstruction, ReconstructionError> {
    let mut posed = Posed::default();
    let mut warnings = Vec::new();
    let sizes = sizes(folder, model, names, &mut warnings);
    let mut image_of_camera = Vec::new();
    for (number, record) in model.cameras.iter().enumerate() {
        let name = name_of(names, number);
        if record.focal_px == 0.0 {
            warn(&mut warnings, WarningKind::ImagesWithoutPose, || name);
            image_of_camera.push(None);
            continue;
        }
        let Some(camera) = sizes[number].and_then(|size| camera(record, size)) else {
            warn(&mut warnings, WarningKind::CamerasNotHeld, || format!("{name}, focal length {}", record.focal_px));
            image_of_camera.push(None);
            continue;
        };
        let r = record.rotation;
        let camera = posed.camera(camera);
        // Half a turn about x leads from y up, z back to y down, z ahead.
        let half_turn = Rotation3::from_matrix_unchecked(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)));
        let image = rotation(&[[r[0], r[1], r[2]], [r[3], r[4], r[5]], [r[6], r[7], r[8]]]).map(|turn| PosedImage {
            name,
            camera,
            cam_from_sfm_rotation: half_turn * turn,
            cam_from_sfm_translation: half_turn * Vector3::from(record.translation),
        });
        let image = image.filter(PosedImage::is_placed).ok_or_else(|| ReconstructionError::Inconsistent {
            path: path.into(),
            object: format!("camera {number}"),
            expected: "a rotation matrix and a finite translation".into(),
            got: format!("{:?} and {:?}", record.rotation, record.translation),
        })?;
        image_of_camera.push(Some(posed.images.len()));
        posed.images.push(image);
    }
    for point in &model.points {
        let track = point.views.iter().filter_map(|(camera, [x, y])| {
            let (width, height) = sizes[*camera]?;
            Some((image_of_camera[*camera]?, [0.5 * width as f64 + x, 0.5 * height as f64 - y]))
        });
        posed.points.push(PosedPoint { position: point.position, color: color(point.color), track: track.collect() });
    }
    Ok(posed.into_reconstruction(SfmFormat::Bundler, warnings))
}

fn name_of(names: &[String], number: usize) -> String {
    match names.get(number) {
        Some(name) => name.strip_prefix("./").unwrap_or(name).to_owned(),
        None => format!("camera_{number:05}"),
    }
}

/// The size of each picture, as far as anything tells: a point appears half the size from the middle at most.
fn sizes(
    folder: &Path,
    model: &BundlerModel,
    names: &[String],
    warnings: &mut Vec<ReconstructionWarning>,
) -> Vec<Option<(u64, u64)>> {
    let mut reach = vec![None; model.cameras.len()];
    for (camera, [x, y]) in model.points.iter().flat_map(|point| &point.views) {
        let far: &mut [f64; 2] = reach[*camera].get_or_insert([0.0; 2]);
        (far[0], far[1]) = (far[0].max(x.abs()), far[1].max(y.abs()));
    }
    let estimated = sizes_by_halves(&reach);
    let size = |number: usize| {
        let told = names.get(number).and_then(|name| size_of_photograph(folder, name));
        told.or_else(|| {
            let size = estimated.as_ref().map(|sizes| sizes[number])?;
            warn_of_guess(warnings, &name_of(names, number), size);
            Some(size)
        })
    };
    (0..model.cameras.len()).map(size).collect()
}

fn camera(record: &BundlerCamera, (width_px, height_px): (u64, u64)) -> Option<Camera> {
    let [k1, k2] = record.radial;
    let params = vec![record.focal_px, 0.5 * width_px as f64, 0.5 * height_px as f64, k1, k2];
    usable(Camera { model: CameraModel::Radial, width_px, height_px, params })
}
