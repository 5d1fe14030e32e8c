//! Tracks: ids become indices, and tracks and images are held against each other.

use rayon::prelude::*;

use super::checker::Checker;
use super::ids::IdIndex;
use super::{Image, ImageIndex, PointIndex, WarningKind};
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

/// Tracks over images that are there.
pub(super) struct Tracks {
    pub starts: Vec<u32>,
    pub elements: Vec<(ImageIndex, u32)>,
}

/// Stands for an image that is not in the model.
const NO_IMAGE: ImageIndex = ImageIndex(u32::MAX);

/// The track elements with indices for ids, without those that nobody could have seen: of images that are not in the model, and
/// those that the images' keypoints deny. `links` are those that the images tell.
pub(super) fn tracks(
    check: &mut Checker,
    points: &PointRecords,
    image_index: &IdIndex,
    images: &[Image],
    links: Links,
) -> Tracks {
    let counts: Vec<usize> = images.iter().map(|image| image.observations.len()).collect();
    let starts: Vec<usize> = (0..points.track_elements.len()).step_by(ELEMENTS_AT_ONCE).collect();
    let pieces: Vec<_> = starts.into_par_iter().map(|start| piece(start, points, image_index, &counts)).collect();
    let mut elements = Vec::with_capacity(points.track_elements.len());
    let mut links_of_tracks = Links::default();
    for (piece, links) in pieces {
        elements.extend(piece);
        links_of_tracks.join(links);
    }
    if links_of_tracks == links && links.count == elements.len() {
        return Tracks { starts: points.track_starts.clone(), elements };
    }
    confirmed(check, points, &elements, images, links.count)
}

/// Some elements, and the links of those that name keypoints that are there.
fn piece(
    start: usize,
    points: &PointRecords,
    image_index: &IdIndex,
    counts: &[usize],
) -> (Vec<(ImageIndex, u32)>, Links) {
    let end = (start + ELEMENTS_AT_ONCE).min(points.track_elements.len());
    let mut point = point_of(points, start);
    let mut elements = Vec::with_capacity(end - start);
    let mut links = Links::default();
    for element in start..end {
        while points.track_starts[point + 1] as usize <= element {
            point += 1;
        }
        let (image_id, keypoint) = points.track_elements[element];
        let image = image_index.get(image_id.into()).map_or(NO_IMAGE, ImageIndex);
        if counts.get(image.0 as usize).is_some_and(|count| (keypoint as usize) < *count) {
            links.add(image, keypoint, PointIndex(point as u32));
        }
        elements.push((image, keypoint));
    }
    (elements, links)
}

/// The point that a track element belongs to.
fn point_of(points: &PointRecords, element: usize) -> usize {
    points.track_starts.partition_point(|start| *start as usize <= element) - 1
}

/// The elements that the keypoints confirm; the others, and the links that only the images tell, are counted.
fn confirmed(
    check: &mut Checker,
    points: &PointRecords,
    elements: &[(ImageIndex, u32)],
    images: &[Image],
    links_of_images: usize,
) -> Tracks {
    let mut kept = Tracks { starts: Vec::with_capacity(points.ids.len() + 1), elements: Vec::new() };
    kept.starts.push(0);
    let mut denied = 0;
    let mut example = None;
    for (point, ends) in points.track_starts.windows(2).enumerate() {
        let (first, end) = (ends[0] as usize, ends[1] as usize);
        for (element, &(image, keypoint)) in (first..end).zip(&elements[first..end]) {
            let Some(seen_by) = images.get(image.0 as usize) else {
                let id = points.track_elements[element].0;
                check.warn(WarningKind::TracksOfMissingImages, 1, || {
                    format!("image {id} in the track of point {}", points.ids[point])
                });
                continue;
            };
            let observation = seen_by.observations.get(keypoint as usize);
            if observation.and_then(|o| o.point) == Some(PointIndex(point as u32)) {
                kept.elements.push((image, keypoint));
            } else {
                denied += 1;
                example.get_or_insert_with(|| {
                    format!("keypoint {keypoint} of image {} in the track of point {}", seen_by.id, points.ids[point])
                });
            }
        }
        kept.starts.push(kept.elements.len() as u32);
    }
    let count = denied + links_of_images.saturating_sub(kept.elements.len());
    check.warn(WarningKind::TracksThatImagesContradict, count, || {
        example.unwrap_or_else(|| "keypoints whose points' tracks lack them".to_string())
    });
    kept
}

#[cfg(test)]
mod tests;
