//! What was read can be written, and is the same when it is read again.

use std::path::Path;

use cityweld::types::ExportError;
use cityweld::{Reconstruction, read_reconstruction, write_colmap, write_ply};

/// Writes the points as PLY, and the whole as COLMAP where it came as that.
pub fn check(sfm: &Reconstruction, folder: &Path) -> Result<(), String> {
    // Poses alone are read of some formats, and no format of points holds none.
    if sfm.points.is_empty() {
        return Ok(());
    }
    let path = folder.join("again.ply");
    if was_written(write_ply(&path, sfm))? {
        check_points(sfm, &again(&path)?)?;
    }
    let model = folder.join("again");
    // What an earlier case has left there would be taken for a part of this one.
    if model.exists() {
        std::fs::remove_dir_all(&model).map_err(|error| error.to_string())?;
    }
    if sfm.colmap.is_some() && was_written(write_colmap(&model, sfm))? {
        let read = again(&model)?;
        check_points(sfm, &read)?;
        check_model(sfm, &read)?;
    }
    Ok(())
}

/// A model that cannot be held by the other format is refused, and that is right.
fn was_written(result: Result<(), ExportError>) -> Result<bool, String> {
    match result {
        Ok(()) => Ok(true),
        Err(ExportError::Unfit { .. }) => Ok(false),
        Err(error) => Err(format!("cannot be written: {error}")),
    }
}

fn again(path: &Path) -> Result<Reconstruction, String> {
    read_reconstruction(path).map_err(|error| format!("what was written cannot be read: {error}"))
}

fn check_points(sfm: &Reconstruction, read: &Reconstruction) -> Result<(), String> {
    same("points", &sfm.points, &read.points)?;
    same("colours", &sfm.colors, &read.colors)
}

fn check_model(sfm: &Reconstruction, read: &Reconstruction) -> Result<(), String> {
    same("ids of points", &sfm.point_ids, &read.point_ids)?;
    same("errors", &sfm.point_errors_px, &read.point_errors_px)?;
    same("cameras", &sfm.cameras, &read.cameras)?;
    same("ids of cameras", &sfm.camera_ids, &read.camera_ids)?;
    same("tracks", &sfm.track_elements, &read.track_elements)?;
    same("images", &images(sfm), &images(read))
}

/// Images without what nalgebra's rotations round.
fn images(sfm: &Reconstruction) -> Vec<impl PartialEq + std::fmt::Debug + '_> {
    let key = |image: &cityweld::Image| image.cam_from_sfm_translation;
    sfm.images.iter().map(|image| (image.id, image.camera, &image.name, key(image), &image.observations)).collect()
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, one: &[T], other: &[T]) -> Result<(), String> {
    if one.len() != other.len() {
        return Err(format!("{what}: {} were written, {} read", one.len(), other.len()));
    }
    match one.iter().zip(other).find(|(one, other)| one != other) {
        Some((one, other)) => Err(format!("{what}: {one:?} was written, {other:?} read")),
        None => Ok(()),
    }
}
