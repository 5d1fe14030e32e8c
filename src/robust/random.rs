//! Random numbers whose values are promised: the same seed and stream give the same samples on every machine.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// One stream of random numbers.
pub struct Random(ChaCha8Rng);

impl Random {
    /// Streams of one seed are independent of each other, so that blocks of work may run in any order.
    pub fn stream(seed: u64, stream: u64) -> Random {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Random(rng)
    }

    /// Uniform in `0..n`; `n` must not be 0. The bias of the multiply-shift is below n / 2^64.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.next_u64()) * n as u128) >> 64) as usize
    }

    /// Uniform in `[0, 1)`, 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// An index drawn with probability proportional to the steps of `cumulative` (rising sums); `None` where they are empty or zero.
    pub fn weighted(&mut self, cumulative: &[f64]) -> Option<usize> {
        let total = *cumulative.last().filter(|t| **t > 0.0)?;
        let at = self.unit() * total;
        Some(cumulative.partition_point(|&c| c <= at).min(cumulative.len() - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |seed, stream| {
            (0..4).map(|_| 0).scan(Random::stream(seed, stream), |r, _: i32| Some(r.below(1000))).collect::<Vec<_>>()
        };
        assert_eq!(draw(7, 1), draw(7, 1));
        assert_ne!(draw(7, 1), draw(7, 2));
        assert_ne!(draw(7, 1), draw(8, 1));
    }

    #[test]
    fn draws_by_weight() {
        let mut random = Random::stream(1, 0);
        let mut counts = [0; 3];
        for _ in 0..4000 {
            counts[random.weighted(&[1.0, 1.0, 4.0]).unwrap()] += 1;
        }
        assert!(counts[1] == 0 && (900..1100).contains(&counts[0]), "{counts:?}");
        assert_eq!(random.weighted(&[]), None);
        assert_eq!(random.weighted(&[0.0]), None);
    }
}
