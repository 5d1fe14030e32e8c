//! What the planes of the cloud say for a pose, in bits.
//!
//! Question     how much likelier is what the planes of the cloud meet if the pose is right than if it was fitted to another place?
//! Input        what each patch of each plane of the cloud meets, how much of the cloud the city occludes, and the rates of both by chance
//! Output       the logarithm of the likelihood ratio to base 2, and what each plane of the cloud adds to it
//! Method       the model knows a share m of what the cloud saw; what it knows lies on it with Gaussian errors of a scale s, what it does
//!              not know meets the city as by chance. Neither is demanded: the ratio is averaged over both (marginal likelihood), over m by
//!              Jeffreys' prior, once for each class of plane of the cloud and once for all in common. So a cloud of which the model knows a fifth loses a third of a bit
//!              by a miss and gains three or four by a hit. The patches of a plane of the cloud count as one observation: their logarithms are averaged
//! Source       evidence against chance: Desolneux, Moisan and Morel 2000; Moisan and Stival 2004; marginal likelihoods: Kass and
//!              Raftery 1995; the prior, and that no other loses less where the worst is taken: Krichevsky and Trofimov 1981;
//!              docs/mathematics.md 16.2
//! Assumptions  planes of the cloud meet the city independently of each other. By Markov's inequality a wrong pose then reaches b bits with a chance below 2^-b

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use super::chance::NullRates;
use super::cloud_planes::{CloudPlanes, INCLINATIONS};
use super::occluded;
use super::outcomes::{EDGES, KINDS, MISSED, Outcomes};

/// Evidence of a pose.
#[derive(Clone, Debug, Default)]
pub struct PoseEvidence {
    /// log2 of how much likelier all that is met is under the pose than by chance.
    pub bits: f64,
    /// What each plane of the cloud says at the likeliest share and scale.
    pub by_cloud_plane: Vec<f64>,
}

/// Scales of the model's error, shares of the tolerance, one twice the other: from the noise of a good scan to the whole tolerance.
const SCALES: [f64; 4] = [0.08, 0.16, 0.32, 0.64];

/// How many shares of the cloud that the model may know stand for all.
const SHARES: usize = 12;

/// Shares as likely as each other under Jeffreys' prior for a share (Beta 1/2, 1/2): the middles of equal parts of its distribution.
fn share(k: usize) -> f64 {
    ((k as f64 + 0.5) / SHARES as f64 * FRAC_PI_2).sin().powi(2)
}

/// Log ratios of one class, or of one plane of the cloud, for each share that the model may know.
type ByShare = [f64; SHARES];

/// Weighs what is met, and the share of the cloud that the city occludes.
pub fn weigh(cloud_planes: &CloudPlanes, outcomes: &Outcomes, hidden: f64, chance: &NullRates) -> PoseEvidence {
    let all = SCALES.map(|scale| on_model_off_by(scale, cloud_planes, outcomes, chance));
    let bits = log2_mean_exp2(&all.each_ref().map(|weighed| weighed.bits)) + occluded::bits(hidden, &chance.hidden);
    let likeliest = all.into_iter().max_by(|a, b| a.bits.total_cmp(&b.bits)).unwrap_or_default();
    PoseEvidence { bits, ..likeliest }
}

fn on_model_off_by(scale: f64, cloud_planes: &CloudPlanes, outcomes: &Outcomes, chance: &NullRates) -> PoseEvidence {
    let known = rates_of_known(scale);
    let tables = chance.rates.each_ref().map(|chance| log_ratios(&known, chance));
    let mut logs: Vec<ByShare> = vec![[0.0; SHARES]; cloud_planes.inclinations.len()];
    for (patch, met) in cloud_planes.patches.iter().zip(outcomes) {
        let table = &tables[cloud_planes.inclination_of(patch)];
        for (log, ratios) in logs[patch.cloud_plane as usize].iter_mut().zip(table) {
            *log += patch.share * met.iter().zip(ratios).map(|(share, ratio)| share * ratio).sum::<f64>();
        }
    }
    let mut of_class = [[0.0; SHARES]; INCLINATIONS];
    for (class, logs) in cloud_planes.inclinations.iter().zip(&logs) {
        of_class[*class as usize].iter_mut().zip(logs).for_each(|(sum, log)| *sum += log);
    }
    let in_common: ByShare = std::array::from_fn(|k| of_class.iter().map(|sums| sums[k]).sum());
    // LoD1 knows walls and no roofs, a laser scan of trees is known alike in all directions: as likely as not.
    let apart: f64 = of_class.iter().map(|sums| log2_mean_exp2(sums)).sum();
    let bits = log2_mean_exp2(&[apart, log2_mean_exp2(&in_common)]);
    let likeliest = of_class.map(|sums| (0..SHARES).fold(0, |best, k| if sums[k] > sums[best] { k } else { best }));
    let by_cloud_plane =
        cloud_planes.inclinations.iter().zip(&logs).map(|(class, log)| log[likeliest[*class as usize]]).collect();
    PoseEvidence { bits, by_cloud_plane }
}

