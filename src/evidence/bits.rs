//! What the witnesses say for a pose, in bits.
//!
//! Question     how much likelier is what the witnesses meet if the pose is right than if it was fitted to another place?
//! Input        what each piece of each witness meets, and the rates of that by chance
//! Output       the logarithm of the likelihood ratio to base 2, and what each witness adds to it
//! Method       the model knows a share m of what the cloud saw, by class of witness; what it knows lies on it with Gaussian errors
//!              of a scale s, what it does not know meets the city as by chance, and under a right pose both leave their lines
//!              of sight free but for a share b. None of the three is demanded: the ratio is averaged over them, on grids (marginal likelihood). So a cloud
//!              of which the model knows a fifth loses a third of a bit by a miss and gains three or four by a hit. The pieces of a witness
//!              share its one vote: their logarithms are averaged
//! Source       evidence against chance: Desolneux, Moisan, Morel 2000; Moisan and Stival 2004; marginal likelihoods: Kass and
//!              Raftery 1995
//! Assumptions  witnesses meet the city of their own accord. By Markov's inequality a wrong pose then reaches b bits with a chance below 2^-b

use super::chance::Chance;
use super::outcomes::{BLOCKED, EDGES, KINDS, MISSED, Outcomes};
use super::witnesses::{CLASSES, Witnesses};
use crate::limits::EvidenceLimits;

/// Evidence of a pose.
#[derive(Clone, Debug, Default)]
pub struct Weighed {
    /// log2 of how much likelier all that is met is under the pose than by chance.
    pub bits: f64,
    /// What each witness says at the likeliest share and scale.
    pub by_witness: Vec<f64>,
}

/// Scales of the model's error, shares of the tolerance, one twice the other: from the noise of a good scan to the whole tolerance.
const SCALES: [f64; 4] = [0.08, 0.16, 0.32, 0.64];
/// Shares of the cloud that the model may know: denser where they are small, since a miss and a hit weigh by their logarithms.
const SHARES: [f64; 12] = [0.0, 0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.35, 0.5, 0.65, 0.8, 0.92];

/// log2 of the likelihood ratio of each kind of outcome, for each share that the model may know.
type Table = [[f64; KINDS]; SHARES.len()];

/// Weighs what is met.
pub fn weigh(witnesses: &Witnesses, outcomes: &Outcomes, chance: &Chance, limits: &EvidenceLimits) -> Weighed {
    let errors = SCALES.iter().flat_map(|&scale| limits.blocked_when_right.map(|blocked| Errors { scale, blocked }));
    let all: Vec<Weighed> = errors.map(|errors| with_errors(&errors, witnesses, outcomes, chance)).collect();
    let bits = log2_mean_exp2(&all.iter().map(|weighed| weighed.bits).collect::<Vec<_>>());
    let likeliest = all.into_iter().max_by(|a, b| a.bits.total_cmp(&b.bits)).unwrap_or_default();
    Weighed { bits, ..likeliest }
}

fn with_errors(errors: &Errors, witnesses: &Witnesses, outcomes: &Outcomes, chance: &Chance) -> Weighed {
    let right = errors.rates_of_known();
    let tables: [Table; CLASSES] =
        std::array::from_fn(|class| SHARES.map(|known| log_ratios(known, &right, &chance.rates[class])));
    let mut logs = vec![[0.0; SHARES.len()]; witnesses.class.len()];
    for (piece, met) in witnesses.pieces.iter().zip(outcomes) {
        let table = &tables[witnesses.class_of(piece)];
        for (log, ratios) in logs[piece.witness as usize].iter_mut().zip(table) {
            *log += piece.share * met.iter().zip(ratios).map(|(share, ratio)| share * ratio).sum::<f64>();
        }
    }
    let mut weighed = Weighed { by_witness: vec![0.0; logs.len()], ..Weighed::default() };
    for class in 0..CLASSES {
        let of_class = || (0..logs.len()).filter(move |&w| witnesses.class[w] as usize == class);
        let sums: [f64; SHARES.len()] = std::array::from_fn(|k| of_class().map(|w| logs[w][k]).sum());
        let likeliest = (0..SHARES.len()).fold(0, |best, k| if sums[k] > sums[best] { k } else { best });
        weighed.bits += log2_mean_exp2(&sums);
        of_class().for_each(|w| weighed.by_witness[w] = logs[w][likeliest]);
    }
    weighed
}

