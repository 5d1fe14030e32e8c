//! What the witnesses meet in the city under a pose.

use super::witnesses::{Piece, Witnesses};
use crate::correspondence::Scene;
use crate::geometry::Similarity;
use crate::limits::EvidenceLimits;

/// What a probe can meet: a facet of its side and direction, nearer than one of these shares of the tolerance; ...
pub const EDGES: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
/// ... or none.
pub const MISSED: usize = EDGES.len();
pub const KINDS: usize = MISSED + 1;

/// For each piece the shares of its probes by what they meet.
pub type Outcomes = Vec<[f64; KINDS]>;

/// What each piece meets under a pose.
pub fn outcomes(scene: &Scene, witnesses: &Witnesses, pose: &Similarity, limits: &EvidenceLimits) -> Outcomes {
    let tolerance_m = pose.scale * limits.tolerance_m.max(limits.tolerance_sigmas * scene.votes.noise_m);
    let blocked = scene.blocked(&witnesses.lines, pose);
    let mut off = vec![f64::INFINITY; witnesses.probes.len()];
    scene.meet(&witnesses.probes, pose, tolerance_m, |_| tolerance_m, |k, _, hit| off[k] = hit.distance_sq().sqrt());
    let of_piece = |piece: &Piece| {
        let mut shares = [0.0; KINDS];
        let lines = &blocked[piece.lines.clone()];
        // What no camera could have seen there is met by nobody.
        let seen = 1.0 - lines.iter().filter(|b| **b).count() as f64 / lines.len().max(1) as f64;
        let mut on_city: Vec<f64> = off[piece.probes.clone()].iter().copied().filter(|m| m.is_finite()).collect();
        let share = seen * on_city.len() as f64 / piece.probes.len().max(1) as f64;
        // The points of a piece share its offset: their median tells it, the scatter about it does not.
        on_city.sort_by(f64::total_cmp);
        shares[on_city.get(on_city.len() / 2).map_or(MISSED, |m| band(m / tolerance_m))] = share;
        shares[MISSED] += 1.0 - share;
        shares
    };
    witnesses.pieces.iter().map(of_piece).collect()
}

/// The band of a distance, shares of the tolerance.
fn band(distance: f64) -> usize {
    EDGES.iter().position(|edge| distance < *edge).unwrap_or(EDGES.len() - 1)
}