/// What sample points meet on surfaces that the model knows, off by this as one sigma (shares of the tolerance).
fn rates_of_known(scale: f64) -> [f64; KINDS] {
    let within = EDGES.map(|edge| erf(edge / (scale * SQRT_2)));
    std::array::from_fn(|kind| match kind {
        0 => within[0],
        MISSED => 1.0 - within[MISSED - 1],
        band => within[band] - within[band - 1],
    })
}

/// The ratios of each kind of outcome, for each share that the model may know.
fn log_ratios(known: &[f64; KINDS], chance: &[f64; KINDS]) -> [[f64; KINDS]; SHARES] {
    std::array::from_fn(|k| {
        let share = share(k);
        std::array::from_fn(|kind| (share * known[kind] / chance[kind] + 1.0 - share).log2())
    })
}

/// log2 of the mean of 2^x.
fn log2_mean_exp2(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + (logs.iter().map(|x| (x - most).exp2()).sum::<f64>() / logs.len() as f64).log2()
}

/// The error function for x >= 0, good to 1.5e-7: Abramowitz and Stegun 7.1.26.
fn erf(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let of_t = [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592];
    1.0 - t * of_t.iter().fold(0.0, |sum, c| sum * t + c) * (-x * x).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rates_of_known_surfaces_add_up_to_one_and_sharpen_with_the_scale() {
        for scale in SCALES {
            let rates = rates_of_known(scale);
            assert!((rates.iter().sum::<f64>() - 1.0).abs() < 1e-12 && rates.iter().all(|r| *r >= 0.0), "{rates:?}");
        }
        // Two in three errors lie within one sigma.
        assert!((erf(std::f64::consts::FRAC_1_SQRT_2) - 0.682_689_49).abs() < 2e-7);
        assert!(rates_of_known(0.08)[0] > 0.85 && rates_of_known(0.64)[0] < 0.16);
    }

    #[test]
    fn chance_expects_a_ratio_of_one_whatever_the_model_knows() {
        let chance = [0.02, 0.02, 0.03, 0.05, 0.88];
        for scale in SCALES {
            for ratios in log_ratios(&rates_of_known(scale), &chance) {
                let expected: f64 = (0..KINDS).map(|k| chance[k] * ratios[k].exp2()).sum();
                assert!((expected - 1.0).abs() < 1e-9, "{expected}");
            }
        }
    }

    #[test]
    fn the_shares_are_those_of_jeffreys_prior() {
        let shares: Vec<f64> = (0..SHARES).map(share).collect();
        assert!(shares.is_sorted() && shares[0] < 0.005 && shares[SHARES - 1] > 0.995, "{shares:?}");
        // Mean and variance of Beta(1/2, 1/2): 1/2 and 1/8.
        let mean = shares.iter().sum::<f64>() / SHARES as f64;
        let variance = shares.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / SHARES as f64;
        assert!((mean - 0.5).abs() < 1e-12 && (variance - 0.125).abs() < 1e-12, "{mean} {variance}");
    }

    #[test]
    fn the_mean_of_powers_is_that_of_large_and_small_numbers() {
        assert!((log2_mean_exp2(&[2000.0, 2000.0]) - 2000.0).abs() < 1e-9);
        assert!((log2_mean_exp2(&[3.0, f64::NEG_INFINITY]) - 2.0).abs() < 1e-12);
    }
}
