//! Photographs, label images and superpixels; which points of a reconstruction fall on which superpixel.

use crate::reconstruction::{ImageIndex, PointIndex};

/// One superpixel of one image with the points whose observations fall on it.
#[derive(Clone, Debug)]
pub struct Superpixel {
    pub image: ImageIndex,
    pub label: u32,
    /// Sorted, unique.
    pub points: Vec<PointIndex>,
}

/// All superpixels that points fall on.
#[derive(Clone, Debug, Default)]
pub struct LiftedSuperpixels {
    pub superpixels: Vec<Superpixel>,
}
