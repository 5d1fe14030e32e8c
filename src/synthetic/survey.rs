//! A made-up reconstruction and the truth about it.

use crate::geometry::{Rotation3, Similarity, Vector3};
use crate::reconstruction::Reconstruction;

/// What a structure-from-motion tool would have left, and what only the maker knows.
#[derive(Clone, Debug)]
pub struct Survey {
    pub sfm: Reconstruction,
    /// Exact.
    pub city_from_sfm: Similarity,
    /// The face that each point lies on (its number in [`super::Block::faces`]; the ground's where the ground is not
    /// modelled, too), `None` for what is no part of the city.
    pub face_of_point: Vec<Option<usize>>,
}

/// A frame like any that structure from motion ends in: turned, about 8 m to its unit, its origin somewhere.
pub fn sfm_from_city() -> Similarity {
    Similarity {
        scale: 0.13,
        rotation: Rotation3::from_euler_angles(1.1, -0.4, 2.2),
        translation: Vector3::new(4.0, -2.0, 9.0),
    }
}
