//! What is asked of a part again and again, made once for all pairs that it is in.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::extent::Extent;
use super::limits::MergeLimits;
use super::part::Part;
use super::point_covariance::{KnownPoint, covariance};
use super::surfaces::Surfaces;
use crate::reconstruction::{ImageIndex, PointIndex, Reconstruction};

/// A part with its extent, its superpixels by photograph and, once they are asked for, its surfaces.
pub(super) struct PreparedPart<'a> {
    pub part: &'a Part,
    pub extent: Extent,
    superpixels: Option<BTreeMap<(ImageIndex, u32), &'a [PointIndex]>>,
    surfaces: OnceLock<Option<Surfaces>>,
    limits: &'a MergeLimits,
}

impl<'a> PreparedPart<'a> {
    pub fn of(part: &'a Part, limits: &'a MergeLimits) -> PreparedPart<'a> {
        let superpixels = part.superpixels.as_ref().map(|lifted| {
            lifted.superpixels.iter().map(|s| ((s.image, s.label), s.points.as_slice())).collect::<BTreeMap<_, _>>()
        });
        PreparedPart { part, extent: Extent::of(&part.sfm.points), superpixels, surfaces: OnceLock::new(), limits }
    }

    pub fn sfm(&self) -> &'a Reconstruction {
        &self.part.sfm
    }

    pub fn name(&self) -> &'a str {
        &self.part.name
    }

    pub fn known_point(&self, point: PointIndex) -> KnownPoint {
        let (sfm, radius) = (self.sfm(), self.extent.radius);
        let covariance = covariance(sfm, sfm.track(point), point, radius, &self.limits.keypoints);
        KnownPoint { at: sfm.points[point.0 as usize], covariance }
    }

    pub fn has_superpixels(&self) -> bool {
        self.superpixels.is_some()
    }

    /// Label and points of every superpixel of a photograph, by label.
    pub fn superpixels_of(&self, image: ImageIndex) -> impl Iterator<Item = (u32, &'a [PointIndex])> + '_ {
        let all = self.superpixels.iter().flat_map(move |map| map.range((image, 0)..=(image, u32::MAX)));
        all.map(|((_, label), points)| (*label, *points))
    }

    pub fn superpixel(&self, image: ImageIndex, label: u32) -> Option<&'a [PointIndex]> {
        self.superpixels.as_ref()?.get(&(image, label)).copied()
    }

    /// `None` where nothing of the part is planar. Whoever asks from several threads at once must have asked here before: what makes them
    /// works in parallel itself.
    pub fn surfaces(&self) -> Option<&Surfaces> {
        let make = || Surfaces::of(self.part, |point| self.known_point(point), &self.limits.patches);
        self.surfaces.get_or_init(make).as_ref()
    }
}
