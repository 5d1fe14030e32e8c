//! How well a pose explains the cloud: the inlier share, of sample points that lie on facets of the right side and direction.
//!
//! A sample point counts for nothing from a distance on that shrinks and grows with the pose's scale, so that shrinking the cloud gains
//! nothing.

use super::scene::Scene;
use crate::geometry::Similarity;
use crate::robust::truncated_quadratic;

impl Scene<'_> {
    /// Inlier share within `gate_m` (metres of the start), by the sample points of `point_subset` alike.
    pub fn inlier_share(&self, point_subset: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        let mut sum = 0.0;
        self.each_inlier(point_subset, city_from_level, gate_m, |_, inlier| sum += inlier);
        sum / point_subset.len().max(1) as f64
    }

    /// That share less the cost of leaving what is known beforehand, so that where the data say nothing the start decides.
    pub fn score(&self, point_subset: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        self.inlier_share(point_subset, city_from_level, gate_m) - self.prior.cost(city_from_level)
    }

    /// The same score, or `None` as soon as it cannot reach `least`, though all sample points that are left should be inliers.
    pub fn score_from(
        &self,
        point_subset: &[u32],
        city_from_level: &Similarity,
        gate_m: f64,
        least: f64,
    ) -> Option<f64> {
        let (count, cost) = (point_subset.len().max(1) as f64, self.prior.cost(city_from_level));
        let (mut sum, mut left) = (0.0, point_subset.len());
        for part in point_subset.chunks(BETWEEN_LOOKS) {
            if (sum + left as f64) / count - cost < least {
                return None;
            }
            self.each_inlier(part, city_from_level, gate_m, |_, inlier| sum += inlier);
            left -= part.len();
        }
        Some(sum / count - cost).filter(|score| *score >= least)
    }

    /// Tells `take` what each sample point of `point_subset` adds to the inlier share, where it adds anything.
    fn each_inlier(
        &self,
        point_subset: &[u32],
        city_from_level: &Similarity,
        gate_m: f64,
        mut take: impl FnMut(usize, f64),
    ) {
        let gate_m = gate_m * city_from_level.scale;
        self.meet(
            point_subset,
            city_from_level,
            gate_m,
            |_| gate_m,
            |k, _, hit| take(k, truncated_quadratic(hit.distance_sq(), gate_m)),
        );
    }
}

/// Sample points between two looks at whether a score can still be reached.
const BETWEEN_LOOKS: usize = 32;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::Made;
    use crate::robust::Motion;
    use crate::synthetic::{Block, CloudOptions, Offset};

    #[test]
    fn the_share_at_the_truth_is_that_of_the_points_on_what_the_city_knows() {
        let seen = Block::four_houses();
        let known = Block::new(seen.houses[..3].to_vec()).with_ground();
        let survey = seen.cloud(&CloudOptions { points_per_roof: 100, ..CloudOptions::default() });
        let made = Made::new(known, survey);
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let point_subset = scene.level_cloud.point_subset(2000);
        // Three boxes of five faces are known, and the ground, which follows the houses' faces in what was seen.
        let is_known = |face: usize| face < 15 || face == 20;
        let on_city = point_subset.iter().filter(|i| made.face_of(&scene, **i).is_some_and(is_known)).count();
        let on_city = on_city as f64 / point_subset.len() as f64;
        let share = scene.inlier_share(&point_subset, &made.truth(&scene), scene.gate_unit_m);
        // Noise of 2 cm costs half a per cent of a gate of 29 cm; one inlier in a hundred is chance.
        assert!(on_city > 0.5 && on_city < 0.95 && (share - on_city).abs() < 0.02, "{share} {on_city}");
    }

    #[test]
    fn the_share_falls_with_the_distance_from_the_truth() {
        let made = Made::four_houses();
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let point_subset = scene.level_cloud.point_subset(1000);
        let share = |off_m: f64| {
            let pose = made.pose(&scene, &Offset { shift_m: [off_m, 0.7 * off_m, 0.5 * off_m], ..Offset::default() });
            scene.inlier_share(&point_subset, &pose, scene.gate_unit_m)
        };
        let shares = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3].map(share);
        assert!(shares[0] > 0.95, "{shares:?}");
        assert!(shares.is_sorted_by(|nearer, farther| *nearer > farther + 0.005), "{shares:?}");
        assert!(share(2.0) < 0.2, "{}", share(2.0));
    }

    #[test]
    fn shrinking_the_cloud_into_a_corner_of_the_city_gains_nothing() {
        let made = Made::four_houses();
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let point_subset = scene.level_cloud.point_subset(1000);
        let wrong = made.pose(&scene, &Offset { shift_m: [1.1, 1.3, 0.9], ..Offset::default() });
        let at_full_size = scene.inlier_share(&point_subset, &wrong, scene.gate_unit_m);
        for corner in made.block.houses.iter().flat_map(|house| &house.faces).flat_map(|face| &face.corners) {
            let corner = corner - made.city.model.origin;
            for scale in [0.5, 0.2, 0.05, 0.01] {
                let shrunk = Similarity::about(&corner, &corner, scale, crate::geometry::Rotation3::identity()) * wrong;
                let share = scene.inlier_share(&point_subset, &shrunk, scene.gate_unit_m);
                assert!(share < at_full_size + 0.05, "{share} at {scale} about {corner}, {at_full_size} at full size");
            }
        }
    }

    #[test]
    fn a_facet_that_is_seen_from_its_back_explains_nothing() {
        let made = Made::photographed();
        let mut scene = made.scene(&Offset::default(), Motion::Similarity);
        let (point_subset, truth) = (scene.level_cloud.point_subset(1000), made.truth(&scene));
        assert!(scene.level_cloud.sample_points.iter().all(|sample_point| sample_point.sided));
        let from_the_front = scene.inlier_share(&point_subset, &truth, scene.gate_unit_m);
        scene.level_cloud.sample_points.iter_mut().for_each(|sample_point| sample_point.normal = -sample_point.normal);
        let from_the_back = scene.inlier_share(&point_subset, &truth, scene.gate_unit_m);
        assert!(from_the_front > 0.95 && from_the_back < 0.01, "{from_the_front} {from_the_back}");
    }

    #[test]
    fn the_score_is_the_share_less_what_leaving_the_start_costs() {
        let made = Made::four_houses();
        let start = Offset { shift_m: [4.0, -3.0, 1.0], heading_rad: 0.1, scale: 1.1, ..Offset::default() };
        let scene = made.scene(&start, Motion::Similarity);
        let point_subset = scene.level_cloud.point_subset(500);
        let truth = made.truth(&scene);
        let cost = scene.prior.cost(&truth);
        assert!(cost > 0.001, "{cost}");
        let share = scene.inlier_share(&point_subset, &truth, scene.gate_unit_m);
        assert_eq!(scene.score(&point_subset, &truth, scene.gate_unit_m), share - cost);
        let mut inliers = vec![0.0; point_subset.len()];
        scene.each_inlier(&point_subset, &truth, scene.gate_unit_m, |k, inlier| inliers[k] = inlier);
        assert_eq!(share, inliers.iter().sum::<f64>() / inliers.len() as f64);
    }
}
