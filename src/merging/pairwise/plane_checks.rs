//! What points on planes of superpixels say on whether two parts belong together.

use nalgebra::{SMatrix, SVector};

use super::decision::{PairChecks, PairDecision, Stretch, Words, mirrored};
use super::fit::{Fit, OwnFit};
use super::on_planes::{share_on_planes, too_few};
use super::plane_search::fit_planes;
use super::planes::{Measured, SharedPlanes};
use crate::geometry::{Matrix3, Vector3};
use crate::merging::fault::PairFault;
use crate::merging::limits::MergeLimits;
use crate::robust::quantile;

pub(super) struct PlaneChecks<'a> {
    pub planes: Option<&'a SharedPlanes>,
    pub found: Option<&'a OwnFit>,
    pub limits: &'a MergeLimits,
    pub seed: u64,
}

impl PairChecks for PlaneChecks<'_> {
    fn words(&self) -> Words {
        Words { holds: "planes of the superpixels", counted: "points on planes" }
    }

    fn shortage(&self) -> Option<PairDecision> {
        match self.planes {
            None => Some(PairDecision::Open(PairFault::NoSuperpixels)),
            Some(planes) => too_few(planes, &self.limits.decision).map(PairDecision::Open),
        }
    }

    fn fit(&self) -> Result<&Fit, PairFault> {
        self.found.map(|found| &found.fit).ok_or(PairFault::NoSimilarityOfPlanes)
    }

    /// Points lie on their planes, better than in the mirror and better than chance.
    fn disagreement(&self, fit: &Fit) -> Option<PairDecision> {
        let (planes, limits) = (self.planes?, &self.limits.decision);
        let share = share_on_planes(planes, &fit.a_from_b, self.limits.sources.on_plane);
        if let Some(decision) = mirrored(self.best_share(&planes.mirrored()) / share, limits) {
            return Some(decision);
        }
        let by_chance = self.best_share(&planes.shuffled());
        let is_chance = share < limits.agreeing_share || share < limits.chance_factor * by_chance;
        is_chance.then_some(PairDecision::Rejected(PairFault::FewPointsOnPlanes { share, by_chance }))
    }

    /// The affine map x + M y + t, y = (x - c) / rho, that lays the points best on their planes.
    fn stretch(&self, fit: &Fit) -> Option<Stretch> {
        let (planes, limits) = (self.planes?, &self.limits.decision);
        let measured = planes.groups.iter().flat_map(|g| {
            g.points.iter().map(|p| g.measured(p, &fit.a_from_b, 0.0, planes.radius)).filter(|m| !m.is_beside)
        });
        let measured: Vec<Measured> = measured.collect();
        let center = measured.iter().map(|m| m.at.coords).sum::<Vector3<f64>>() / measured.len() as f64;
        let radius = planes.radius[0];
        let rows: Vec<SVector<f64, 12>> = measured.iter().map(|m| affine_row(m, &center, radius)).collect();
        let (mut normal, mut right) = (SMatrix::<f64, 12, 12>::zeros(), SVector::<f64, 12>::zeros());
        for (m, row) in measured.iter().zip(&rows) {
            normal += row * row.transpose();
            right -= row * m.residual;
        }
        let hold = limits.stretch_hold * normal.trace() / 12.0;
        (0..9).for_each(|k| normal[(k, k)] += hold);
        let solution = normal.cholesky()?.solve(&right);
        let affine = Matrix3::identity() + Matrix3::from_column_slice(&solution.as_slice()[..9]) / radius;
        let off = |(m, row): (&Measured, &SVector<f64, 12>)| (m.residual + row.dot(&solution)).abs();
        let mut by_affine: Vec<f64> = measured.iter().zip(&rows).map(off).collect();
        let mut by_similarity: Vec<f64> = measured.iter().map(|m| m.residual.abs()).collect();
        let values = affine.singular_values();
        let rest = quantile(&mut by_affine, limits.stretch_quantile)?
            / quantile(&mut by_similarity, limits.stretch_quantile)?.max(f64::MIN_POSITIVE);
        Some(Stretch { ratio: values.max() / values.min().max(f64::MIN_POSITIVE), rest })
    }
}

impl PlaneChecks<'_> {
    /// Share of the points that the best similarity lays on their planes.
    fn best_share(&self, planes: &SharedPlanes) -> f64 {
        let found = fit_planes(planes, self.limits, self.seed);
        found.map_or(0.0, |found| share_on_planes(planes, &found.fit.a_from_b, self.limits.sources.on_plane))
    }
}

/// Derivative of a point's distance from its plane in the nine of M, by columns, and the three of t.
fn affine_row(m: &Measured, center: &Vector3<f64>, radius: f64) -> SVector<f64, 12> {
    let outer = m.normal * ((m.at.coords - center) / radius).transpose();
    let mut row = SVector::<f64, 12>::zeros();
    row.fixed_rows_mut::<9>(0).copy_from_slice(outer.as_slice());
    row.fixed_rows_mut::<3>(9).copy_from(&m.normal);
    row
}

#[cfg(test)]
mod tests {
    use super::super::decision::stretched;
    use super::super::test_scene::scene;
    use super::*;
    use crate::geometry::Point3;

    fn decision(planes: &SharedPlanes) -> Option<PairDecision> {
        let limits = MergeLimits::default();
        let found = fit_planes(planes, &limits, 5).unwrap();
        let checks = PlaneChecks { planes: Some(planes), found: Some(&found), limits: &limits, seed: 5 };
        checks.disagreement(&found.fit).or_else(|| stretched(&checks.stretch(&found.fit)?, &limits.decision))
    }

    #[test]
    fn a_part_of_the_same_place_is_taken() {
        assert_eq!(decision(&scene(0.003, |x| *x)), None);
    }

    #[test]
    fn a_mirrored_part_is_refused() {
        let told = decision(&scene(0.003, |x| Point3::new(-x.x, x.y, x.z)));
        assert!(matches!(&told, Some(PairDecision::Rejected(PairFault::Mirrored))), "{told:?}");
    }

    #[test]
    fn a_stretched_part_is_refused() {
        let told = decision(&scene(0.003, |x| Point3::new(x.x, x.y, 1.12 * x.z)));
        assert!(
            matches!(&told, Some(PairDecision::Rejected(PairFault::Stretched { ratio })) if (1.06..1.2).contains(ratio)),
            "{told:?}"
        );
    }

    #[test]
    fn superpixels_of_another_photograph_are_refused() {
        let told = decision(&scene(0.003, |x| *x).shuffled());
        assert!(matches!(&told, Some(PairDecision::Rejected(PairFault::FewPointsOnPlanes { .. }))), "{told:?}");
    }
}
