//! The similarity of points that are known in both frames, with its covariance.
//!
//! Method       closed form (Umeyama), then Gauss-Newton steps on sum |X - T x|^2 / sigma^2 in (rotation vector, translation, log scale) about
//!              the image c of the reconstruction's middle: a residual changes by -(omega x y + tau + sigma y), y = T x - c. Covariance:
//!              the inverse of the information, times chi^2 over the degrees of freedom where that is above one

use nalgebra::{SMatrix, SVector};

use crate::geometry::{Point3, Rotation3, Similarity, StartSigmas, Vector3, umeyama};
use crate::robust::median;

/// A point in both frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointCouple {
    pub in_sfm: Point3<f64>,
    pub in_city: Point3<f64>,
    /// Each axis, metres.
    pub sigma_m: f64,
}

#[derive(Clone, Debug)]
pub(super) struct PointFit {
    pub city_from_sfm: Similarity,
    /// About the reconstruction's middle.
    pub sigmas: StartSigmas,
    /// Indices of the couples that took part.
    pub believed: Vec<usize>,
    /// Root mean square distance of the believed points, metres.
    pub rms_m: f64,
}

/// Fewer points cannot tell which of them is wrong.
const LEAST_FOR_CONSENSUS: usize = 5;
const MOST_TRIPLES: usize = 2000;
/// Beyond so many sigmas a point is wrong; the median of three Gaussian axes' length is 1.54 sigmas.
const GATE_SIGMAS: f64 = 5.0;
const MEDIAN_PER_SIGMA: f64 = 1.54;
const STEPS: usize = 10;

/// `None` where the points do not fix a similarity.
pub(super) fn point_fit(couples: &[PointCouple], middle: &Point3<f64>) -> Option<PointFit> {
    let believed = if couples.len() < LEAST_FOR_CONSENSUS { (0..couples.len()).collect() } else { consensus(couples)? };
    let of: Vec<PointCouple> = believed.iter().map(|&i| couples[i]).collect();
    let mut pose = closed_form(&of)?;
    let mut information = SMatrix::<f64, 7, 7>::zeros();
    for _ in 0..STEPS {
        let (step, held) = gauss_newton(&of, &pose, middle)?;
        (pose, information) = (moved(&pose, middle, &step), held);
    }
    let chi_sq: f64 = of.iter().map(|c| residual(c, &pose).norm_squared() / (c.sigma_m * c.sigma_m)).sum();
    let excess = (chi_sq / (3.0 * of.len() as f64 - 7.0).max(1.0)).max(1.0);
    let covariance = information.try_inverse()? * excess;
    let sigma = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let squares: f64 = of.iter().map(|c| residual(c, &pose).norm_squared()).sum();
    Some(PointFit {
        city_from_sfm: pose,
        sigmas: StartSigmas {
            position_m: sigma(3).max(sigma(4)),
            height_m: sigma(5),
            heading_rad: sigma(2),
            tilt_rad: sigma(0).max(sigma(1)),
            log_scale: sigma(6),
        },
        rms_m: (squares / of.len() as f64).sqrt(),
        believed,
    })
}

fn closed_form(couples: &[PointCouple]) -> Option<Similarity> {
    let pairs: Vec<_> = couples.iter().map(|c| (c.in_city, c.in_sfm)).collect();
    if pairs.len() < 3 { None } else { umeyama(&pairs) }
}

fn residual(couple: &PointCouple, pose: &Similarity) -> Vector3<f64> {
    couple.in_city - pose.apply(&couple.in_sfm)
}

/// The points that most triples' best agrees with.
fn consensus(couples: &[PointCouple]) -> Option<Vec<usize>> {
    let n = couples.len();
    let all = n * (n - 1) * (n - 2) / 6;
    let triples = (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
    let in_sigmas =
        |pose: &Similarity| -> Vec<f64> { couples.iter().map(|c| residual(c, pose).norm() / c.sigma_m).collect() };
    let poses = triples.step_by(all.div_ceil(MOST_TRIPLES).max(1)).filter_map(|t| closed_form(&t.map(|i| couples[i])));
    let (middling, pose) = poses
        .map(|pose| (median(&mut in_sigmas(&pose)).unwrap_or(f64::INFINITY), pose))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let gate = GATE_SIGMAS * (middling / MEDIAN_PER_SIGMA).max(1.0);
    let near = |pose: &Similarity, gate: f64| -> Vec<usize> {
        in_sigmas(pose).iter().enumerate().filter(|(_, r)| **r <= gate).map(|(i, _)| i).collect()
    };
    // A triple's pose is off at the others; that of all who agree is not.
    let agreeing: Vec<PointCouple> = near(&pose, 2.0 * gate).iter().map(|&i| couples[i]).collect();
    Some(near(&closed_form(&agreeing)?, gate))
}

fn gauss_newton(
    couples: &[PointCouple],
    pose: &Similarity,
    middle: &Point3<f64>,
) -> Option<(SVector<f64, 7>, SMatrix<f64, 7, 7>)> {
    let center = pose.apply(middle);
    let (mut information, mut right) = (SMatrix::<f64, 7, 7>::zeros(), SVector::<f64, 7>::zeros());
    for couple in couples {
        let y = pose.apply(&couple.in_sfm) - center;
        let mut by_unknown = SMatrix::<f64, 3, 7>::zeros();
        by_unknown.fixed_view_mut::<3, 3>(0, 0).copy_from(&-y.cross_matrix());
        by_unknown.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        by_unknown.set_column(6, &y);
        let weight = couple.sigma_m.powi(-2);
        information += by_unknown.transpose() * by_unknown * weight;
        right += by_unknown.transpose() * residual(couple, pose) * weight;
    }
    Some((information.try_inverse()? * right, information))
}

fn moved(pose: &Similarity, middle: &Point3<f64>, step: &SVector<f64, 7>) -> Similarity {
    let turn = Rotation3::new(step.fixed_rows::<3>(0).into_owned());
    let image = pose.apply(middle) + step.fixed_rows::<3>(3).into_owned();
    Similarity::about(middle, &image, pose.scale * step[6].exp(), turn * pose.rotation)
}
