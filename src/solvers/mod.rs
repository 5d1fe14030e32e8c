//! Poses from points that lie on planes: the minimal solvers.
//!
//! A sensor measured points, an object consists of planes, and it is known which point lies on which plane. Sought is the
//! pose `x = s R p + t` that satisfies `n . x + d = 0` for every such pair (a [`Row`]). A minimal sample has as many rows as
//! the pose has unknowns; all its real poses with det R = +1 and s > 0 are returned, in a list without heap. An empty list
//! means that there is none, or that the sample is degenerate.
//!
//! Names tell the sample: first what is sought (`se3` rotation and translation, `sim3` a scale besides, `upright_` with
//! known vertical), then the points on each plane where these matter (`321` for (3,2,1); `pair_4pt`: two points on one
//! plane and four anywhere), else their number (`6pt`).
//!
//! | solver | points per plane | poses at most | on average |
//! |---|---|---|---|
//! | [`se3_321`] | (3,2,1) | 4 | 4 |
//! | [`se3_3111`] | (3,1,1,1) | 4 | 2.75 |
//! | [`se3_pair_4pt`] | (2,2,2), (2,2,1,1), (2,1,1,1,1) | 8 | 4.61, 3.47, 3.14 |
//! | [`se3_6pt`] | (1,1,1,1,1,1) and any other | 8 | 3.03 |
//! | [`se3_331`] | (3,3,1) | 4 | 2 |
//! | [`se3_322`], [`se3_332`], [`se3_333`] | (3,2,2), (3,3,2), (3,3,3) | 4 | 1 |
//! | [`sim3_3211`] | (3,2,1,1) | 4 | 2.15 |
//! | [`sim3_31111`] | (3,1,1,1,1) | 4 | 2.06 |
//! | [`sim3_pair_5pt`] | (2,2,2,1), (2,2,1,1,1), (2,1,1,1,1,1) | 8 | 2.60, 2.52, 2.59 |
//! | [`sim3_7pt`] | (1,1,1,1,1,1,1) and any other | 8 | 2.72 |
//! | [`upright_se3_4pt`] | (2,1,1), (1,1,1,1) | 2 | 2 |
//! | [`upright_sim3_5pt`] | (2,1,1,1), (1,1,1,1,1) | 2 | 1.53, 1.57 |
//!
//! [`solve_minimal`] picks by the points per plane.

// `!(a > b)` is meant: it refuses NaN. Loops over matrix indices read like the formulas that they are.
#![allow(clippy::neg_cmp_op_on_partial_ord, clippy::needless_range_loop)]

mod circle;
mod degeneracy;
mod elimination;
mod family;
mod frame;
mod general;
mod normalised;
mod polish;
mod polynomial;
mod poses;
mod quadrics;
mod quaternion;
mod row;
pub mod primitives;
pub mod problem;
pub mod scene;
mod singular;
mod triple;
mod two_angle;
mod two_triples;
mod upright;

pub use degeneracy::{Degeneracy, NOT_ISOLATED, WEAK, condition_at};
pub use family::{RIGID, SIMILARITY, Sought, UPRIGHT_RIGID, UPRIGHT_SIMILARITY, solve_minimal};
pub use general::{Solution, refine, solve};
pub use poses::{MOST_POSES, Poses};
pub use quadrics::{se3_6pt, sim3_7pt};
pub use row::Row;
pub use triple::{se3_321, se3_322, se3_3111, sim3_3211, sim3_31111};
pub use two_angle::{se3_pair_4pt, sim3_pair_5pt};
pub use two_triples::{se3_331, se3_332, se3_333};
pub use upright::{Up, upright_se3_4pt, upright_sim3_5pt};

