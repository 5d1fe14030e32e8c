//! What the cameras must have seen through, were a pose true.
//!
//! Question     does the city stand between a camera and the points that it saw?
//! Method       the line of sight from each point to two of its cameras is traced against all facets near the scene; points whose every
//!              line is occluded contradict the pose: the camera would have looked through a house
//! Why          wrong poses find walls to lie on, but they rarely leave the streets free from which the photographs were taken; this
//!              evidence does not depend on how much of the scene the model knows

use rayon::prelude::*;

use super::mover::Mover;
use super::scene::Scene;
use crate::geometry::{Point3, Similarity, Vector3};

/// Sample points per task.
const CHUNK: usize = 128;

impl Scene<'_> {
    /// For each sample point of `point_subset` whether every line of sight to its cameras is occluded; sample points without cameras are not.
    pub fn occluded(&self, point_subset: &[u32], city_from_level: &Similarity) -> Vec<bool> {
        let level_cloud = &self.level_cloud;
        let cameras: Vec<Point3<f64>> = level_cloud.cameras.iter().map(|c| city_from_level.apply(c)).collect();
        let mover = Mover::new(city_from_level);
        let is_blocked = |&i: &u32| {
            let place = mover.sample_point(&level_cloud.sample_points[i as usize]).position;
            let mut viewers = level_cloud.viewers[i as usize].iter().flatten().peekable();
            viewers.peek().is_some() && viewers.all(|&c| self.occludes(&place, &cameras[c as usize]))
        };
        let chunk = |point_subset: &[u32]| -> Vec<bool> { point_subset.iter().map(is_blocked).collect() };
        point_subset.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().concat()
    }

    /// Whether the city stands between a point and a camera.
    pub fn occludes(&self, place: &Point3<f64>, camera: &Point3<f64>) -> bool {
        let limits = &self.limits.occlusion;
        let sight = camera - place;
        let length = sight.norm() - limits.surroundings_m - limits.camera_slack_m;
        let Some(direction) = sight.try_normalize(0.0).filter(|_| length > 0.0) else { return false };
        self.city.rays().first_hit(&(place + direction * limits.surroundings_m), &direction, length).is_some()
    }

    /// Whether a point lies under a roof or under the ground, and so far inside that neither eaves nor the model's errors explain it: for
    /// clouds without cameras.
    pub fn buries(&self, place: &Point3<f64>) -> bool {
        let inside_m = self.limits.occlusion.surroundings_m + self.limits.occlusion.camera_slack_m;
        let sides = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        sides.iter().all(|[x, y]| {
            let from = place + inside_m * Vector3::new(*x, *y, 1.0);
            self.city.rays().first_hit(&from, &Vector3::z(), f64::INFINITY).is_some()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::{Made, patch_points};
    use crate::robust::Motion;
    use crate::synthetic::Offset;

    /// Whether points of the city (as the block has it) are hidden from cameras that stand there. The first house of the block lies within
    /// x 0 to 12, y 0 to 8, z 0 to 7.
    fn hidden(place: [f64; 3], cameras: &[[f64; 3]]) -> bool {
        let made = Made::four_houses();
        let mut scene = made.scene(&Offset::default(), Motion::Rigid);
        let local = |x: [f64; 3]| Point3::from(Vector3::from(x) - made.city.model.origin);
        scene.level_cloud.sample_points[0].position = local(place);
        scene.level_cloud.cameras = cameras.iter().map(|c| local(*c)).collect();
        let viewer = |k: usize| (k < cameras.len()).then_some(k as u32);
        scene.level_cloud.viewers[0] = [viewer(0), viewer(1)];
        scene.occluded(&[0], &Similarity::identity())[0]
    }

    const BEFORE: [f64; 3] = [6.0, -15.0, 1.7];
    const BEHIND: [f64; 3] = [6.0, 15.0, 1.7];

    #[test]
    fn a_point_behind_a_house_is_blocked_unless_one_of_its_cameras_sees_it() {
        let on_front = [6.0, 0.0, 3.0];
        assert!(!hidden(on_front, &[BEFORE]));
        assert!(hidden(on_front, &[BEHIND]));
        assert!(hidden(on_front, &[BEHIND, BEHIND]));
        assert!(!hidden(on_front, &[BEHIND, BEFORE]));
        // Over the roof, 7 m high and 8 m deep.
        assert!(!hidden([6.0, -0.1, 7.5], &[[6.0, 15.0, 9.0]]));
    }

    #[test]
    fn a_point_without_cameras_is_never_blocked() {
        assert!(!hidden([6.0, 4.0, 3.0], &[]));
    }

    #[test]
    fn neither_the_surroundings_of_a_point_nor_those_of_its_camera_hide_it() {
        let limits = crate::limits::Limits::default().occlusion;
        let inside = |depth_m: f64| hidden([6.0, depth_m, 3.0], &[BEFORE]);
        assert!(!inside(0.9 * limits.surroundings_m) && inside(1.1 * limits.surroundings_m));
        let camera_inside = |depth_m: f64| hidden([6.0, -9.0, 1.7], &[[6.0, depth_m, 1.7]]);
        assert!(!camera_inside(0.9 * limits.camera_slack_m) && camera_inside(1.1 * limits.camera_slack_m));
        // A camera nearer than both sees what it stands before.
        assert!(!hidden([6.0, 0.5, 3.0], &[[6.0, -0.5, 3.0]]));
    }

    #[test]
    fn the_truth_leaves_the_lines_of_sight_free_and_a_place_across_the_houses_does_not() {
        let made = Made::photographed();
        let scene = made.scene(&Offset::default(), Motion::Rigid);
        let point_subset = patch_points(&scene);
        let share = |off: &Offset| {
            let occluded = scene.occluded(&point_subset, &made.pose(&scene, off));
            occluded.iter().filter(|b| **b).count() as f64 / occluded.len() as f64
        };
        let off = Offset { shift_m: [9.0, 7.0, 0.0], ..Offset::default() };
        assert_eq!(share(&Offset::default()), 0.0);
        // Several houses are in the way; how many lines they cut depends on the place.
        assert!(share(&off) > 0.1, "{}", share(&off));
    }
}
