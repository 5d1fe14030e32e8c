//! What the planes of the cloud meet in the city under a pose.

use super::cloud_planes::{CloudPlanePatch, CloudPlanes};
use crate::correspondence::Scene;
use crate::geometry::Similarity;
use crate::limits::EvidenceLimits;

/// What a sample point can meet: a facet of its side and direction, nearer than one of these shares of the tolerance, or none.
pub const EDGES: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// Index of the outcome "no facet".
pub const MISSED: usize = EDGES.len();
pub const KINDS: usize = MISSED + 1;

/// For each patch the shares of its sample points by what they meet.
pub type Outcomes = Vec<[f64; KINDS]>;

/// What each patch meets under a pose.
pub fn outcomes(scene: &Scene, cloud_planes: &CloudPlanes, pose: &Similarity, limits: &EvidenceLimits) -> Outcomes {
    let tolerance_m = pose.scale * limits.tolerance_m.max(limits.tolerance_sigmas * scene.level_cloud.noise_m);
    let occluded = scene.occluded(&cloud_planes.lines, pose);
    let mut off = vec![f64::INFINITY; cloud_planes.sample_points.len()];
    scene.meet(
        &cloud_planes.sample_points,
        pose,
        tolerance_m,
        |_| tolerance_m,
        |k, _, hit| off[k] = hit.distance_sq().sqrt(),
    );
    let of_patch = |patch: &CloudPlanePatch| {
        let mut shares = [0.0; KINDS];
        let lines = &occluded[patch.lines.clone()];
        // What no camera could have seen there is met by nobody.
        let seen = 1.0 - lines.iter().filter(|b| **b).count() as f64 / lines.len().max(1) as f64;
        let mut on_city: Vec<f64> =
            off[patch.sample_points.clone()].iter().copied().filter(|m| m.is_finite()).collect();
        let share = seen * on_city.len() as f64 / patch.sample_points.len().max(1) as f64;
        // The points of a patch share its offset: their median tells it, the scatter about it does not.
        on_city.sort_by(f64::total_cmp);
        shares[on_city.get(on_city.len() / 2).map_or(MISSED, |m| band(m / tolerance_m))] = share;
        shares[MISSED] += 1.0 - share;
        shares
    };
    cloud_planes.patches.iter().map(of_patch).collect()
}

/// The band of a distance, shares of the tolerance.
fn band(distance: f64) -> usize {
    EDGES.iter().position(|edge| distance < *edge).unwrap_or(EDGES.len() - 1)
}
