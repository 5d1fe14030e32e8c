//! What the witnesses meet in the city under a pose.

use super::witnesses::{Piece, Witnesses};
use crate::correspondence::{Mover, Scene};
use crate::geometry::Similarity;
use crate::limits::EvidenceLimits;

/// What a probe can meet: a facet of its side and direction, nearer than one of these shares of the tolerance; ...
pub const EDGES: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// ... none; ...
pub const MISSED: usize = EDGES.len();
/// ... or the city stands between it and its cameras.
pub const BLOCKED: usize = MISSED + 1;
pub const KINDS: usize = BLOCKED + 1;

/// For each piece the shares of its probes by what they meet.
pub type Outcomes = Vec<[f64; KINDS]>;

/// What each piece meets under a pose.
pub fn outcomes(scene: &Scene, witnesses: &Witnesses, pose: &Similarity, limits: &EvidenceLimits) -> Outcomes {
    let mover = Mover::new(pose);
    let tolerance_m = pose.scale * limits.tolerance_m.max(limits.tolerance_sigmas * scene.votes.noise_m);
    let blocked = scene.blocked(&witnesses.lines, pose);
    let of_piece = |piece: &Piece| {
        let mut shares = [0.0; KINDS];
        let lines = &blocked[piece.lines.clone()];
        shares[BLOCKED] = lines.iter().filter(|b| **b).count() as f64 / lines.len().max(1) as f64;
        let mut distances: Vec<f64> = witnesses.probes[piece.probes.clone()]
            .iter()
            .filter_map(|&i| scene.nearest(&mover.probe(&scene.votes.probes[i as usize]), tolerance_m))
            .map(|hit| hit.distance_sq().sqrt() / tolerance_m)
            .collect();
        let on_city = distances.len() as f64 / piece.probes.len().max(1) as f64;
        // The points of a piece share its offset: their median tells it, the scatter about it does not.
        distances.sort_by(f64::total_cmp);
        let kind = distances.get(distances.len() / 2).map_or(MISSED, |d| band(*d));
        shares[kind] += (1.0 - shares[BLOCKED]) * on_city;
        shares[MISSED] += (1.0 - shares[BLOCKED]) * (1.0 - on_city);
        shares
    };
    witnesses.pieces.iter().map(of_piece).collect()
}

/// The band of a distance, shares of the tolerance.
fn band(distance: f64) -> usize {
    EDGES.iter().position(|edge| distance < *edge).unwrap_or(EDGES.len() - 1)
}
