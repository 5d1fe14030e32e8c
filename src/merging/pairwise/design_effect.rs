//! How much more an estimate scatters than its rows say, because neighbours err alike.
//!
//! Question     rows are weighed as if each erred by itself; by which factor is the variance of the estimate greater (or smaller)?
//! Method       the rows are split into blocks of neighbours. With H the information and g_k the gradient of block k at the
//!              optimum, H^-1 (sum g_k g_k^T) H^-1 is the covariance that holds whatever the errors inside a block have to do
//!              with each other; its size against H^-1 is trace(H^-1 sum g_k g_k^T) / 7.
//! Assumptions  blocks err independently: a deformation of the whole part is not seen
//! Source       Liang and Zeger 1986, "sandwich" covariance; Kish 1965 for the name

use super::rows::PlacedEquations;
use crate::geometry::Point3;
use crate::robust::{Motion, NormalEquations, Vector7};

/// Blocks: more than twice the unknowns, and few enough that each spans a good piece of the scene.
const SPLITS: u32 = 4;

/// The factor on the variance, at least `least`, of what pieces say at the optimum.
pub(super) fn design_effect(placed: &[PlacedEquations], least: f64) -> f64 {
    let places: Vec<Point3<f64>> = placed.iter().map(|p| p.place).collect();
    let mut all = NormalEquations::default();
    placed.iter().for_each(|one| all.merge(&one.sums, 1.0));
    let Some(covariance) = all.full().try_inverse() else { return 1.0 };
    let mut indices: Vec<usize> = (0..places.len()).collect();
    let unknowns = Motion::Similarity.unknowns() as f64;
    let mut effect = 0.0;
    for block in blocks(&places, &mut indices, SPLITS) {
        let gradient = block.iter().map(|&i| placed[i].sums.gradient).sum::<Vector7>();
        effect += gradient.dot(&(covariance * gradient)) / unknowns;
    }
    if effect.is_finite() { effect.max(least) } else { 1.0 }
}

/// Halves the points along their longest side, and the halves again.
fn blocks<'a>(places: &[Point3<f64>], indices: &'a mut [usize], splits: u32) -> Vec<&'a [usize]> {
    if splits == 0 || indices.len() < 2 {
        return vec![indices];
    }
    let extent = |axis: usize| {
        let (low, high) = indices
            .iter()
            .map(|&i| places[i][axis])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        high - low
    };
    let axis = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
    indices.sort_by(|&a, &b| places[a][axis].total_cmp(&places[b][axis]).then(a.cmp(&b)));
    let (low, high) = indices.split_at_mut(indices.len() / 2);
    let mut all = blocks(places, low, splits - 1);
    all.extend(blocks(places, high, splits - 1));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robust::Random;

    /// Seven unknowns, each measured by `repeats` rows in a row with the same error: the estimate's variance is so many times
    /// what independent rows would have.
    fn effect_of_repeats(repeats: usize) -> f64 {
        const ROWS: usize = 7 * 1024;
        let mut placed = Vec::new();
        let mut random = Random::stream(1, 0);
        let mut error = 0.0;
        for i in 0..ROWS {
            let k = i / repeats;
            if i % repeats == 0 {
                // Uniform with variance 1.
                error = (random.unit() - 0.5) * 12f64.sqrt();
            }
            let mut row = Vector7::zeros();
            row[k % 7] = 1.0;
            let mut one = NormalEquations::default();
            one.add(&row, error, 1.0);
            placed.push(PlacedEquations { place: Point3::new(i as f64, 0.0, 0.0), sums: one });
        }
        design_effect(&placed, 0.04)
    }

    #[test]
    fn is_about_one_for_independent_errors_and_the_number_of_repeats_for_repeated_ones() {
        let (one, eight) = (effect_of_repeats(1), effect_of_repeats(8));
        // Seven unknowns in sixteen blocks: 112 squares, so 13 % of scatter.
        assert!((0.6..1.4).contains(&one), "{one}");
        assert!((0.6..1.4).contains(&(eight / 8.0)), "{eight}");
    }

    #[test]
    fn blocks_are_of_equal_size_and_hold_neighbours() {
        let places: Vec<Point3<f64>> = (0..64).map(|i| Point3::new(f64::from((i * 37) % 64), 0.0, 0.0)).collect();
        let mut indices: Vec<usize> = (0..64).collect();
        let found = blocks(&places, &mut indices, SPLITS);
        assert_eq!(found.len(), 16);
        for block in found {
            let xs: Vec<f64> = block.iter().map(|&i| places[i].x).collect();
            assert!(xs.len() == 4 && xs[3] - xs[0] == 3.0, "{xs:?}");
        }
    }
}
