//! A part in the merged frame, without a copy of what no frame changes.

use crate::geometry::{Point3, Similarity};
use crate::reconstruction::{Image, ImageIndex, Observation, PointIndex, Reconstruction};

/// A part in the merged frame.
pub(super) struct Moved<'a> {
    /// The part as it was given: keypoints and tracks are taken from here, since no frame changes them.
    pub given: &'a Reconstruction,
    /// Its points and poses where they belong.
    pub posed: Reconstruction,
}

impl Moved<'_> {
    pub fn of<'a>(given: &'a Reconstruction, merged_from_part: Option<&Similarity>) -> Moved<'a> {
        let mut posed = given.skeleton();
        if let Some(place) = merged_from_part {
            posed.transform(place);
        }
        Moved { given, posed }
    }

    pub fn point(&self, point: PointIndex) -> Point3<f64> {
        self.posed.points[point.0 as usize]
    }

    pub fn pose(&self, image: ImageIndex) -> &Image {
        &self.posed.images[image.0 as usize]
    }

    pub fn keypoints(&self, image: ImageIndex) -> &[Observation] {
        &self.given.images[image.0 as usize].observations
    }
}
