//! What patches and cameras ask of up: each of them for an up across some direction of its own, or along it.
//!
//! Question     how many of them are for a given up, and which change of it do they want?
//! Method       bounded kernels, so that sloping roofs and cameras that were held askew do not count
//! Errors       votes of one direction share an error (a wall that leans, a street that falls, a hand that tilts), so that
//!              n of them weigh as n / (s^2 + n t^2); s is their own scatter about the up in question
//! Assumptions  most patches are upright or level; most cameras are held level, or turned by a quarter

use std::f64::consts::FRAC_1_SQRT_2;

use super::patches::{Patch, Patches};
use crate::geometry::{Matrix3, Rotation3, Vector3};
use crate::limits::{UpErrorModel, UpLimits};

/// One kind of voters.
pub struct UpSupport {
    voters: Vec<UpObservation>,
    /// Add up to 1.
    weights: Vec<f64>,
    /// How many voters of its own direction each has, itself included.
    fellows: Vec<f64>,
    habits: UpErrorModel,
    limits: UpLimits,
}

/// More voters of a kind say nothing new. The heaviest patches, every n-th camera.
const MOST_VOTERS: usize = 500;
/// Two directions are alike by the cosine to this power: a half at 15 degrees.
const LIKENESS_POWER: i32 = 20;

enum UpObservation {
    Patch {
        normal: Vector3<f64>,
        sided: bool,
    },
    /// Its axes in the sfm frame: right, down, forward.
    Camera([Vector3<f64>; 3]),
}

/// What one voter asks of up.
enum Asks {
    Across(Vector3<f64>),
    Along(Vector3<f64>),
}

impl UpSupport {
    /// Walls and floors.
    pub fn of_patches(patches: &Patches, limits: &UpLimits) -> UpSupport {
        let mut heaviest: Vec<&Patch> = patches.patches.iter().collect();
        heaviest.sort_by_key(|p| std::cmp::Reverse(p.members.len()));
        heaviest.truncate(MOST_VOTERS);
        let voter = |p: &&Patch| UpObservation::Patch { normal: p.fit.plane.normal, sided: p.sided };
        let weights = heaviest.iter().map(|p| (p.members.len() as f64).sqrt()).collect();
        UpSupport::new(heaviest.iter().map(voter).collect(), weights, limits.patches, limits)
    }

    /// Cameras by their horizontal axes.
    pub fn of_cameras(cam_from_sfm: &[Rotation3<f64>], limits: &UpLimits) -> UpSupport {
        let axis = |r: &Rotation3<f64>, k: usize| r.matrix().row(k).transpose();
        let voter = |r: &Rotation3<f64>| UpObservation::Camera([0, 1, 2].map(|k| axis(r, k)));
        let step = cam_from_sfm.len().div_ceil(MOST_VOTERS).max(1);
        let voters: Vec<UpObservation> = cam_from_sfm.iter().step_by(step).map(voter).collect();
        let weights = vec![1.0; voters.len()];
        UpSupport::new(voters, weights, limits.cameras, limits)
    }

    fn new(voters: Vec<UpObservation>, mut weights: Vec<f64>, habits: UpErrorModel, limits: &UpLimits) -> UpSupport {
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= total);
        let fellows = voters.iter().map(|a| voters.iter().map(|b| a.likeness(b)).sum::<f64>().max(1.0)).collect();
        UpSupport { voters, weights, fellows, habits, limits: *limits }
    }

    /// Share of the voters for `up`, 0 to 1.
    pub fn share(&self, up: &Vector3<f64>) -> f64 {
        self.asked(up).fold(0.0, |sum, (asks, weight, _)| sum + weight * self.kernel(asks.misfit_sq(up)))
    }

    /// The quadratic form of up, 1 / rad^2, that the voters for an up near this one make small.
    pub fn information(&self, up: &Vector3<f64>) -> Matrix3<f64> {
        let even = 1.0 / self.voters.len() as f64;
        let kernel_sq = self.habits.kernel_rad.powi(2);
        // The variance of a voter of average weight.
        let (mut votes, mut squares) = (self.limits.votes_of_kernel, self.limits.votes_of_kernel * kernel_sq);
        for (asks, weight, _) in self.asked(up) {
            let misfit_sq = asks.misfit_sq(up);
            let believed = self.kernel(misfit_sq) * weight / even;
            votes += believed;
            squares += believed * misfit_sq;
        }
        let variance = squares / votes;
        self.asked(up).fold(Matrix3::zeros(), |sum, (asks, weight, fellows)| {
            let shared = match asks {
                Asks::Across(_) => self.habits.shared_across_rad,
                Asks::Along(_) => self.habits.shared_along_rad,
            };
            let of_one = variance * even / weight + fellows * shared * shared;
            sum + asks.form() * (self.kernel(asks.misfit_sq(up)) / of_one)
        })
    }

    /// What each voter asks of an up near this one, its weight and its fellows.
    fn asked(&self, up: &Vector3<f64>) -> impl Iterator<Item = (Asks, f64, f64)> {
        self.voters.iter().zip(&self.weights).zip(&self.fellows).filter_map(move |((voter, weight), fellows)| {
            let (asks, likely) = voter.asks(up, &self.limits)?;
            Some((asks, weight * likely, *fellows))
        })
    }

    fn kernel(&self, misfit_sq: f64) -> f64 {
        let root = 1.0 / (1.0 + misfit_sq / (self.habits.kernel_rad * self.habits.kernel_rad));
        root * root
    }
}

impl UpObservation {
    /// What it asks of an up near this one, and how much it counts; `None` where it cannot be for it at all.
    fn asks(&self, up: &Vector3<f64>, limits: &UpLimits) -> Option<(Asks, f64)> {
        match self {
            UpObservation::Patch { normal, sided } => {
                let along = normal.dot(up);
                if along.abs() < FRAC_1_SQRT_2 {
                    return Some((Asks::Across(*normal), 1.0));
                }
                // Nobody photographs a floor from below.
                (!sided || along > 0.0).then_some((Asks::Along(*normal), 1.0))
            }
            UpObservation::Camera([_, _, forward]) if forward.dot(up) > limits.steepest_view => None,
            UpObservation::Camera([right, down, _]) => {
                let is_turned = down.dot(up) > limits.upside_down || right.dot(up).abs() > FRAC_1_SQRT_2;
                Some(if is_turned { (Asks::Across(*down), limits.quarter_turned) } else { (Asks::Across(*right), 1.0) })
            }
        }
    }

    /// How nearly two voters have the same direction, 0 to 1.
    fn likeness(&self, other: &UpObservation) -> f64 {
        let cos = match (self, other) {
            (UpObservation::Patch { normal: a, .. }, UpObservation::Patch { normal: b, .. }) => a.dot(b).abs(),
            (UpObservation::Camera([r1, d1, _]), UpObservation::Camera([r2, d2, _])) => {
                r1.dot(r2).abs().min(d1.dot(d2).abs())
            }
            _ => 0.0,
        };
        cos.powi(LIKENESS_POWER)
    }
}

impl Asks {
    /// The square of the part of up (unit) that should not be there.
    fn misfit_sq(&self, up: &Vector3<f64>) -> f64 {
        match self {
            Asks::Across(a) => a.dot(up) * a.dot(up),
            Asks::Along(a) => (up - a * a.dot(up)).norm_squared(),
        }
    }

    /// The projection that takes this part out of up.
    fn form(&self) -> Matrix3<f64> {
        match self {
            Asks::Across(a) => a * a.transpose(),
            Asks::Along(a) => Matrix3::identity() - a * a.transpose(),
        }
    }
}
