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

#[cfg(test)]
mod tests {
    use super::*;

    fn truth() -> Similarity {
        let rotation = Rotation3::from_euler_angles(0.4, 2.0, -1.0);
        Similarity { scale: 1.7, rotation, translation: Vector3::new(3.0, -8.0, 1.0) }
    }

    fn couples(count: usize, noise_m: f64, seed: u64) -> Vec<PointCouple> {
        let mut random = crate::robust::Random::stream(seed, 0);
        let mut gaussian =
            || (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (std::f64::consts::TAU * random.unit()).cos();
        let couple = |i: usize| {
            let t = i as f64;
            let in_sfm = Point3::new(40.0 * (t * 0.7).sin(), 30.0 * (t * 1.3).cos(), 20.0 * (t * 0.31 + 1.0).sin());
            let noise = Vector3::new(gaussian(), gaussian(), gaussian()) * noise_m;
            PointCouple { in_sfm, in_city: truth().apply(&in_sfm) + noise, sigma_m: 0.1 }
        };
        (0..count).map(couple).collect()
    }

    #[test]
    fn the_sigmas_are_those_of_the_errors() {
        // Many draws: the mean square of each error over its variance is one.
        let (draws, middle) = (200, Point3::new(5.0, -5.0, 5.0));
        let mut squares = [0.0; 5];
        for seed in 0..draws {
            let fit = point_fit(&couples(12, 0.1, seed), &middle).unwrap();
            let (s, pose) = (fit.sigmas, fit.city_from_sfm);
            let shift = pose.apply(&middle) - truth().apply(&middle);
            let turn = (pose.rotation * truth().rotation.inverse()).scaled_axis();
            let errors = [
                shift.x / s.position_m,
                shift.z / s.height_m,
                turn.z / s.heading_rad,
                turn.x / s.tilt_rad,
                (pose.scale / truth().scale).ln() / s.log_scale,
            ];
            squares.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error / draws as f64);
        }
        // Residuals below the stated sigmas do not narrow them, and the worse of two axes is told.
        assert!(squares.iter().all(|square| (0.4..1.3).contains(square)), "{squares:?}");
    }

    #[test]
    fn a_point_counts_by_its_sigma() {
        let mut uneven = couples(4, 0.0, 1);
        uneven[3].in_city.x += 1.0;
        uneven[3].sigma_m = 100.0;
        let fit = point_fit(&uneven, &Point3::origin()).unwrap();
        let off = (fit.city_from_sfm.apply(&uneven[0].in_sfm) - uneven[0].in_city).norm();
        assert!(off < 1e-4 && fit.believed.len() == 4, "{off}");
    }

    #[test]
    fn too_few_points_and_points_on_a_line_fix_nothing() {
        assert!(point_fit(&couples(2, 0.0, 1), &Point3::origin()).is_none());
        let mut line = couples(6, 0.0, 1);
        for (k, couple) in line.iter_mut().enumerate() {
            couple.in_sfm = Point3::new(k as f64, 2.0 * k as f64, 0.0);
            couple.in_city = truth().apply(&couple.in_sfm);
        }
        assert!(point_fit(&line, &Point3::origin()).is_none());
    }
}
