//! Whether two parts belong together, told by planes of superpixels alone.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::evidence::Evidence;
use super::judge::{Opinion, cameras, freedoms, unsound};
use super::plane_evidence::{Measured, PlaneEvidence};
use super::plane_fit::{PlaneFit, share_on_planes};
use super::plane_search::fit_planes;
use super::sigma::quantile;
use crate::geometry::Similarity;

/// Share of the points that must lie on their planes; of parts of two places a third can be made to.
pub(super) const FEWEST_ON_PLANES: f64 = 0.5;
/// Fewer planes and points fix nothing: seven unknowns, each at least three times over.
const FEWEST_PLANES: usize = 8;
const FEWEST_POINTS: usize = 21;
/// As many times better than points of other superpixels must the right points agree.
const CHANCE_FACTOR: f64 = 3.0;
/// By so much does a mirror image agree better where a part is one.
const MIRROR_FACTOR: f64 = 1.15;
/// A free stretch that is greater than this and leaves less than this share of the residual shows a stretched part.
const MOST_STRETCH: f64 = 1.06;
const STRETCH_GAIN: f64 = 0.6;
/// Residuals are compared at this quantile: a stretch along an axis leaves the planes along that axis where they are, which may be
/// more than half of all; wrong points are fewer than the rest.
const STRETCH_QUANTILE: f64 = 0.8;
/// How firmly the stretch is held at none where the planes say nothing of it: a share of what they say on average.
const STRETCH_HOLD: f64 = 1e-2;

pub(super) fn judge_planes(
    evidence: &Evidence,
    planes: Option<&PlaneEvidence>,
    found: Option<&PlaneFit>,
    names: [&str; 2],
    seed: u64,
) -> Opinion {
    if let Some(reason) = unsound(evidence, names) {
        return Opinion::Apart(reason);
    }
    let Some(planes) = planes else {
        return Opinion::Open(
            "no superpixel of the shared photographs has a plane in one part and points in the other".into(),
        );
    };
    if let Some(reason) = too_few(planes) {
        return Opinion::Open(reason);
    }
    let Some(found) = found else {
        return Opinion::Apart("no similarity lays the points of one part on the planes of the other".into());
    };
    agreement(planes, found, seed)
        .or_else(|| stretched(planes, &found.fit.a_from_b))
        .or_else(|| cameras(evidence, &found.fit, "planes of the superpixels"))
        .or_else(|| freedoms(evidence, &found.fit, "points on planes"))
        .unwrap_or(Opinion::Together)
}

/// Why the planes cannot be heard, if so.
pub(super) fn too_few(planes: &PlaneEvidence) -> Option<String> {
    let (groups, points) = (planes.groups.len(), planes.correspondences());
    (groups < FEWEST_PLANES || points < FEWEST_POINTS).then(|| {
        format!("the shared photographs have too few superpixels with a plane: {groups} with {points} points of the other part")
    })
}

/// Points lie on their planes, better than chance and better than in the mirror.
fn agreement(planes: &PlaneEvidence, found: &PlaneFit, seed: u64) -> Option<Opinion> {
    let share = share_on_planes(planes, &found.fit.a_from_b);
    let best = |other: &PlaneEvidence| fit_planes(other, seed).map_or(0.0, |f| share_on_planes(other, &f.fit.a_from_b));
    if best(&planes.mirrored()) > MIRROR_FACTOR * share {
        return Some(Opinion::Apart("one part is a mirror image of the other; only a reflection fits".into()));
    }
    let chance = best(&planes.shuffled());
    (share < FEWEST_ON_PLANES || share < CHANCE_FACTOR * chance).then(|| {
        Opinion::Apart(format!(
            "only {:.0} % of the points lie on the planes of their superpixels ({:.0} % on those of other superpixels); the \
             photographs may be different ones with the same name",
            100.0 * share,
            100.0 * chance
        ))
    })
}

