//! Whether one pose leads another by more than chance.
//!
//! Question     could the patches that happen to be there have put the wrong one of two poses in front?
//! Input        two poses of one scene
//! Output       the lead of the first over the second, in standard errors
//! Method       paired comparison (Student 1908): each patch gives each pose its net vote, what lies on the city less what the city would
//!              hide; the differences of independent patches add up to the lead, their squares to its variance. The cost of leaving the
//!              start is known and joins the lead alone
//! Why          a lead of a quarter of the vote is firm when thirty walls make it and chance when three do; a ratio of balances cannot
//!              tell the two apart
//! Assumptions  the points of one patch stand or fall together, patches of their own accord

use super::scene::Scene;
use crate::geometry::Similarity;

/// The net vote of each patch for a pose, shares of the whole vote: positive where its points lie on the city, negative where the
/// city would stand between them and their cameras.
pub(super) fn ballot(scene: &Scene, pose: &Similarity) -> Vec<f64> {
    let panel = scene.votes.panel(scene.limits.refinement.lead_probes);
    // The gate is that of the last ranking.
    let explained = scene.panel_votes(&panel, pose, scene.unit_m);
    let blocked = scene.blocked(&panel, pose);
    let mut by_patch = vec![0.0; scene.votes.patches.len()];
    for (i, (vote, is_blocked)) in panel.iter().zip(explained.into_iter().zip(blocked)) {
        let patch = scene.votes.patches.partition_point(|p| p.probes.end <= *i as usize);
        by_patch[patch] += (vote - f64::from(u8::from(is_blocked))) / panel.len() as f64;
    }
    by_patch
}

/// Lead of one ballot over another in standard errors; `head_start` is what the first has besides. Infinite where no patch tells the
/// two apart but the head start does, zero where nothing does.
pub(super) fn lead_sigmas(first: &[f64], second: &[f64], head_start: f64) -> f64 {
    let differences = || first.iter().zip(second).map(|(a, b)| a - b);
    let lead = differences().sum::<f64>() + head_start;
    let variance = differences().map(|d| d * d).sum::<f64>();
    if lead == 0.0 { 0.0 } else { lead / variance.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_lead_is_firmer_from_many_patches_than_from_few() {
        let few = lead_sigmas(&[0.5, 0.0, 0.0], &[0.0, 0.2, 0.1], 0.0);
        let many = lead_sigmas(&[0.1; 10], &[0.08; 10], 0.0);
        assert!((few - 0.2 / 0.3f64.sqrt()).abs() < 1e-12, "{few}");
        assert!((many - 10f64.sqrt()).abs() < 1e-9, "{many}");
    }

    #[test]
    fn nobody_leads_a_twin_and_the_start_may_decide() {
        assert_eq!(lead_sigmas(&[0.3, 0.2], &[0.3, 0.2], 0.0), 0.0);
        assert_eq!(lead_sigmas(&[0.3, 0.2], &[0.3, 0.2], 0.01), f64::INFINITY);
        assert!(lead_sigmas(&[0.3, 0.1], &[0.3, 0.2], 0.0) < 0.0);
    }
}
