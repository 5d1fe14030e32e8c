//! Who can speak for a pose: planes in space, each of which the cloud saw in one or more pieces.
//!
//! Question     which parts of the cloud lie on the city, or not, independently of each other?
//! Input        the patches of a cloud, level frame, and the scale that a pose gives them
//! Output       witnesses, each with its pieces and the probes that are asked of each piece
//! Method       coplanar patches are pieces of one witness, the largest first: a front across eight houses lies on the city by one
//!              coincidence, not by eight. Witnesses are of three classes: level, wall, slope
//! Assumptions  witnesses meet the city independently of each other under a wrong pose

use crate::correspondence::{LevelPatch, Scene};
use crate::limits::EvidenceLimits;

/// How a witness stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Level,
    Wall,
    Slope,
}

pub const CLASSES: usize = 3;

/// A patch, as part of a witness.
#[derive(Clone, Debug)]
pub struct Piece {
    pub witness: u32,
    /// Share of the witness.
    pub share: f64,
    /// Range in [`Witnesses::probes`].
    pub probes: std::ops::Range<usize>,
    /// Range in [`Witnesses::lines`].
    pub lines: std::ops::Range<usize>,
}

/// All witnesses of a cloud.
#[derive(Clone, Debug, Default)]
pub struct Witnesses {
    pub class: Vec<Class>,
    pub pieces: Vec<Piece>,
    /// Probes of the votes, piece by piece, evenly over each: those that are looked up, and those whose lines of sight are traced.
    pub probes: Vec<u32>,
    pub lines: Vec<u32>,
}

impl Witnesses {
    pub fn class_of(&self, piece: &Piece) -> usize {
        self.class[piece.witness as usize] as usize
    }

    /// The witnesses of a scene's cloud at a scale (metres of the city for one of the start).
    pub fn new(scene: &Scene, scale: f64, limits: &EvidenceLimits) -> Witnesses {
        let patches = &scene.votes.patches;
        let mut order: Vec<usize> = (0..patches.len()).collect();
        order.sort_by_key(|&i| (std::cmp::Reverse(patches[i].probes.len()), i));
        let mut witnesses = Witnesses::default();
        let mut leaders: Vec<&LevelPatch> = Vec::new();
        for &i in &order {
            let patch = &patches[i];
            let found = leaders.iter().position(|leader| is_coplanar(leader, patch, scale, limits));
            let witness = found.unwrap_or_else(|| {
                leaders.push(patch);
                witnesses.class.push(class(patch, scene.limits.upright_sin));
                leaders.len() - 1
            });
            witnesses.add(witness as u32, patch, limits);
        }
        let mut total = vec![0.0; leaders.len()];
        witnesses.pieces.iter().for_each(|p| total[p.witness as usize] += p.share);
        witnesses.pieces.iter_mut().for_each(|p| p.share /= total[p.witness as usize]);
        witnesses
    }

    fn add(&mut self, witness: u32, patch: &LevelPatch, limits: &EvidenceLimits) {
        let evenly = |count: usize, list: &mut Vec<u32>| {
            let (first, count) = (list.len(), count.min(patch.probes.len()));
            let step = patch.probes.len() as f64 / count as f64;
            list.extend((0..count).map(|k| (patch.probes.start + ((k as f64 + 0.5) * step) as usize) as u32));
            first..list.len()
        };
        let probes = evenly(limits.probes, &mut self.probes);
        let lines = evenly(limits.sight_probes, &mut self.lines);
        // By its points: what else happens to lie in the plane of a front is small, and does not outvote it.
        let share = patch.probes.len() as f64;
        self.pieces.push(Piece { witness, share, probes, lines });
    }
}

fn is_coplanar(leader: &LevelPatch, patch: &LevelPatch, scale: f64, limits: &EvidenceLimits) -> bool {
    let cos = leader.normal.dot(&patch.normal);
    let across_m = scale * (patch.center - leader.center).dot(&leader.normal).abs();
    let same_side = if leader.sided && patch.sided { cos } else { cos.abs() };
    same_side > limits.same_plane_deg.to_radians().cos() && across_m < limits.same_plane_m
}

fn class(patch: &LevelPatch, upright_sin: f64) -> Class {
    match patch.normal.z.abs() {
        z if z > 1.0 - upright_sin => Class::Level,
        z if z < upright_sin => Class::Wall,
        _ => Class::Slope,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::{Made, walls_alone};
    use crate::robust::Motion;
    use crate::synthetic::{Block, CloudOptions, House, Offset};

    fn of_block(block: Block, seen: &CloudOptions) -> (Witnesses, usize) {
        let made = Made::cloud(block, seen);
        let scene = made.scene(&Offset::default(), Motion::Similarity);
        (Witnesses::new(&scene, 1.0, &made.limits.evidence), scene.votes.patches.len())
    }

    #[test]
    fn a_front_across_several_houses_is_one_witness() {
        // Three houses in a row, 3 m between them: two fronts, six gables.
        let row = Block::row(&House::flat([8.0, 10.0, 7.0]), 3, 11.0);
        let (witnesses, patches) = of_block(row, &walls_alone());
        assert_eq!(witnesses.class.len(), 2 + 6);
        assert!(patches >= 12, "{patches}");
        assert!(witnesses.class.iter().all(|class| *class == Class::Wall));
    }

    #[test]
    fn the_pieces_of_a_witness_share_its_one_vote_and_ask_their_own_points() {
        let seen = CloudOptions { points_per_roof: 100, points_on_ground: 200, ..walls_alone() };
        let (witnesses, patches) = of_block(Block::four_houses().with_ground(true), &seen);
        assert_eq!(witnesses.pieces.len(), patches);
        let mut total = vec![0.0; witnesses.class.len()];
        witnesses.pieces.iter().for_each(|piece| total[piece.witness as usize] += piece.share);
        assert!(total.iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{total:?}");
        assert!(witnesses.class.contains(&Class::Level));
        for piece in &witnesses.pieces {
            let probes = &witnesses.probes[piece.probes.clone()];
            assert!(probes.len() >= 8 && probes.windows(2).all(|pair| pair[0] < pair[1]), "{probes:?}");
            assert_eq!(piece.lines.len(), 3);
        }
    }
}
