//! Whether a pose puts the city where the cloud says there is air.
//!
//! Question     how much of the cloud would the city have hidden, were a pose true?
//! Input        points of the cloud, taken evenly over the ground that it covers
//! Output       the share of them that the city occludes, and what that says for the pose in bits, beside the shares under null poses
//! Method       a point is hidden where the city blocks its lines of sight to two of its cameras or, where no camera is known, where it lies deep under a
//!              roof or the ground. One house occludes all that was seen behind it, so that points do not speak one by one: the share
//!              speaks once, by its rank among the null poses', a chance p that becomes a likelihood ratio (1 - p + p ln p) / (p ln^2 p)
//! Source       the mean of all ratios k p^(k-1): Vovk and Wang 2021, section 2; its bound: Sellke, Bayarri and Berger 2001;
//!              docs/mathematics.md 16.3
//! Why          wrong poses find walls to lie on, but rarely leave the streets free from which they were seen; this does not depend on
//!              how much of the scene the model knows. A right pose may hide something, too (glass, a new street): it never loses more
//!              than one bit by that

use std::collections::BTreeMap;

use crate::correspondence::Scene;
use crate::geometry::{Point3, Similarity};
use crate::limits::EvidenceLimits;
use crate::planes::Patches;

/// A point and two of the cameras that saw it (indices into the level cloud's cameras).
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// Level frame.
    position: Point3<f64>,
    viewers: [Option<u32>; 2],
}

/// Points of a cloud, evenly over the ground that it covers.
#[derive(Clone, Debug, Default)]
pub struct SeenPoints(Vec<Seen>);

impl SeenPoints {
    /// Of a scene's cloud, at a scale (metres of the city for one of the start).
    pub fn new(scene: &Scene, patches: &Patches, scale: f64, limits: &EvidenceLimits) -> SeenPoints {
        let mut squares: BTreeMap<[i64; 2], Vec<Seen>> = BTreeMap::new();
        for (point, viewers) in patches.points.iter().zip(&patches.viewers) {
            let position = scene.level_cloud.level_from_sfm.apply(point);
            let square = [position.x, position.y].map(|x| (x * scale / limits.hidden_square_m).floor() as i64);
            squares.entry(square).or_default().push(Seen { position, viewers: *viewers });
        }
        let of_square = limits.occlusion_points.div_ceil(squares.len().max(1));
        let evenly = |points: &Vec<Seen>| -> Vec<Seen> {
            let count = of_square.min(points.len());
            let step = points.len() as f64 / count as f64;
            (0..count).map(|k| points[((k as f64 + 0.5) * step) as usize]).collect()
        };
        SeenPoints(squares.values().flat_map(evenly).collect())
    }

    /// Share of the points that the city occludes under a pose.
    pub fn occluded_share(&self, scene: &Scene, pose: &Similarity) -> f64 {
        let cameras: Vec<Point3<f64>> = scene.level_cloud.cameras.iter().map(|c| pose.apply(c)).collect();
        let is_hidden = |seen: &&Seen| {
            let place = pose.apply(&seen.position);
            let mut viewers = seen.viewers.iter().flatten().peekable();
            match viewers.peek() {
                Some(_) => viewers.all(|&c| scene.occludes(&place, &cameras[c as usize])),
                None => scene.buries(&place),
            }
        };
        self.0.iter().filter(is_hidden).count() as f64 / self.0.len().max(1) as f64
    }
}

/// What a share says for a pose, bits, beside the shares of null poses (ascending).
pub fn bits(share: f64, by_chance: &[f64]) -> f64 {
    let less = by_chance.partition_point(|other| *other < share);
    let alike = by_chance.partition_point(|other| *other <= share) - less;
    // The pose itself is one of those that are alike; among them its rank is the middle one.
    of_chance((less as f64 + (alike + 1) as f64 / 2.0) / (by_chance.len() + 1) as f64).log2()
}

/// The e-value of a p-value (docs/mathematics.md (22)).
fn of_chance(p: f64) -> f64 {
    let log = p.ln();
    // Both parts of the fraction vanish at one.
    if log > -1e-3 { 0.5 } else { (1.0 - p + p * log) / (p * log * log) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::Made;
    use crate::robust::Motion;
    use crate::synthetic::Offset;

    #[test]
    fn chance_expects_no_more_than_one_of_a_ratio() {
        let steps = 100_000;
        let mean =
            (0..steps).map(|k| of_chance((f64::from(k) + 0.5) / f64::from(steps))).sum::<f64>() / f64::from(steps);
        // The integral diverges slowly towards one at p = 0.
        assert!(mean < 1.0 && mean > 0.9, "{mean}");
        assert!((of_chance(0.9989) - of_chance(0.9991)).abs() < 1e-3);
    }

    #[test]
    fn few_hidden_points_speak_for_a_pose_and_many_cost_one_bit_at_most() {
        let by_chance: Vec<f64> = (0..255).map(|k| f64::from(k) / 255.0).collect();
        assert!(bits(-0.1, &by_chance) > 2.0);
        assert!((bits(2.0, &by_chance) + 1.0).abs() < 0.01);
        // Where nothing is ever hidden, nothing is learned but little lost; and so where there are no null poses.
        assert!(bits(0.0, &[0.0; 255]) > -0.7 && bits(0.0, &[]) > -0.7);
    }

    #[test]
    fn the_truth_hides_little_and_a_place_across_the_houses_does_with_cameras_and_without() {
        for made in [Made::photographed(), Made::four_houses()] {
            let scene = made.scene(&Offset::default(), Motion::Rigid);
            let seen = SeenPoints::new(&scene, &made.patches, 1.0, &made.limits.evidence);
            let share = |off: &Offset| seen.occluded_share(&scene, &made.pose(&scene, off));
            // Some points of the clouds are wrong.
            let at_truth = share(&Offset::default());
            let across = share(&Offset { shift_m: [6.0, 5.0, 0.0], ..Offset::default() });
            assert!(at_truth < 0.05 && across > 2.0 * at_truth, "{at_truth} {across}");
        }
    }
}