/// How a right pose errs.
struct Errors {
    /// Of the model, one sigma, as a share of the tolerance.
    scale: f64,
    /// Share of lines of sight that the city blocks all the same.
    blocked: f64,
}

impl Errors {
    /// What probes meet on surfaces that the model knows.
    fn rates_of_known(&self) -> [f64; KINDS] {
        let seen = 1.0 - self.blocked;
        let within = EDGES.map(|edge| seen * erf(edge / (self.scale * std::f64::consts::SQRT_2)));
        std::array::from_fn(|kind| match kind {
            0 => within[0],
            MISSED => seen - within[MISSED - 1],
            BLOCKED => self.blocked,
            band => within[band] - within[band - 1],
        })
    }
}

/// The ratios where the model knows a share of what was seen. Blocked lines of sight never speak for a pose.
fn log_ratios(known: f64, right: &[f64; KINDS], chance: &[f64; KINDS]) -> [f64; KINDS] {
    let blocked = right[BLOCKED].min(chance[BLOCKED]);
    // Of what chance blocks, a right pose leaves free all but these few.
    let freed = (1.0 - blocked) / (1.0 - chance[BLOCKED]);
    std::array::from_fn(|kind| match kind {
        BLOCKED => (blocked / chance[BLOCKED]).log2(),
        _ => (known * right[kind] / chance[kind] + (1.0 - known) * freed).log2(),
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

    fn rates(scale: f64, blocked: f64) -> [f64; KINDS] {
        Errors { scale, blocked }.rates_of_known()
    }

    #[test]
    fn the_rates_of_known_surfaces_add_up_to_one_and_sharpen_with_the_scale() {
        for scale in SCALES {
            let rates = rates(scale, 0.05);
            assert!((rates.iter().sum::<f64>() - 1.0).abs() < 1e-12 && rates.iter().all(|r| *r >= 0.0), "{rates:?}");
        }
        // Two in three errors lie within one sigma.
        assert!((erf(std::f64::consts::FRAC_1_SQRT_2) - 0.682_689_49).abs() < 2e-7);
        assert!(rates(0.08, 0.0)[0] > 0.85 && rates(0.64, 0.0)[0] < 0.16);
    }

    #[test]
    fn chance_expects_no_more_than_one_of_a_ratio_whatever_the_model_knows() {
        let chance = [0.02, 0.02, 0.03, 0.05, 0.58, 0.3];
        for scale in SCALES {
            for known in SHARES {
                let ratios = log_ratios(known, &rates(scale, 0.05), &chance);
                let expected: f64 = (0..KINDS).map(|k| chance[k] * ratios[k].exp2()).sum();
                assert!((expected - 1.0).abs() < 1e-9, "{expected}");
            }
        }
        // Where chance blocks less than a right pose may, nothing is made of it.
        let clear = [0.1, 0.1, 0.1, 0.1, 0.6, 0.0001];
        let ratios = log_ratios(0.5, &rates(0.16, 0.05), &clear);
        assert!(ratios[BLOCKED].abs() < 1e-9 && (0..KINDS).map(|k| clear[k] * ratios[k].exp2()).sum::<f64>() < 1.0);
    }

    #[test]
    fn the_mean_of_powers_is_that_of_large_and_small_numbers() {
        assert!((log2_mean_exp2(&[2000.0, 2000.0]) - 2000.0).abs() < 1e-9);
        assert!((log2_mean_exp2(&[3.0, f64::NEG_INFINITY]) - 2.0).abs() < 1e-12);
    }
}
