//! How many points lie on their planes, whatever the sigmas say.

use super::planes::{PlaneOf, SharedPlanes};
use crate::geometry::Similarity;
use crate::merging::fault::PairFault;
use crate::merging::pair_limits::PairDecisionLimits;

/// Share of the points that lie on their planes, to `on_plane` of the radius, each group counting by the root of its points.
pub(super) fn share_on_planes(planes: &SharedPlanes, a_from_b: &Similarity, on_plane: f64) -> f64 {
    let (mut inside, mut all) = (0.0, 0.0);
    for group in &planes.groups {
        let gate = match group.plane_of {
            PlaneOf::A => on_plane * planes.radius[0],
            PlaneOf::B => on_plane * planes.radius[1] * a_from_b.scale,
        };
        let measured = group.points.iter().map(|p| group.measured(p, a_from_b, 0.0, planes.radius));
        let count = measured.filter(|m| !m.is_beside && m.residual.abs() < gate).count() as f64;
        let root = (group.points.len() as f64).sqrt();
        inside += group.share * count / root;
        all += group.share * root;
    }
    inside / all
}

/// Why there are too few of them to say anything, if so.
pub(super) fn too_few(planes: &SharedPlanes, limits: &PairDecisionLimits) -> Option<PairFault> {
    let (planes, points) = (planes.groups.len(), planes.correspondences());
    let are_few = planes < limits.fewest_planes || points < limits.fewest_on_planes;
    are_few.then_some(PairFault::FewPlanes { planes, points })
}

#[cfg(test)]
mod tests {
    use super::super::test_scene::scene;
    use super::*;
    use crate::merging::limits::MergeLimits;

    #[test]
    fn a_handful_of_planes_is_too_few() {
        let (mut planes, limits) = (scene(0.003, |x| *x), MergeLimits::default().decision);
        assert_eq!(too_few(&planes, &limits), None);
        planes.groups.truncate(7);
        assert!(too_few(&planes, &limits).is_some());
    }
}
