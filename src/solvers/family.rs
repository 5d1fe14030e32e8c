//! The family's one entry: which solver serves a sample is decided by how its points are spread over the planes.

use std::fmt;

use super::minimal::{
    se3_6pt, se3_321, se3_322, se3_331, se3_332, se3_333, se3_3111, se3_pair_4pt, sim3_7pt, sim3_3211, sim3_31111,
    sim3_pair_5pt, upright_se3_4pt, upright_sim3_5pt,
};
use super::poses::Poses;
use super::row::Row;
use super::sought::Sought;

/// One configuration, and what a sample of it costs: for a choice by expected cost, time per sample times expected trials.
#[derive(Clone, Copy, Debug)]
pub struct Configuration {
    /// Points on each plane, largest first.
    pub points_per_plane: &'static [usize],
    /// Real poses on average, each of which must be scored (mathematics.md 13).
    pub poses: f64,
    /// Time of one solve, all poses: median of `benches/solvers` on one core of a shared EPYC, 2026-11-25. Ratios matter.
    pub solve_us: f64,
}

/// As the paper writes it: (3,2,1).
impl fmt::Display for Configuration {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points: Vec<String> = self.points_per_plane.iter().map(usize::to_string).collect();
        write!(out, "({})", points.join(","))
    }
}

const fn costs(points_per_plane: &'static [usize], poses: f64, solve_us: f64) -> Configuration {
    Configuration { points_per_plane, poses, solve_us }
}

/// Rigid samples: the paper's Table 1, the minimal ones first.
pub const RIGID: [Configuration; 10] = [
    costs(&[3, 2, 1], 4.0, 0.229),
    costs(&[3, 1, 1, 1], 2.745, 0.246),
    costs(&[2, 2, 2], 4.612, 1.616),
    costs(&[2, 2, 1, 1], 3.469, 1.312),
    costs(&[2, 1, 1, 1, 1], 3.135, 1.196),
    costs(&[1, 1, 1, 1, 1, 1], 3.026, 1.872),
    costs(&[3, 3, 1], 2.0, 0.177),
    costs(&[3, 2, 2], 1.0, 0.617),
    costs(&[3, 3, 2], 1.0, 0.149),
    costs(&[3, 3, 3], 1.0, 0.166),
];

/// Minimal samples of a similarity.
pub const SIMILARITY: [Configuration; 6] = [
    costs(&[3, 2, 1, 1], 2.152, 0.241),
    costs(&[3, 1, 1, 1, 1], 2.060, 0.292),
    costs(&[2, 2, 2, 1], 2.601, 1.681),
    costs(&[2, 2, 1, 1, 1], 2.524, 1.646),
    costs(&[2, 1, 1, 1, 1, 1], 2.585, 1.665),
    costs(&[1, 1, 1, 1, 1, 1, 1], 2.722, 2.386),
];

/// Minimal samples of a rigid pose with known vertical.
pub const UPRIGHT_RIGID: [Configuration; 2] = [costs(&[2, 1, 1], 2.0, 0.127), costs(&[1, 1, 1, 1], 2.0, 0.130)];

/// Minimal samples of a similarity with known vertical.
pub const UPRIGHT_SIMILARITY: [Configuration; 2] =
    [costs(&[2, 1, 1, 1], 1.526, 0.180), costs(&[1, 1, 1, 1, 1], 1.565, 0.180)];

impl Sought {
    /// The configurations that can be solved, with their costs.
    pub fn configurations(&self) -> &'static [Configuration] {
        match self {
            Sought::Rigid => &RIGID,
            Sought::Similarity => &SIMILARITY,
            Sought::UprightRigid(_) => &UPRIGHT_RIGID,
            Sought::UprightSimilarity(_) => &UPRIGHT_SIMILARITY,
        }
    }
}

/// All poses of a sample whose rows are grouped by plane: `points_per_plane` counts them, largest first, so that (3,2,1) is
/// `&[3, 2, 1]` with six rows. Takes the fastest solver of the table in `solvers`. A sample that none serves (wrong
/// number of rows, groups that do not add up) has no poses, like a degenerate one.
pub fn solve_minimal(sought: &Sought, points_per_plane: &[usize], rows: &[Row]) -> Poses {
    if points_per_plane.iter().sum::<usize>() != rows.len() {
        return Poses::none();
    }
    match sought {
        Sought::Rigid => rigid(points_per_plane, rows),
        Sought::Similarity => similarity(points_per_plane, rows),
        Sought::UprightRigid(up) => with(rows, |rows| upright_se3_4pt(rows, up)),
        Sought::UprightSimilarity(up) => with(rows, |rows| upright_sim3_5pt(rows, up)),
    }
}

/// Calls a solver of so many rows.
#[inline]
fn with<const M: usize>(rows: &[Row], solver: impl FnOnce(&[Row; M]) -> Poses) -> Poses {
    match rows.try_into() {
        Ok(rows) => solver(rows),
        Err(_) => Poses::none(),
    }
}

fn rigid(points_per_plane: &[usize], rows: &[Row]) -> Poses {
    match points_per_plane {
        [3, 2, 1] => with(rows, se3_321),
        [3, 1, 1, 1] => with(rows, se3_3111),
        [3, 3, 1] => with(rows, se3_331),
        [3, 2, 2] => with(rows, se3_322),
        [3, 3, 2] => with(rows, se3_332),
        [3, 3, 3] => with(rows, se3_333),
        [2, ..] => with(rows, se3_pair_4pt),
        _ => with(rows, se3_6pt),
    }
}

fn similarity(points_per_plane: &[usize], rows: &[Row]) -> Poses {
    match points_per_plane {
        [3, 2, 1, 1] => with(rows, sim3_3211),
        [3, 1, 1, 1, 1] => with(rows, sim3_31111),
        [2, ..] => with(rows, sim3_pair_5pt),
        _ => with(rows, sim3_7pt),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solvers::scene::{Random, sample};

    #[test]
    fn a_sample_with_the_wrong_number_of_rows_has_no_poses() {
        let rows = sample(&mut Random::stream(1, 0), &Sought::Rigid, &[3, 2, 1]).rows;
        assert!(solve_minimal(&Sought::Rigid, &[3, 2, 1], &rows[..5]).is_empty());
        assert!(solve_minimal(&Sought::Rigid, &[3, 2], &rows[..5]).is_empty());
        assert!(solve_minimal(&Sought::Similarity, &[3, 2, 1], &rows).is_empty());
        assert!(!solve_minimal(&Sought::Rigid, &[3, 2, 1], &rows).is_empty());
    }
}
