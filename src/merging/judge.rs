//! Whether two parts belong together at all: tests that are independent of the estimate, each with its reason in words.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::evidence::{Evidence, Pair};
use super::fit::{Fit, consensus, whitened};
use crate::geometry::Point3;

/// What is thought of a pair of parts.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Opinion {
    Together,
    /// They may belong together, but how is not fixed.
    Open(String),
    Apart(String),
}

/// Coincident keypoints must exceed chance by this factor, and by this many standard deviations of chance.
const CHANCE_FACTOR: f64 = 3.0;
const CHANCE_SIGMAS: f64 = 5.0;
/// Fewer pairs than this fix nothing.
const FEWEST_PAIRS: usize = 12;
/// Share of the pairs that must agree with the similarity.
const FEWEST_INLIERS: f64 = 0.5;
/// A part whose own points miss its own keypoints by more than this share of the width is no sound part.
const OWN_ERROR: f64 = 0.006;
/// Bend beyond which two parts are not the same thing, as a share of the radius.
const MOST_BEND: f64 = 0.02;
/// The shared cameras must agree with the pairs to this.
const MOST_TURN_DEG: f64 = 4.0;
const MOST_SHIFT: f64 = 0.06;
/// A mirrored part explains the pairs better by this factor where the part is a mirror image.
const MIRROR_FACTOR: f64 = 1.15;
/// A free stretch that is greater than this and leaves less than this share of the residual shows a stretched part.
const MOST_STRETCH: f64 = 1.06;
const STRETCH_GAIN: f64 = 0.6;
/// One sigma, share of the radius, beyond which a freedom is not determined: 0.15 % of the extent.
pub(super) const DETERMINED: f64 = 0.003;

/// `names` are the two parts'.
pub(super) fn judge(evidence: &Evidence, fit: Option<&Fit>, names: [&str; 2], seed: u64) -> Opinion {
    let pairs = evidence.pairs.len();
    let photos = evidence.photos.len();
    if let Some(reason) = unsound(evidence, names) {
        return Opinion::Apart(reason);
    }
    let needed = (CHANCE_FACTOR * evidence.chance).max(evidence.chance + CHANCE_SIGMAS * evidence.chance.sqrt());
    if (pairs as f64) <= needed || pairs < FEWEST_PAIRS {
        return Opinion::Apart(format!(
            "the {photos} photographs of one name show different keypoints: {pairs} of {} coincide, chance gives {:.0}; \
             they may be different photographs with the same name",
            evidence.fewer_keypoints, evidence.chance
        ));
    }
    let Some(fit) = fit else {
        return Opinion::Apart(format!("no similarity explains {pairs} point pairs"));
    };
    let inliers = fit.inlier_count();
    if (inliers as f64) < FEWEST_INLIERS * pairs as f64 || inliers < FEWEST_PAIRS {
        return Opinion::Apart(format!("only {inliers} of {pairs} point pairs agree with one similarity"));
    }
    let bend = fit.bend / evidence.radius_a;
    if bend > MOST_BEND {
        return Opinion::Apart(format!(
            "the point pairs disagree by {:.2} % of the extent, more than parts of one place do",
            50.0 * bend
        ));
    }
    shape(evidence, fit, seed)
        .or_else(|| cameras(evidence, fit, "point pairs"))
        .or_else(|| freedoms(evidence, fit, "point pairs"))
        .unwrap_or(Opinion::Together)
}

pub(super) fn unsound(evidence: &Evidence, names: [&str; 2]) -> Option<String> {
    let (which, error) = if evidence.own_error[0] >= evidence.own_error[1] {
        (names[0], evidence.own_error[0])
    } else {
        (names[1], evidence.own_error[1])
    };
    (error > OWN_ERROR).then(|| {
        format!(
            "{which} contradicts itself: its points miss its own keypoints by {:.1} % of the photograph's width",
            100.0 * error
        )
    })
}

