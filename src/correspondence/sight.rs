//! What the cameras must have seen through, were a pose true.
//!
//! Question     does the city stand between a camera and the points that it saw?
//! Method       the line of sight from each point to two of its cameras is traced against all facets near the scene; points whose every
//!              line is blocked contradict the pose: the camera would have looked through a house
//! Why          wrong poses find walls to lie on, but they rarely leave the streets free from which the photographs were taken; this
//!              evidence does not depend on how much of the scene the model knows

use rayon::prelude::*;

use super::scene::Scene;
use super::scoring::Mover;
use crate::geometry::{Point3, Similarity};

/// Probes per task.
const CHUNK: usize = 128;

impl Scene<'_> {
    /// For each probe of `panel` whether every line of sight to its cameras is blocked; probes without cameras are not.
    pub fn blocked(&self, panel: &[u32], city_from_level: &Similarity) -> Vec<bool> {
        let votes = &self.votes;
        let cameras: Vec<Point3<f64>> = votes.cameras.iter().map(|c| city_from_level.apply(c)).collect();
        let mover = Mover::new(city_from_level);
        let is_blocked = |&i: &u32| {
            let place = mover.probe(&votes.probes[i as usize]).position;
            let mut viewers = votes.viewers[i as usize].iter().flatten().peekable();
            viewers.peek().is_some() && viewers.all(|&c| self.hides(&place, &cameras[c as usize]))
        };
        let chunk = |panel: &[u32]| -> Vec<bool> { panel.iter().map(is_blocked).collect() };
        panel.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().concat()
    }

    /// Whether the city stands between a point and a camera.
    fn hides(&self, place: &Point3<f64>, camera: &Point3<f64>) -> bool {
        let limits = &self.limits.sight;
        let sight = camera - place;
        let length = sight.norm() - limits.surroundings_m - limits.camera_slack_m;
        let Some(direction) = sight.try_normalize(0.0).filter(|_| length > 0.0) else { return false };
        self.city.rays().first_hit(&(place + direction * limits.surroundings_m), &direction, length).is_some()
    }
}
