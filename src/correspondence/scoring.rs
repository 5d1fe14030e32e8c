//! How well a pose explains the cloud: shares of the vote that lie on facets of the right side and direction.
//!
//! A vote is lost at a distance that shrinks and grows with the pose's scale, so that no shrinking of the cloud can gain
//! votes.

use nalgebra::Matrix3;

use super::scene::Scene;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::planes::Probe;
use crate::robust::vote;

impl Scene<'_> {
    /// Share of the vote explained within `gate_m` (metres of the start), by the probes of `panel` alike.
    pub fn panel_share(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        let mut sum = 0.0;
        self.each_vote(panel, city_from_level, gate_m, |_, vote| sum += vote);
        sum / panel.len().max(1) as f64
    }

    /// That share less the cost of leaving what is known beforehand, so that where the data say nothing the start decides.
    pub fn score(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64) -> f64 {
        self.panel_share(panel, city_from_level, gate_m) - self.prior.cost(city_from_level)
    }

    /// The same score, or `None` as soon as it cannot reach `least`, though all probes that are left should vote.
    pub fn score_from(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64, least: f64) -> Option<f64> {
        let (count, cost) = (panel.len().max(1) as f64, self.prior.cost(city_from_level));
        let (mut sum, mut left) = (0.0, panel.len());
        for part in panel.chunks(BETWEEN_LOOKS) {
            if (sum + left as f64) / count - cost < least {
                return None;
            }
            self.each_vote(part, city_from_level, gate_m, |_, vote| sum += vote);
            left -= part.len();
        }
        Some(sum / count - cost).filter(|score| *score >= least)
    }

    /// Tells `take` the vote of each probe of `panel` that has one.
    fn each_vote(&self, panel: &[u32], city_from_level: &Similarity, gate_m: f64, mut take: impl FnMut(usize, f64)) {
        let gate_m = gate_m * city_from_level.scale;
        self.meet(panel, city_from_level, gate_m, |_| gate_m, |k, _, hit| take(k, vote(hit.distance_sq(), gate_m)));
    }
}

/// Probes between two looks at whether a score can still be reached.
const BETWEEN_LOOKS: usize = 32;

/// A similarity multiplied out for many points.
pub struct Mover {
    scaled: Matrix3<f64>,
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

impl Mover {
    pub fn new(pose: &Similarity) -> Mover {
        let rotation = *pose.rotation.matrix();
        Mover { scaled: rotation * pose.scale, rotation, translation: pose.translation }
    }

    pub fn probe(&self, p: &Probe) -> Probe {
        Probe { position: self.place(p), normal: self.direction(p), ..*p }
    }

    #[inline]
    pub fn place(&self, p: &Probe) -> Point3<f64> {
        Point3::from(self.scaled * p.position.coords + self.translation)
    }

    #[inline]
    pub fn direction(&self, p: &Probe) -> Vector3<f64> {
        self.rotation * p.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::Made;
    use crate::robust::Motion;
    use crate::synthetic::{Block, CloudOptions, Offset};

    #[test]
    fn the_share_at_the_truth_is_that_of_the_points_on_what_the_city_knows() {
        let seen = Block::four_houses();
        let known = Block::new(seen.houses[..3].to_vec()).with_ground(true);
        let survey = seen.cloud(&CloudOptions { points_per_roof: 100, ..CloudOptions::default() });
        let made = Made::new(known, survey);
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let panel = scene.votes.panel(2000);
        // Three boxes of five faces are known, and the ground, which follows the houses' faces in what was seen.
        let is_known = |face: usize| face < 15 || face == 20;
        let on_city = panel.iter().filter(|i| made.face_of(&scene, **i).is_some_and(is_known)).count();
        let on_city = on_city as f64 / panel.len() as f64;
        let share = scene.panel_share(&panel, &made.truth(&scene), scene.unit_m);
        // Noise of 2 cm costs half a per cent of a gate of 29 cm; one vote in a hundred is chance.
        assert!(on_city > 0.5 && on_city < 0.95 && (share - on_city).abs() < 0.02, "{share} {on_city}");
    }

    #[test]
    fn the_share_falls_with_the_distance_from_the_truth() {
        let made = Made::four_houses();
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        let panel = scene.votes.panel(1000);
        let share = |off_m: f64| {
            let pose = made.pose(&scene, &Offset { shift_m: [off_m, 0.7 * off_m, 0.5 * off_m], ..Offset::default() });
            scene.panel_share(&panel, &pose, scene.unit_m)
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
        let panel = scene.votes.panel(1000);
        let wrong = made.pose(&scene, &Offset { shift_m: [1.1, 1.3, 0.9], ..Offset::default() });
        let at_full_size = scene.panel_share(&panel, &wrong, scene.unit_m);
        for corner in made.block.houses.iter().flat_map(|house| &house.faces).flat_map(|face| &face.corners) {
            let corner = corner - made.city.model.origin;
            for scale in [0.5, 0.2, 0.05, 0.01] {
                let shrunk = Similarity::about(&corner, &corner, scale, crate::geometry::Rotation3::identity()) * wrong;
                let share = scene.panel_share(&panel, &shrunk, scene.unit_m);
                assert!(share < at_full_size + 0.05, "{share} at {scale} about {corner}, {at_full_size} at full size");
            }
        }
    }

    #[test]
    fn a_facet_that_is_seen_from_its_back_explains_nothing() {
        let made = Made::photographed();
        let mut scene = made.scene(&Offset::default(), Motion::Similarity);
        let (panel, truth) = (scene.votes.panel(1000), made.truth(&scene));
        assert!(scene.votes.probes.iter().all(|probe| probe.sided));
        let from_the_front = scene.panel_share(&panel, &truth, scene.unit_m);
        scene.votes.probes.iter_mut().for_each(|probe| probe.normal = -probe.normal);
        let from_the_back = scene.panel_share(&panel, &truth, scene.unit_m);
        assert!(from_the_front > 0.95 && from_the_back < 0.01, "{from_the_front} {from_the_back}");
    }

    #[test]
    fn the_score_is_the_share_less_what_leaving_the_start_costs() {
        let made = Made::four_houses();
        let start = Offset { shift_m: [4.0, -3.0, 1.0], heading_rad: 0.1, scale: 1.1, ..Offset::default() };
        let scene = made.scene(&start, Motion::Similarity);
        let panel = scene.votes.panel(500);
        let truth = made.truth(&scene);
        let cost = scene.prior.cost(&truth);
        assert!(cost > 0.001, "{cost}");
        let share = scene.panel_share(&panel, &truth, scene.unit_m);
        assert_eq!(scene.score(&panel, &truth, scene.unit_m), share - cost);
        let mut votes = vec![0.0; panel.len()];
        scene.each_vote(&panel, &truth, scene.unit_m, |k, vote| votes[k] = vote);
        assert_eq!(share, votes.iter().sum::<f64>() / votes.len() as f64);
    }
}
