//! Draws: streams of numbers for one purpose each, and what is drawn from them.

use crate::solvers::scene::Random;

/// The stream for one purpose, so that another level of one fault leaves all the rest as it was.
pub(super) fn stream(seed: u64, purpose: u64) -> Random {
    // Odd factors spread neighbouring numbers over all bits; the generator mixes them further.
    Random::stream(
        seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(purpose.wrapping_mul(0xd1b5_4a32_d192_ed03)),
        0,
    )
}

pub(super) fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.unit()
}

/// Uniform in the logarithm.
pub(super) fn log_between(random: &mut Random, low: f64, high: f64) -> f64 {
    between(random, low.ln(), high.ln()).exp()
}

/// A whole number from `low` up to but not `high`.
pub(super) fn whole(random: &mut Random, low: usize, high: usize) -> usize {
    low + ((high - low) as f64 * random.unit()) as usize
}

/// One of some values, each with its chance; the last one takes what is left.
pub(super) fn one_of<T: Copy>(random: &mut Random, values: &[(T, f64)]) -> T {
    let mut left = random.unit();
    let mut chosen = values[0].0;
    for (value, share) in values {
        chosen = *value;
        left -= share;
        if left < 0.0 {
            break;
        }
    }
    chosen
}

/// How many of rare things there are where `mean` are expected (Poisson, by Knuth's products).
pub(super) fn count(random: &mut Random, mean: f64) -> usize {
    let (least, mut product, mut found) = ((-mean).exp(), random.unit(), 0);
    while product > least {
        product *= random.unit();
        found += 1;
    }
    found
}

#[cfg(test)]
mod tests;
