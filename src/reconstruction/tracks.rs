//! Tracks: ids become indices, and tracks and images are held against each other.

use rayon::prelude::*;

use super::checker::Checker;
use super::ids::IdIndex;
use super::{Image, ImageIndex, PointIndex, ReconstructionError, WarningKind};
use crate::format::colmap::PointRecords;

/// Track elements checked at once; any number gives the same result.
const ELEMENTS_AT_ONCE: usize = 1 << 16;

/// Sum over (image, keypoint, point) links. Images and tracks tell the same links, each in its own order: equal sums
/// spare looking up every element, which would be most of the time that reading takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Links {
    count: usize,
    sum: u64,
}

impl Links {
    pub(super) fn add(&mut self, image: ImageIndex, keypoint: u32, point: PointIndex) {
        // Odd constants of which half the bits are set, and shifts that bring high bits down, as in xorshift-multiply
        // mixers (Steele et al. 2014).
        let place = u64::from(image.0) << 32 | u64::from(keypoint);
        let mixed =
            (place ^ u64::from(point.0).wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 29).wrapping_mul(0x94D0_49BB_1331_11EB);
        self.join(Links { count: 1, sum: mixed ^ mixed >> 32 });
    }

    pub(super) fn join(&mut self, other: Links) {
        self.count += other.count;
        self.sum = self.sum.wrapping_add(other.sum);
    }
}

/// The track elements with indices for ids. `links` are those that the images tell.
pub(super) fn tracks(
    check: &mut Checker,
    points: &PointRecords,
    image_index: &IdIndex,
    images: &[Image],
    links: Links,
) -> Result<Vec<(ImageIndex, u32)>, ReconstructionError> {
    let counts: Vec<usize> = images.iter().map(|image| image.observations.len()).collect();
    let starts: Vec<usize> = (0..points.track_elements.len()).step_by(ELEMENTS_AT_ONCE).collect();
    let pieces: Vec<_> = starts.into_par_iter().map(|start| piece(start, points, image_index, &counts)).collect();
    let mut elements = Vec::with_capacity(points.track_elements.len());
    let mut links_of_tracks = Links::default();
    for piece in pieces {
        let (piece, links) = piece.map_err(|element| out_of_range(check, element, points, image_index, &counts))?;
        elements.extend(piece);
        links_of_tracks.join(links);
    }
    if links_of_tracks != links {
        warn_of_contradictions(check, points, &elements, images, links.count);
    }
    Ok(elements)
}

/// Some elements and their links, or the first that names what is not there.
fn piece(
    start: usize,
    points: &PointRecords,
    image_index: &IdIndex,
    counts: &[usize],
) -> Result<(Vec<(ImageIndex, u32)>, Links), usize> {
    let end = (start + ELEMENTS_AT_ONCE).min(points.track_elements.len());
    let mut point = point_of(points, start);
    let mut elements = Vec::with_capacity(end - start);
    let mut links = Links::default();
    for element in start..end {
        while points.track_starts[point + 1] as usize <= element {
            point += 1;
        }
        let (image_id, keypoint) = points.track_elements[element];
        let image = image_index.get(image_id.into()).ok_or(element)?;
        if keypoint as usize >= counts[image as usize] {
            return Err(element);
        }
        links.add(ImageIndex(image), keypoint, PointIndex(point as u32));
        elements.push((ImageIndex(image), keypoint));
    }
    Ok((elements, links))
}

/// The point that a track element belongs to.
fn point_of(points: &PointRecords, element: usize) -> usize {
    points.track_starts.partition_point(|start| *start as usize <= element) - 1
}

fn out_of_range(
    check: &Checker,
    element: usize,
    points: &PointRecords,
    image_index: &IdIndex,
    counts: &[usize],
) -> ReconstructionError {
    let (image_id, keypoint) = points.track_elements[element];
    let object = format!("track of point {}", points.ids[point_of(points, element)]);
    match image_index.get(image_id.into()) {
        None => check.fault("points3D", object, "images of the model", format!("image {image_id}")),
        Some(image) => {
            let expected = format!("one of the {} keypoints of image {image_id}", counts[image as usize]);
            check.fault("points3D", object, &expected, format!("keypoint {keypoint}"))
        }
    }
}

/// Counts the links that only the tracks or only the images tell.
fn warn_of_contradictions(
    check: &mut Checker,
    points: &PointRecords,
    elements: &[(ImageIndex, u32)],
    images: &[Image],
    links_of_images: usize,
) {
    let mut agreed = 0;
    let mut example = None;
    for (point, ends) in points.track_starts.windows(2).enumerate() {
        for (image, keypoint) in &elements[ends[0] as usize..ends[1] as usize] {
            let image = &images[image.0 as usize];
            if image.observations[*keypoint as usize].point == Some(PointIndex(point as u32)) {
                agreed += 1;
            } else {
                example.get_or_insert_with(|| {
                    format!("keypoint {keypoint} of image {} in the track of point {}", image.id, points.ids[point])
                });
            }
        }
    }
    let count = elements.len() - agreed + links_of_images.saturating_sub(agreed);
    check.warn(WarningKind::TracksThatImagesContradict, count, || {
        example.unwrap_or_else(|| "keypoints whose points' tracks lack them".to_string())
    });
}

#[cfg(test)]
mod tests;
