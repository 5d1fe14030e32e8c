//! The main job on one page: patches and planes, search, refinement, verdict.

use crate::city::CityModel;
use crate::geometry::{Start, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::reconstruction::Reconstruction;
use crate::verdict::Alignment;

/// Which way is up in the reconstruction.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Up {
    /// Estimated from walls, floors and cameras.
    #[default]
    Auto,
    /// Not used: the start's tilt is all that is known.
    None,
    /// Given, in the sfm frame (any length but zero).
    Given(Vector3<f64>),
}

/// What the user may set.
#[derive(Clone, Copy, Debug)]
pub struct AlignOptions {
    pub start: Start,
    /// Metres per sfm unit, held fixed; free where `None`.
    pub fixed_scale: Option<f64>,
    pub up: Up,
    /// Same seed, same answer, whatever the number of threads.
    pub seed: u64,
}

/// A stage of the alignment, told to whoever watches: its name and how much of it is done.
pub type Progress<'a> = &'a (dyn Fn(&'static str, usize, usize) + Sync);

/// Finds where the reconstruction stands in the city and judges it. `superpixels` are the evidence of labels or
/// photographs; without them planar clusters are taken out of the cloud itself.
pub fn align(
    city: &CityModel,
    reconstruction: &Reconstruction,
    superpixels: Option<&LiftedSuperpixels>,
    options: &AlignOptions,
    progress: Progress<'_>,
) -> Alignment {
    let _ = (city, reconstruction, superpixels, options, progress);
    unimplemented!()
}
