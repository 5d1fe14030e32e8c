//! How often planes of the cloud meet the city by chance: measured on poses that were fitted to other places.

use super::cloud_planes::{CloudPlanes, INCLINATIONS};
use super::outcomes::{KINDS, Outcomes};

/// Rates of what is met, by class of plane of the cloud.
#[derive(Clone, Debug)]
pub struct NullRates {
    pub rates: [[f64; KINDS]; INCLINATIONS],
    /// Shares of the cloud that the city occludes under null poses, ascending.
    pub hidden: Vec<f64>,
}

impl NullRates {
    /// The mean over null poses, of whom `unseen` more met everything alike; `hidden` is what the city occludes under each.
    pub fn new(cloud_planes: &CloudPlanes, null_poses: &[Outcomes], mut hidden: Vec<f64>, unseen: f64) -> NullRates {
        let mut rates = [[unseen / KINDS as f64; KINDS]; INCLINATIONS];
        let mut of_class = [0.0; INCLINATIONS];
        for patch in &cloud_planes.patches {
            of_class[cloud_planes.inclination_of(patch)] += patch.share;
        }
        for outcomes in null_poses {
            for (patch, shares) in cloud_planes.patches.iter().zip(outcomes) {
                let class = cloud_planes.inclination_of(patch);
                let weight = patch.share / of_class[class];
                rates[class].iter_mut().zip(shares).for_each(|(rate, share)| *rate += weight * share);
            }
        }
        let total = unseen + null_poses.len() as f64;
        for (rates, _) in rates.iter_mut().zip(of_class).filter(|(_, weight)| *weight > 0.0) {
            rates.iter_mut().for_each(|rate| *rate /= total);
        }
        hidden.sort_by(f64::total_cmp);
        NullRates { rates, hidden }
    }
}
