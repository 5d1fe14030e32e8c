//! Random numbers whose values are promised: the same seed and stream give the same numbers on every machine.
//!
//! Method       ChaCha with 8 rounds (Bernstein 2008); the normal distribution by Box and Muller 1958

use nalgebra::Quaternion;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::geometry::{Rotation3, UnitQuaternion, Vector3};

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

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// Three independent standard normal numbers.
    pub fn normal_vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal())
    }

    /// A uniform direction.
    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            if let Some(unit) = self.normal_vector().try_normalize(1e-3) {
                return unit;
            }
        }
    }

    /// A uniform rotation.
    pub fn rotation(&mut self) -> Rotation3<f64> {
        let q = Quaternion::new(self.normal(), self.normal(), self.normal(), self.normal());
        UnitQuaternion::new_normalize(q).to_rotation_matrix()
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

    #[test]
    fn the_first_numbers_of_a_stream_are_promised() {
        let mut random = Random::stream(2026, 3);
        let first: Vec<usize> = (0..6).map(|_| random.below(1_000_000)).collect();
        assert_eq!(first, [722_025, 320_620, 817_678, 231_131, 817_501, 937_601]);
    }

    /// Mean and variance of `count` numbers.
    fn moments(count: usize, mut draw: impl FnMut() -> f64) -> [f64; 2] {
        let drawn: Vec<f64> = (0..count).map(|_| draw()).collect();
        let mean = drawn.iter().sum::<f64>() / count as f64;
        [mean, drawn.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count as f64]
    }

    #[test]
    fn uniform_and_normal_numbers_have_their_moments() {
        let mut random = Random::stream(5, 0);
        let [mean, variance] = moments(40_000, || random.unit());
        assert!((mean - 0.5).abs() < 0.006 && (variance - 1.0 / 12.0).abs() < 0.002, "{mean} {variance}");
        let [mean, variance] = moments(40_000, || random.normal());
        assert!(mean.abs() < 0.02 && (variance - 1.0).abs() < 0.03, "{mean} {variance}");
        let inside = (0..40_000).filter(|_| random.normal().abs() < 1.0).count() as f64 / 40_000.0;
        assert!((inside - 0.6827).abs() < 0.01, "{inside}");
    }

    #[test]
    fn directions_and_rotations_prefer_nothing() {
        let mut random = Random::stream(6, 0);
        let (mut mean, mut turned, mut squares) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        let count = 20_000.0;
        for _ in 0..20_000 {
            let direction = random.direction();
            assert!((direction.norm() - 1.0).abs() < 1e-12);
            mean += direction / count;
            squares += direction.component_mul(&direction) / count;
            turned += random.rotation() * Vector3::new(0.6, 0.0, 0.8) / count;
        }
        assert!(mean.amax() < 0.02 && turned.amax() < 0.02, "{mean} {turned}");
        assert!((squares - Vector3::repeat(1.0 / 3.0)).amax() < 0.01, "{squares}");
    }
}
