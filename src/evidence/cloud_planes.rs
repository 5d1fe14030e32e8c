//! Planes of the cloud: the independent observations for or against a pose, each seen in one or more patches.
//!
//! Question     which parts of the cloud lie on the city, or not, independently of each other?
//! Input        the patches of a cloud, level frame, and the scale that a pose gives them
//! Output       planes of the cloud, each with its patches and the sample points that are asked of each patch
//! Method       coplanar patches belong to one plane of the cloud, the largest first: a front across eight houses lies on the city by one
//!              coincidence, not by eight. Planes of the cloud are horizontal, vertical or oblique
//! Source       docs/mathematics.md 16.1
//! Assumptions  planes of the cloud meet the city independently of each other under a wrong pose

use crate::correspondence::{LevelPatch, Scene};
use crate::limits::EvidenceLimits;

/// How a plane of the cloud stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inclination {
    Horizontal,
    Vertical,
    Oblique,
}

pub const INCLINATIONS: usize = 3;

/// A patch, as part of a plane of the cloud.
#[derive(Clone, Debug)]
pub struct CloudPlanePatch {
    pub cloud_plane: u32,
    /// Share of the plane of the cloud.
    pub share: f64,
    /// Range in [`CloudPlanes::sample_points`].
    pub sample_points: std::ops::Range<usize>,
    /// Range in [`CloudPlanes::lines`].
    pub lines: std::ops::Range<usize>,
}

/// All planes of a cloud.
#[derive(Clone, Debug, Default)]
pub struct CloudPlanes {
    /// One for each.
    pub inclinations: Vec<Inclination>,
    pub patches: Vec<CloudPlanePatch>,
    /// Sample points of the level cloud, patch by patch, evenly over each: those that are looked up, and those whose lines of sight are traced.
    pub sample_points: Vec<u32>,
    pub lines: Vec<u32>,
}

impl CloudPlanes {
    pub fn inclination_of(&self, patch: &CloudPlanePatch) -> usize {
        self.inclinations[patch.cloud_plane as usize] as usize
    }

    /// The planes of a scene's cloud at a scale (metres of the city for one of the start).
    pub fn new(scene: &Scene, scale: f64, limits: &EvidenceLimits) -> CloudPlanes {
        let patches = &scene.level_cloud.patches;
        let mut order: Vec<usize> = (0..patches.len()).collect();
        order.sort_by_key(|&i| (std::cmp::Reverse(patches[i].sample_points.len()), i));
        let mut cloud_planes = CloudPlanes::default();
        let mut leaders: Vec<&LevelPatch> = Vec::new();
        for &i in &order {
            let patch = &patches[i];
            let found = leaders.iter().position(|leader| is_coplanar(leader, patch, scale, limits));
            let cloud_plane = found.unwrap_or_else(|| {
                leaders.push(patch);
                cloud_planes.inclinations.push(inclination(patch, scene.limits.upright_sin));
                leaders.len() - 1
            });
            cloud_planes.add(cloud_plane as u32, patch, limits);
        }
        let mut total = vec![0.0; leaders.len()];
        cloud_planes.patches.iter().for_each(|p| total[p.cloud_plane as usize] += p.share);
        cloud_planes.patches.iter_mut().for_each(|p| p.share /= total[p.cloud_plane as usize]);
        cloud_planes
    }

    fn add(&mut self, cloud_plane: u32, patch: &LevelPatch, limits: &EvidenceLimits) {
        let evenly = |count: usize, list: &mut Vec<u32>| {
            let (first, count) = (list.len(), count.min(patch.sample_points.len()));
            let step = patch.sample_points.len() as f64 / count as f64;
            list.extend((0..count).map(|k| (patch.sample_points.start + ((k as f64 + 0.5) * step) as usize) as u32));
            first..list.len()
        };
        let sample_points = evenly(limits.sample_points, &mut self.sample_points);
        let lines = evenly(limits.traced_points, &mut self.lines);
        // By its points: what else happens to lie in the plane of a front is small, and does not outvote it.
        let share = patch.sample_points.len() as f64;
        self.patches.push(CloudPlanePatch { cloud_plane, share, sample_points, lines });
    }
}

fn is_coplanar(leader: &LevelPatch, patch: &LevelPatch, scale: f64, limits: &EvidenceLimits) -> bool {
    let cos = leader.normal.dot(&patch.normal);
    let across_m = scale * (patch.center - leader.center).dot(&leader.normal).abs();
    let same_side = if leader.sided && patch.sided { cos } else { cos.abs() };
    same_side > limits.same_plane_deg.to_radians().cos() && across_m < limits.same_plane_m
}

fn inclination(patch: &LevelPatch, upright_sin: f64) -> Inclination {
    match patch.normal.z.abs() {
        z if z > 1.0 - upright_sin => Inclination::Horizontal,
        z if z < upright_sin => Inclination::Vertical,
        _ => Inclination::Oblique,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::{Made, walls_alone};
    use crate::robust::Motion;
    use crate::synthetic::{Block, CloudOptions, House, Offset};

    fn of_block(block: Block, seen: &CloudOptions) -> (CloudPlanes, usize) {
        let made = Made::cloud(block, seen);
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        (CloudPlanes::new(&scene, 1.0, &made.limits.evidence), scene.level_cloud.patches.len())
    }

    #[test]
    fn a_front_across_several_houses_is_one_observation() {
        // Three houses in a row, 3 m between them: two fronts, six gables.
        let row = Block::row(&House::flat([8.0, 10.0, 7.0]), 3, 11.0);
        let (cloud_planes, patches) = of_block(row, &walls_alone());
        assert_eq!(cloud_planes.inclinations.len(), 2 + 6);
        assert!(patches >= 12, "{patches}");
        assert!(cloud_planes.inclinations.iter().all(|inclination| *inclination == Inclination::Vertical));
    }

    #[test]
    fn the_pieces_of_a_witness_share_its_one_vote_and_ask_their_own_points() {
        let seen = CloudOptions { points_per_roof: 100, points_on_ground: 200, ..walls_alone() };
        let (cloud_planes, patches) = of_block(Block::four_houses().with_ground(), &seen);
        assert_eq!(cloud_planes.patches.len(), patches);
        let mut total = vec![0.0; cloud_planes.inclinations.len()];
        cloud_planes.patches.iter().for_each(|patch| total[patch.cloud_plane as usize] += patch.share);
        assert!(total.iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{total:?}");
        assert!(cloud_planes.inclinations.contains(&Inclination::Horizontal));
        for patch in &cloud_planes.patches {
            let sample_points = &cloud_planes.sample_points[patch.sample_points.clone()];
            assert!(
                sample_points.len() >= 8 && sample_points.windows(2).all(|pair| pair[0] < pair[1]),
                "{sample_points:?}"
            );
            assert_eq!(patch.lines.len(), 3);
        }
    }
}