/// What vanishes beside quantities of size 1: a diagonal entry of the triangular normals, the area of a triple, the
/// radius of a line's circle. Rounding leaves some 1e-16; random scenes come below 1e-10 once in ten thousand million.
const RANK_TOLERANCE: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::scene::{Chance, angle_between_rad, relative_residual, sample, up};
    use super::*;

    /// Truth found, residuals, distinctness and the average number of poses over random scenes.
    fn check(sought: &dyn Fn(&mut Chance) -> Sought, points_per_plane: &[usize], average: f64, band: f64) {
        const RUNS: usize = 3000;
        let mut chance = Chance::new(11);
        let (mut missed, mut total) = (0, 0);
        let mut errors = Vec::new();
        for run in 0..RUNS {
            let sought = sought(&mut chance);
            let case = sample(&mut chance, &sought, points_per_plane);
            let poses = solve_minimal(&sought, points_per_plane, &case.rows);
            total += poses.len();
            let errors_rad = poses.iter().map(|p| angle_between_rad(&p.rotation, &case.truth.rotation));
            let error = errors_rad.fold(f64::INFINITY, f64::min);
            missed += usize::from(error > 1e-5);
            errors.push(error);
            for (i, pose) in poses.iter().enumerate() {
                let residual = relative_residual(&case.rows, pose);
                assert!(residual < 1e-9, "{points_per_plane:?} run {run}: residual {residual:e}");
                assert!((pose.rotation.matrix().determinant() - 1.0).abs() < 1e-9);
                for other in &poses[..i] {
                    let apart = (pose.rotation.matrix() - other.rotation.matrix()).norm();
                    assert!(apart > 1e-8, "{points_per_plane:?} run {run}: twice the same pose ({apart:e})");
                }
            }
        }
        errors.sort_by(f64::total_cmp);
        let mean = total as f64 / RUNS as f64;
        println!(
            "{points_per_plane:?}: missed {missed}, mean {mean:.3}, median {:.1e}, 99.9 % {:.1e}",
            errors[RUNS / 2],
            errors[RUNS - 4]
        );
        assert_eq!(missed, 0, "{points_per_plane:?}");
        assert!(errors[RUNS / 2] < 1e-12);
        assert!((mean - average).abs() < band, "{points_per_plane:?}: {mean} poses on average, expected {average}");
    }

    #[test]
    fn rigid_samples_give_their_pose_back() {
        for (points, average, band) in [
            (&[3, 2, 1][..], 4.0, 1e-9),
            (&[3, 1, 1, 1], 2.745, 0.06),
            (&[2, 2, 2], 4.612, 0.08),
            (&[2, 2, 1, 1], 3.469, 0.08),
            (&[2, 1, 1, 1, 1], 3.135, 0.07),
            (&[1, 1, 1, 1, 1, 1], 3.026, 0.07),
            (&[3, 3, 1], 2.0, 1e-9),
            (&[3, 2, 2], 1.0, 1e-9),
            (&[3, 3, 2], 1.0, 1e-9),
            (&[3, 3, 3], 1.0, 1e-9),
        ] {
            check(&|_| Sought::Rigid, points, average, band);
        }
    }

    #[test]
    fn similarity_samples_give_their_pose_back() {
        for (points, average, band) in [
            (&[3, 2, 1, 1][..], 2.152, 0.07),
            (&[3, 1, 1, 1, 1], 2.060, 0.06),
            (&[2, 2, 2, 1], 2.601, 0.08),
            (&[2, 2, 1, 1, 1], 2.524, 0.08),
            (&[2, 1, 1, 1, 1, 1], 2.585, 0.08),
            (&[1, 1, 1, 1, 1, 1, 1], 2.722, 0.08),
        ] {
            check(&|_| Sought::Similarity, points, average, band);
        }
    }

    #[test]
    fn upright_samples_give_their_pose_back() {
        for points in [&[2, 1, 1][..], &[1, 1, 1, 1]] {
            check(&|chance| Sought::UprightRigid(up(chance)), points, 2.0, 1e-3);
        }
        for (points, average) in [(&[2, 1, 1, 1][..], 1.526), (&[1, 1, 1, 1, 1], 1.565)] {
            check(&|chance| Sought::UprightSimilarity(up(chance)), points, average, 0.04);
        }
    }
}