/// Mirrored or stretched parts.
fn shape(evidence: &Evidence, fit: &Fit, seed: u64) -> Option<Opinion> {
    let upright: f64 = evidence
        .pairs
        .iter()
        .map(|p| crate::robust::vote(whitened(p, &fit.a_from_b, fit.bend).norm_squared(), 4.0))
        .sum();
    let mirrored: Vec<Pair> =
        evidence.pairs.iter().map(|p| Pair { in_b: Point3::from(-p.in_b.coords), ..p.clone() }).collect();
    let reflected = consensus(&mirrored, evidence.radius_a, fit.bend, seed);
    if reflected > MIRROR_FACTOR * upright {
        return Some(Opinion::Apart("one part is a mirror image of the other; only a reflection fits".to_owned()));
    }
    let (stretch, gain) = stretch(evidence, fit)?;
    (stretch > MOST_STRETCH && gain < STRETCH_GAIN).then(|| {
        Opinion::Apart(format!(
            "one part is stretched by {:.0} % along one axis against the other; no similarity fits",
            100.0 * (stretch - 1.0)
        ))
    })
}

/// Ratio of the extreme stretches of the affine map that fits the inliers best, and its residual over the similarity's.
fn stretch(evidence: &Evidence, fit: &Fit) -> Option<(f64, f64)> {
    let inliers: Vec<&Pair> = evidence.pairs.iter().zip(&fit.inliers).filter(|(_, i)| **i).map(|(p, _)| p).collect();
    let count = inliers.len() as f64;
    let moved: Vec<Vector3<f64>> = inliers.iter().map(|p| fit.a_from_b.apply(&p.in_b).coords).collect();
    let mean_x = moved.iter().sum::<Vector3<f64>>() / count;
    let mean_y = inliers.iter().map(|p| p.in_a.coords).sum::<Vector3<f64>>() / count;
    let mut xx = Matrix3::zeros();
    let mut yx: SMatrix<f64, 3, 3> = Matrix3::zeros();
    for (x, p) in moved.iter().zip(&inliers) {
        let (dx, dy) = (x - mean_x, p.in_a.coords - mean_y);
        xx += dx * dx.transpose();
        yx += dy * dx.transpose();
    }
    // Directions in which the pairs do not spread say nothing of stretch: they are held at that of the similarity.
    let hold = xx.trace() * 1e-2 * Matrix3::identity();
    let affine = (yx + hold) * (xx + hold).try_inverse()?;
    let mut by_affine: Vec<f64> =
        moved.iter().zip(&inliers).map(|(x, p)| (affine * (x - mean_x) - (p.in_a.coords - mean_y)).norm()).collect();
    let mut by_similarity: Vec<f64> = moved.iter().zip(&inliers).map(|(x, p)| (x - p.in_a.coords).norm()).collect();
    let values = affine.singular_values();
    let gain = super::sigma::median(&mut by_affine)? / super::sigma::median(&mut by_similarity)?.max(f64::MIN_POSITIVE);
    Some((values.max() / values.min(), gain))
}

/// Where the shared cameras stand, against the pairs.
pub(super) fn cameras(evidence: &Evidence, fit: &Fit, what: &str) -> Option<Opinion> {
    let mut best: Option<(f64, f64)> = None;
    for camera in &evidence.cameras {
        let turn = (fit.a_from_b.rotation * camera.a_from_b_rotation.inverse()).angle().to_degrees();
        let off = fit.a_from_b.apply(&camera.center_b) - camera.center_a;
        let allowed = MOST_SHIFT * evidence.radius_a.max(camera.depth_a) + 1.5 * camera.focal_doubt * camera.depth_a;
        let shift = off.norm() / allowed;
        if best.is_none_or(|(t, s)| turn / MOST_TURN_DEG + shift < t / MOST_TURN_DEG + s) {
            best = Some((turn, shift));
        }
    }
    let (turn, shift) = best?;
    (turn > MOST_TURN_DEG || shift > 1.0).then(|| {
        Opinion::Apart(format!(
            "the shared photograph's two poses contradict the {what} (turned by {turn:.1} deg, shifted by {shift:.1} \
             times what would be allowed)"
        ))
    })
}

pub(super) fn freedoms(evidence: &Evidence, fit: &Fit, what: &str) -> Option<Opinion> {
    let eigen = nalgebra::SymmetricEigen::new(fit.information);
    let weakest = eigen.eigenvalues.min();
    let sigma = if weakest > 0.0 { weakest.sqrt().recip() } else { f64::INFINITY };
    let share = sigma / evidence.radius_a;
    (share > DETERMINED).then(|| {
        Opinion::Open(format!(
            "{} {what} leave one freedom open to {:.2} % of the extent (one sigma); a further shared photograph would fix it",
            fit.inlier_count(),
            50.0 * share.min(1e4)
        ))
    })
}
