//! One model out of the fused photographs and points.

use super::cameras::Cameras;
use super::moved::Moved;
use super::photographs::{Keypoint, Photo};
use super::points::PointSets;
use super::rigs::colmap_parts;
use crate::geometry::Point3;
use crate::merging::ledger::{DropReason, Ledger};
use crate::reconstruction::{CameraIndex, Image, ImageIndex, Observation, PointIndex, Reconstruction};

/// The colour of points that have none.
const GREY: [u8; 3] = [128; 3];

/// The model, and for each of its points the (placed) part that it comes from.
pub(super) fn build(
    moved: &[Moved<'_>],
    cameras: &Cameras,
    sets: &PointSets<'_>,
    mut photos: Vec<Photo>,
    ledger: &mut Ledger,
) -> (Reconstruction, Vec<usize>) {
    let (roots, number_of) = surviving(moved, &photos, sets, ledger);
    let points: Vec<Point3<f64>> = roots.iter().map(|r| sets.position(*r)).collect();
    let images: Vec<Image> =
        photos.iter_mut().enumerate().map(|(n, p)| image(moved, cameras, sets, p, n, &number_of)).collect();
    let (track_starts, track_elements) = tracks(&images, points.len());
    let origins: Vec<(usize, PointIndex)> = roots.iter().map(|r| sets.part_of(*r)).collect();
    let color =
        |(part, point): &(usize, PointIndex)| moved[*part].given.colors.get(point.0 as usize).copied().unwrap_or(GREY);
    let mut sfm = Reconstruction {
        cameras: cameras.cameras.clone(),
        camera_ids: (1..=cameras.cameras.len() as u32).collect(),
        point_ids: (1..=points.len() as u64).collect(),
        colors: origins.iter().map(color).collect(),
        colmap: Some(colmap_parts(moved, cameras, &photos)),
        images,
        points,
        track_starts,
        track_elements,
        ..Reconstruction::default()
    };
    sfm.point_errors_px = errors(moved, &sfm, sets, &roots, &photos);
    let parts = origins.into_iter().map(|(part, _)| part).collect();
    (sfm, parts)
}

/// Points that are still seen (or never were), and their numbers in the result; the accounts of points and observations.
fn surviving(moved: &[Moved<'_>], photos: &[Photo], sets: &PointSets<'_>, ledger: &mut Ledger) -> (Vec<u32>, Vec<u32>) {
    let total = sets.count();
    let mut seen = vec![false; total];
    for key in photos.iter().flat_map(|p| &p.keypoints).filter_map(|k| k.key) {
        seen[sets.root(key) as usize] = true;
        ledger.observations.kept += 1;
    }
    let (mut roots, mut number_of) = (Vec::new(), vec![u32::MAX; total]);
    for key in 0..total as u32 {
        if sets.root(key) != key {
            ledger.points.fused += 1;
            continue;
        }
        let (part, point) = sets.part_of(key);
        if seen[key as usize] || moved[part].given.track(point).is_empty() {
            number_of[key as usize] = roots.len() as u32;
            roots.push(key);
        } else {
            ledger.points.drop(DropReason::NoObservationLeft, 1);
        }
    }
    ledger.points.kept = roots.len();
    (roots, number_of)
}

fn image(
    moved: &[Moved<'_>],
    cameras: &Cameras,
    sets: &PointSets<'_>,
    photo: &mut Photo,
    number: usize,
    number_of: &[u32],
) -> Image {
    let own = moved[photo.part].pose(photo.image);
    // Taken over, not copied: both forms have the same size, so that collecting takes no further memory.
    let observations = std::mem::take(&mut photo.keypoints).into_iter().map(|Keypoint { x_px, y_px, key }| {
        Observation { x_px, y_px, point: key.map(|k| PointIndex(number_of[sets.root(k) as usize])) }
    });
    Image {
        id: number as u32 + 1,
        camera: CameraIndex(cameras.index[photo.part][own.camera.0 as usize]),
        name: own.name.clone(),
        cam_from_sfm_rotation: own.cam_from_sfm_rotation,
        cam_from_sfm_translation: own.cam_from_sfm_translation,
        quaternion_wxyz: own.quaternion_wxyz,
        observations: observations.collect(),
    }
}

/// Who sees each point, by image and keypoint.
fn tracks(images: &[Image], points: usize) -> (Vec<u32>, Vec<(ImageIndex, u32)>) {
    let links = || {
        images.iter().enumerate().flat_map(|(i, image)| {
            let linked = image.observations.iter().enumerate();
            linked.filter_map(move |(k, o)| Some((o.point?, (ImageIndex(i as u32), k as u32))))
        })
    };
    let mut starts = vec![0u32; points + 1];
    links().for_each(|(point, _)| starts[point.0 as usize + 1] += 1);
    for p in 0..points {
        starts[p + 1] += starts[p];
    }
    let mut next = starts.clone();
    let mut elements = vec![(ImageIndex(0), 0); starts[points] as usize];
    for (point, element) in links() {
        let place = &mut next[point.0 as usize];
        elements[*place as usize] = element;
        *place += 1;
    }
    (starts, elements)
}

/// Mean reprojection errors: as they were, except of points that were fused or are seen in a fused photograph.
fn errors(
    moved: &[Moved<'_>],
    sfm: &Reconstruction,
    sets: &PointSets<'_>,
    roots: &[u32],
    photos: &[Photo],
) -> Vec<f64> {
    let error = |(number, root): (usize, &u32)| {
        let (part, point) = sets.part_of(*root);
        let track = sfm.track(PointIndex(number as u32));
        let is_touched = sets.is_joined(*root) || track.iter().any(|(image, _)| photos[image.0 as usize].is_fused);
        match moved[part].given.point_errors_px.get(point.0 as usize) {
            Some(error) if !is_touched => *error,
            _ => mean_error(sfm, number, track),
        }
    };
    roots.iter().enumerate().map(error).collect()
}

fn mean_error(sfm: &Reconstruction, number: usize, track: &[(ImageIndex, u32)]) -> f64 {
    let offsets = track.iter().filter_map(|(index, keypoint)| {
        let image = &sfm.images[index.0 as usize];
        let o = &image.observations[*keypoint as usize];
        let [x, y] = sfm.camera_of(*index).project(&image.cam_from_sfm(&sfm.points[number]))?;
        Some((x - o.x_px).hypot(y - o.y_px))
    });
    let (sum, count) = offsets.fold((0.0, 0usize), |(sum, count), off| (sum + off, count + 1));
    if count == 0 { -1.0 } else { sum / count as f64 }
}
