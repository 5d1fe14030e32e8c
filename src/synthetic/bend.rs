//! Bends: what no similarity takes away from a reconstruction, and the similarity that comes nearest.
//!
//! Method       doming, drift of the scale along the scene and slow waves, in seeded parts
//! Source       best similarity: Umeyama 1991

use std::f64::consts::{PI, TAU};

use nalgebra::Matrix3;

use super::draws::between;
use crate::geometry::{Point3, Similarity, Vector3, nearest_rotation};
use crate::solvers::scene::Random;

/// A slow wave.
struct Wave {
    number: Vector3<f64>,
    phase: f64,
    amplitude: Vector3<f64>,
}

/// How a reconstruction is bent.
pub(super) struct Bend {
    middle: Point3<f64>,
    half_extent: f64,
    /// The direction in which the scene is longest.
    axis: Vector3<f64>,
    doming: Vector3<f64>,
    drift: f64,
    bowl: f64,
    waves: [Wave; 3],
    strength: f64,
}

impl Bend {
    /// One that moves all but one in a hundred of the points by no more than `share` of their extent.
    pub(super) fn new(points: &[Point3<f64>], share: f64, random: &mut Random) -> Bend {
        let middle = middle_of(points);
        let scatter: Matrix3<f64> = points.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
        let eigen = scatter.symmetric_eigen();
        let extent = extent_of(points);
        let mut bend = Bend {
            middle,
            half_extent: (0.5 * extent).max(f64::MIN_POSITIVE),
            axis: eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned(),
            doming: random.normal_vector().component_mul(&Vector3::new(1.0, 1.0, 0.7)),
            drift: 0.6 * random.normal(),
            bowl: 0.5 * random.normal(),
            waves: std::array::from_fn(|_| Wave {
                number: between(random, 0.5, 2.0) * PI * random.direction(),
                phase: between(random, 0.0, TAU),
                amplitude: 0.5 * random.normal_vector(),
            }),
            // So little that what is left beside the best similarity is linear in it.
            strength: 1e-4 * extent,
        };
        let pairs: Vec<_> = points.iter().map(|p| (bend.apply(p), *p)).collect();
        let best = best_similarity(&pairs);
        let mut left: Vec<f64> = pairs.iter().map(|(bent, p)| (best.apply(bent) - p).norm()).collect();
        left.sort_by(f64::total_cmp);
        let most = left.get(left.len() * 99 / 100).copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        bend.strength *= share * extent / most;
        bend
    }

    pub(super) fn apply(&self, x: &Point3<f64>) -> Point3<f64> {
        let y = (x - self.middle) / self.half_extent;
        let along = y.dot(&self.axis);
        let waves: Vector3<f64> = self.waves.iter().map(|w| (w.number.dot(&y) + w.phase).sin() * w.amplitude).sum();
        let bow = along * along * (self.doming + self.drift * self.axis);
        x + self.strength * (bow + self.bowl * y.xy().norm_squared() * Vector3::z() + waves)
    }
}

fn middle_of(points: &[Point3<f64>]) -> Point3<f64> {
    let sum: Vector3<f64> = points.iter().map(|p| p.coords).sum();
    Point3::from(sum / points.len().max(1) as f64)
}

/// The diagonal of the box that holds all but the outermost three in a hundred on each side.
fn extent_of(points: &[Point3<f64>]) -> f64 {
    let width = |axis: usize| {
        let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0);
        at(0.97) - at(0.03)
    };
    Vector3::new(width(0), width(1), width(2)).norm()
}

/// The similarity that takes the first points nearest to the second ones, in the least squares.
pub(super) fn best_similarity(pairs: &[(Point3<f64>, Point3<f64>)]) -> Similarity {
    let from: Vec<Point3<f64>> = pairs.iter().map(|(a, _)| *a).collect();
    let to: Vec<Point3<f64>> = pairs.iter().map(|(_, b)| *b).collect();
    let (from_middle, to_middle) = (middle_of(&from), middle_of(&to));
    let cross: Matrix3<f64> = pairs.iter().map(|(a, b)| (b - to_middle) * (a - from_middle).transpose()).sum();
    let spread: f64 = from.iter().map(|a| (a - from_middle).norm_squared()).sum();
    let Some(rotation) = nearest_rotation(&cross) else { return Similarity::identity() };
    let scale = (rotation.matrix().transpose() * cross).trace() / spread.max(f64::MIN_POSITIVE);
    Similarity::about(&from_middle, &to_middle, scale, rotation)
}

#[cfg(test)]
mod tests;
