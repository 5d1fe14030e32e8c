//! What the cameras must have seen through, were a pose true.
//!
//! Question     does the city stand between a camera and the points that it saw?
//! Method       the line of sight from each point to two of its cameras is traced against all facets near the scene; points whose every
//!              line is blocked contradict the pose: the camera would have looked through a house
//! Why          wrong poses find walls to lie on, but they rarely leave the streets free from which the photographs were taken; this
//!              evidence does not depend on how much of the scene the model knows

use rayon::prelude::*;

use super::scoring::Mover;
use super::votes::Votes;
use crate::geometry::{Point3, RayCaster, Similarity};

/// The facets near the scene as obstacles.
pub struct Sightlines {
    pub rays: RayCaster,
}

/// The point's own surroundings do not hide it: eaves, reveals and the model's error reach this far, metres.
const SURROUNDINGS_M: f64 = 0.7;
/// The camera's own place may be off the model's free space by this much, metres.
const CAMERA_SLACK_M: f64 = 0.7;
/// Probes per task.
const CHUNK: usize = 128;

impl Sightlines {
    /// For each probe of `panel` whether every line of sight to its cameras is blocked; probes without cameras are not.
    pub fn blocked(&self, votes: &Votes, panel: &[u32], city_from_level: &Similarity) -> Vec<bool> {
        let cameras: Vec<Point3<f64>> = votes.cameras.iter().map(|c| city_from_level.apply(c)).collect();
        let mover = Mover::new(city_from_level);
        let chunk = |panel: &[u32]| -> Vec<bool> {
            panel
                .iter()
                .map(|&i| {
                    let place = mover.probe(&votes.probes[i as usize]).position;
                    let mut viewers = votes.viewers[i as usize].iter().flatten().peekable();
                    viewers.peek().is_some() && viewers.all(|&c| self.is_blocked(&place, &cameras[c as usize]))
                })
                .collect()
        };
        panel.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().concat()
    }

    fn is_blocked(&self, place: &Point3<f64>, camera: &Point3<f64>) -> bool {
        let sight = camera - place;
        let length = sight.norm() - SURROUNDINGS_M - CAMERA_SLACK_M;
        let Some(direction) = sight.try_normalize(0.0).filter(|_| length > 0.0) else { return false };
        self.rays.first_hit(&(place + direction * SURROUNDINGS_M), &direction, length).is_some()
    }
}
