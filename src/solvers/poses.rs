//! The answer of a minimal solver: at most eight poses, without heap.

use crate::geometry::{Matrix3, Rotation3, Similarity, Vector3};

use super::algebra::common_points::MOST_POINTS;

/// No minimal problem here has more solutions than three quadrics have common points.
pub const MOST_POSES: usize = MOST_POINTS;

/// `object_from_sensor` poses of one minimal sample. An empty list is an answer: no real pose, or a degenerate sample.
#[derive(Clone, Copy, Debug)]
pub struct Poses {
    poses: [Similarity; MOST_POSES],
    len: usize,
}

const NOWHERE: Similarity = Similarity {
    scale: 0.0,
    rotation: Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)),
    translation: Vector3::new(0.0, 0.0, 0.0),
};

impl Poses {
    pub fn none() -> Poses {
        Poses { poses: [NOWHERE; MOST_POSES], len: 0 }
    }

    /// Adds the pose that turns and scales about `pivot` and sends it to `image`.
    #[inline]
    pub(super) fn push_about(
        &mut self,
        pivot: &Vector3<f64>,
        image: &Vector3<f64>,
        scale: f64,
        rotation: Matrix3<f64>,
    ) {
        let translation = image - scale * (rotation * pivot);
        self.push(Similarity { scale, rotation: Rotation3::from_matrix_unchecked(rotation), translation });
    }

    /// Adds a pose; one that is not finite, or that would be the ninth, is left out.
    #[inline]
    pub fn push(&mut self, pose: Similarity) {
        let sum = pose.scale + pose.rotation.matrix().sum() + pose.translation.sum();
        if sum.is_finite() && self.len < MOST_POSES {
            self.poses[self.len] = pose;
            self.len += 1;
        }
    }
}

impl std::ops::Deref for Poses {
    type Target = [Similarity];

    fn deref(&self) -> &[Similarity] {
        &self.poses[..self.len]
    }
}

impl<'a> IntoIterator for &'a Poses {
    type Item = &'a Similarity;
    type IntoIter = std::slice::Iter<'a, Similarity>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_neither_a_ninth_pose_nor_one_that_is_not_finite() {
        let mut poses = Poses::none();
        poses.push(Similarity { scale: f64::NAN, ..Similarity::identity() });
        assert!(poses.is_empty());
        for _ in 0..9 {
            poses.push(Similarity::identity());
        }
        assert_eq!(poses.len(), MOST_POSES);
    }
}
