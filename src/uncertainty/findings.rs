//! What the unknowns beside the pose turned out to be, and what of it is worth telling.

use super::observations::Kind;
use super::rows::{COMMON, LIDS, WALLS};
use super::system::System;
use crate::limits::UncertaintyLimits;

/// Errors of the model and of the reconstruction, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SystematicErrors {
    /// How far walls stand inside the model's, and one sigma of that.
    pub walls_inset_m: f64,
    pub walls_inset_sigma_m: f64,
    /// How much lower level tops of buildings are than the model's, and one sigma of that.
    pub tops_lower_m: f64,
    pub tops_lower_sigma_m: f64,
    /// Shift of a single building along an axis, one sigma.
    pub buildings_m: f64,
    /// Offset of a single building plane, one sigma.
    pub fronts_m: f64,
    /// By how much the reconstruction bends, root mean square; 0 where nothing shows it.
    pub bending_m: f64,
}

impl SystematicErrors {
    pub(super) fn of(system: &System) -> SystematicErrors {
        let sigma_m = |k: usize| system.covariance[(k, k)].sqrt();
        let bends_m = (COMMON..system.common).map(|k| system.found[k].powi(2)).sum::<f64>().sqrt();
        SystematicErrors {
            // The cloud lies before a surface where its distance is positive, and what is added makes it zero.
            walls_inset_m: system.found[WALLS],
            walls_inset_sigma_m: sigma_m(WALLS),
            tops_lower_m: system.found[LIDS],
            tops_lower_sigma_m: sigma_m(LIDS),
            buildings_m: system.variances.building[Kind::Built as usize].sqrt(),
            fronts_m: system.variances.building_plane[Kind::Built as usize].sqrt(),
            bending_m: if bending_shows(system) { bends_m } else { 0.0 },
        }
    }

    /// In words, what chance does not explain and a user would want to know.
    pub fn notable(&self, limits: &UncertaintyLimits) -> Vec<String> {
        let shows = |value_m: f64, sigma_m: f64| {
            value_m.abs() > limits.reported_sigmas * sigma_m && value_m.abs() > limits.reported_m
        };
        let mut told = Vec::new();
        if shows(self.walls_inset_m, self.walls_inset_sigma_m) {
            let (by_m, side) = (self.walls_inset_m.abs(), if self.walls_inset_m > 0.0 { "inside" } else { "outside" });
            told.push(format!(
                "walls stand {by_m:.2} m {side} the model's (one sigma {:.2} m), all alike: the pose and its sigmas allow for it",
                self.walls_inset_sigma_m
            ));
        }
        if shows(self.tops_lower_m, self.tops_lower_sigma_m) {
            let (by_m, side) = (self.tops_lower_m.abs(), if self.tops_lower_m > 0.0 { "lower" } else { "higher" });
            told.push(format!(
                "level roofs lie {by_m:.2} m {side} than the model's (one sigma {:.2} m), all alike: the pose and its sigmas allow for it",
                self.tops_lower_sigma_m
            ));
        }
        if self.bending_m > limits.reported_m {
            told.push(format!(
                "the reconstruction bends by {:.2} m (root mean square), which no similarity undoes: single places may be off by more than \
                 the sigmas of the pose say",
                self.bending_m
            ));
        }
        told
    }
}

/// Whether bending explains more than chance would. Were there none, what is found of a field would scatter by its covariance times the share
/// that the data tell of it.
fn bending_shows(system: &System) -> bool {
    let known = system.known();
    let told = |k: usize| 1.0 - system.covariance[(k, k)] * known[(k, k)];
    let fields: Vec<usize> = (COMMON..system.common).filter(|&k| told(k) > LEAST_SHARE).collect();
    let squares: f64 = fields.iter().map(|&k| system.found[k].powi(2) / (system.covariance[(k, k)] * told(k))).sum();
    let count = fields.len() as f64;
    squares > count + system.limits.reported_sigmas * (2.0 * count).sqrt()
}

/// A field of which the data tell less than this share says nothing of the bending.
const LEAST_SHARE: f64 = 0.1;
