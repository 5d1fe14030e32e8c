//! A minimal sample, while it is drawn and when it is complete.

use super::belief::ScaleTranslationEstimate;
use super::level_cloud::LevelCloud;
use super::weighted_choice::Drawn;
use crate::geometry::{Plane, Vector3};
use crate::planes::PlaneId;
use crate::solvers::Row;

/// A patch on a plane of the city.
#[derive(Clone, Copy, Debug)]
pub struct PatchPlanePair {
    pub patch: u32,
    pub plane: PlaneId,
    /// The plane as the patch sees it: its normal on the patch's side.
    pub target: Plane,
    /// The patch's normal in the level frame, on the side from which it is meant.
    pub normal: Vector3<f64>,
}

/// A minimal sample: pairs, and what completes them where they leave a direction open.
#[derive(Clone, Debug)]
pub struct MinimalSample {
    pub pairs: Vec<PatchPlanePair>,
    /// Rows for what the pairs leave open (a height that no floor fixes), drawn from what the start says of it.
    pub completion: Vec<Row>,
    /// The chance that all of it is right, as far as its patches lie on the city at all.
    pub chance: f64,
}

/// A sample on its way.
pub(super) struct Draft {
    pub belief: ScaleTranslationEstimate,
    pub pairs: Vec<PatchPlanePair>,
    pub chance: f64,
}

impl Draft {
    pub fn new(belief: ScaleTranslationEstimate) -> Draft {
        Draft { belief, pairs: Vec::with_capacity(4), chance: 1.0 }
    }

    pub fn take(&mut self, level_cloud: &LevelCloud, drawn: Drawn<PatchPlanePair>) {
        self.belief.learn(&level_cloud.patches[drawn.what.patch as usize].center, &drawn.what.target);
        self.chance *= drawn.chance;
        self.pairs.push(drawn.what);
    }
}
