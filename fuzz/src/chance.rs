//! Draws: the same from the same seed and number of a case.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Damage that multiplies damage would else fill the memory itself.
const MOST_COPIED_BYTES: usize = 1 << 20;

pub struct Chance(ChaCha8Rng);

impl Chance {
    /// Of one case of one format. Formats draw apart from each other, so that the same number does not spoil all in the same way.
    pub fn of_case(seed: u64, format: &str, case: u64) -> Chance {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&case.to_le_bytes());
        for (at, byte) in format.bytes().enumerate() {
            key[16 + at % 16] ^= byte;
        }
        Chance(ChaCha8Rng::from_seed(key))
    }

    /// 0 to `count` - 1; 0 where there is nothing to choose from. The bias of the remainder does not matter here.
    pub fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count.max(1) as u64) as usize
    }

    /// True once in `count` draws.
    pub fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// One of some; none of an empty list.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        of.get(self.below(of.len()))
    }

    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Two places in a list, the first before the second or the same.
    pub fn span(&mut self, length: usize) -> std::ops::Range<usize> {
        let [one, other] = [self.below(length + 1), self.below(length + 1)];
        one.min(other)..one.max(other)
    }

    /// A small count of bytes, records or copies: mostly 1, seldom hundreds.
    pub fn few(&mut self) -> usize {
        1 << self.below(10).min(self.below(10))
    }

    /// Copies of something so long, bytes, which together stay short.
    pub fn copies(&mut self, bytes: usize) -> usize {
        self.few().min(1 + MOST_COPIED_BYTES / (bytes + 1))
    }
}
