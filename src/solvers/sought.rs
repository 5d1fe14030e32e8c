//! What is unknown of a pose.

use super::up::Up;

/// What is unknown of the pose.
#[derive(Clone, Copy, Debug)]
pub enum Sought {
    /// Rotation and translation: 6 rows.
    Rigid,
    /// Rotation, translation and scale: 7 rows.
    Similarity,
    /// Heading and translation: 4 rows.
    UprightRigid(Up),
    /// Heading, translation and scale: 5 rows.
    UprightSimilarity(Up),
}

impl Sought {
    /// Unknowns of the pose: rows of a minimal sample.
    pub fn unknowns(&self) -> usize {
        match self {
            Sought::Rigid => 6,
            Sought::Similarity => 7,
            Sought::UprightRigid(_) => 4,
            Sought::UprightSimilarity(_) => 5,
        }
    }

    /// What a result calls it.
    pub fn name(&self) -> &'static str {
        match self {
            Sought::Rigid => "rigid",
            Sought::Similarity => "similarity",
            Sought::UprightRigid(_) => "upright rigid",
            Sought::UprightSimilarity(_) => "upright similarity",
        }
    }

    /// Whether the scale is sought too.
    pub fn is_similarity(&self) -> bool {
        matches!(self, Sought::Similarity | Sought::UprightSimilarity(_))
    }

    /// The vertical, where it is known.
    pub(super) fn up(&self) -> Option<&Up> {
        match self {
            Sought::Rigid | Sought::Similarity => None,
            Sought::UprightRigid(up) | Sought::UprightSimilarity(up) => Some(up),
        }
    }
}