fn stretched(planes: &PlaneEvidence, a_from_b: &Similarity) -> Option<Opinion> {
    let (stretch, gain) = stretch(planes, a_from_b)?;
    (stretch > MOST_STRETCH && gain < STRETCH_GAIN).then(|| {
        Opinion::Apart(format!(
            "one part is stretched by {:.0} % along one axis against the other; no similarity fits",
            100.0 * (stretch - 1.0)
        ))
    })
}

/// Ratio of the extreme stretches of the affine map x + M y + t, y = (x - c) / rho, that lays the points best on their planes, and
/// its residual over the similarity's.
fn stretch(planes: &PlaneEvidence, a_from_b: &Similarity) -> Option<(f64, f64)> {
    let rows: Vec<Measured> = planes
        .groups
        .iter()
        .flat_map(|g| g.points.iter().map(|p| g.measured(p, a_from_b, 0.0, planes.radius)))
        .filter(|m| !m.is_beside)
        .collect();
    let center = rows.iter().map(|m| m.at.coords).sum::<Vector3<f64>>() / rows.len() as f64;
    let radius = planes.radius[0];
    let row = |m: &Measured| {
        let outer = m.normal * ((m.at.coords - center) / radius).transpose();
        let mut row = SVector::<f64, 12>::zeros();
        row.fixed_rows_mut::<9>(0).copy_from_slice(outer.as_slice());
        row.fixed_rows_mut::<3>(9).copy_from(&m.normal);
        row
    };
    let (mut normal, mut right) = (SMatrix::<f64, 12, 12>::zeros(), SVector::<f64, 12>::zeros());
    for m in &rows {
        let row = row(m);
        normal += row * row.transpose();
        right -= row * m.residual;
    }
    let hold = STRETCH_HOLD * normal.trace() / 12.0;
    (0..9).for_each(|k| normal[(k, k)] += hold);
    let solution = normal.cholesky()?.solve(&right);
    let affine = Matrix3::identity() + Matrix3::from_column_slice(&solution.as_slice()[..9]) / radius;
    let mut by_affine: Vec<f64> = rows.iter().map(|m| (m.residual + row(m).dot(&solution)).abs()).collect();
    let mut by_similarity: Vec<f64> = rows.iter().map(|m| m.residual.abs()).collect();
    let values = affine.singular_values();
    let gain = quantile(&mut by_affine, STRETCH_QUANTILE)?
        / quantile(&mut by_similarity, STRETCH_QUANTILE)?.max(f64::MIN_POSITIVE);
    Some((values.max() / values.min().max(f64::MIN_POSITIVE), gain))
}

#[cfg(test)]
mod tests {
    use super::super::plane_scene::scene;
    use super::*;
    use crate::geometry::Point3;

    fn opinion(planes: &PlaneEvidence) -> Option<Opinion> {
        let found = fit_planes(planes, 5).unwrap();
        agreement(planes, &found, 5).or_else(|| stretched(planes, &found.fit.a_from_b))
    }

    #[test]
    fn a_part_of_the_same_place_is_taken() {
        assert_eq!(opinion(&scene(0.003, |x| *x)), None);
    }

    #[test]
    fn a_mirrored_part_is_refused() {
        let told = opinion(&scene(0.003, |x| Point3::new(-x.x, x.y, x.z)));
        assert!(matches!(&told, Some(Opinion::Apart(reason)) if reason.contains("mirror")), "{told:?}");
    }

    #[test]
    fn a_stretched_part_is_refused() {
        let told = opinion(&scene(0.003, |x| Point3::new(x.x, x.y, 1.12 * x.z)));
        assert!(matches!(&told, Some(Opinion::Apart(reason)) if reason.contains("stretched")), "{told:?}");
    }

    #[test]
    fn superpixels_of_another_photograph_are_refused() {
        let told = opinion(&scene(0.003, |x| *x).shuffled());
        assert!(matches!(&told, Some(Opinion::Apart(reason)) if reason.contains("lie on the planes")), "{told:?}");
    }

    #[test]
    fn a_handful_of_planes_is_too_few() {
        let mut planes = scene(0.003, |x| *x);
        assert_eq!(too_few(&planes), None);
        planes.groups.truncate(7);
        assert!(too_few(&planes).is_some());
    }
}
