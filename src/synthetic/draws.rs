//! Draws: streams of numbers for one purpose each, and what is drawn from them.

use crate::solvers::scene::Chance;

/// The stream for one purpose, so that another level of one fault leaves all the rest as it was.
pub(super) fn stream(seed: u64, purpose: u64) -> Chance {
    // Odd factors spread neighbouring numbers over all bits; the generator mixes them further.
    Chance::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(purpose.wrapping_mul(0xd1b5_4a32_d192_ed03)))
}

pub(super) fn between(chance: &mut Chance, low: f64, high: f64) -> f64 {
    low + (high - low) * chance.uniform()
}

/// Uniform in the logarithm.
pub(super) fn log_between(chance: &mut Chance, low: f64, high: f64) -> f64 {
    between(chance, low.ln(), high.ln()).exp()
}

/// A whole number from `low` up to but not `high`.
pub(super) fn whole(chance: &mut Chance, low: usize, high: usize) -> usize {
    low + ((high - low) as f64 * chance.uniform()) as usize
}

/// One of some values, each with its chance; the last one takes what is left.
pub(super) fn one_of<T: Copy>(chance: &mut Chance, values: &[(T, f64)]) -> T {
    let mut left = chance.uniform();
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
pub(super) fn count(chance: &mut Chance, mean: f64) -> usize {
    let (least, mut product, mut found) = ((-mean).exp(), chance.uniform(), 0);
    while product > least {
        product *= chance.uniform();
        found += 1;
    }
    found
}
