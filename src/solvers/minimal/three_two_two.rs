//! Three points on one plane and two on each of two others: (3,2,2), one row more than a rigid pose has unknowns.
//!
//! ```text
//! Problem     rigid pose of a sensor from points that lie on three planes
//! Given       se3_322: 7 rows (3,2,2), grouped by plane in this order
//! Unknowns    rotation 3, translation 3; 7 rows
//! Equations   n . (R p + t) + d = 0
//! Method      1. The triple leaves one angle for each sense of its normal (triple.rs).
//!             2. The differences of the two pairs are two lines. The one that cuts the circle more steeply gives two angles, Gauss
//!                and Newton lay them between both, and the angles that leave the smallest misfit are kept.
//!             3. The points halfway between those of each pair give u, w.
//! Solutions   1, with planes at right angles the twins of mathematics.md 4.5: 2 or 4
//! Degenerate  collinear triple, normals that do not span space, pairs along m: no pose is returned
//! Scaling     differences to p_1; every test is relative to lengths in the data
//! Source      Ramalingam et al. 2010, section 3.1, in axes of our own; mathematics.md 4.4
//! Cost        0.62 us (benches/solvers, shared 2-core EPYC, 2026-11-25); residual 1e-15 of the scene as a rule, 1.3e-12 the
//!             worst of 100,000
//! Tests       tests/solver_accuracy.rs; tests/solver_problems/; golden/rigid.json
//! ```

use crate::solvers::elimination::{Eliminated, Scale};
use crate::solvers::minimal::triple::{Columns, Triple};
use crate::solvers::minimal::undecided::undecided;
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;
use crate::solvers::turn::{Line, Sense, Turn, line};

/// Gauss-Newton steps between the two lines, from the better one's angle.
const STEPS: usize = 3;

/// Two angles that cannot be told apart: a tangent is met to the square root of the precision only.
const SAME_ANGLE: f64 = 1e-7;

/// Rigid poses from rows (3,2,2).
pub fn se3_322(rows: &[Row; 7]) -> Poses {
    let mut poses = Poses::none();
    let Some(triple) = Triple::towards(rows, &rows[3].normal) else { return poses };
    let pairs = [triple.difference(&rows[3], &rows[4]), triple.difference(&rows[5], &rows[6])];
    let [first, second] = [[3, 4], [5, 6]].map(|[from, to]| (rows[to].point - rows[from].point).norm_squared());
    let size_sq = first.max(second);
    let middles = [triple.columns(&middle(&rows[5], &rows[6])), triple.columns(&middle(&rows[3], &rows[4]))];
    let Some(eliminated) = Eliminated::triangular(middles, Scale::Given) else { return poses };
    if !(size_sq > 0.0) {
        return poses;
    }
    let found = Sense::BOTH.map(|sense| turns_between(&pairs, sense, size_sq));
    let least = found.iter().flatten().flatten().map(|entry| entry.1).fold(f64::INFINITY, f64::min);
    for [first, second] in found {
        // A tangent gives the same angle twice.
        let second = second.filter(|second| !first.is_some_and(|first| same(&first.0, &second.0)));
        for (turn, misfit) in [first, second].into_iter().flatten() {
            if misfit.is_finite() && undecided(misfit, least) {
                triple.push(&mut poses, &eliminated, &turn);
            }
        }
    }
    poses
}

/// The row of the point halfway between two points of one plane.
#[inline]
fn middle(a: &Row, b: &Row) -> Row {
    Row { point: (a.point + b.point) * 0.5, ..*a }
}

fn same(a: &Turn, b: &Turn) -> bool {
    (a.cos - b.cos).abs() + (a.sin - b.sin).abs() < SAME_ANGLE
}

/// The turns that come nearest to two equations at once, with the misfit that they leave (a sine).
fn turns_between(pairs: &[Columns; 2], sense: Sense, size_sq: f64) -> [Option<(Turn, f64)>; 2] {
    let lines = pairs.map(|row| line(&row[3..], sense));
    let depth = lines.map(|[a, b, g]| a * a + b * b - g * g);
    let [a, b, g] = lines[usize::from(depth[1] > depth[0])];
    let radius = a.hypot(b);
    // Noise may lift the line off the circle: the nearest point is a good start.
    let starts = Turn::on([a, b, g.clamp(-radius, radius)], sense, size_sq);
    let mut found = [None; 2];
    for (slot, start) in found.iter_mut().zip(starts) {
        *slot = Some(between(&lines, start, size_sq));
    }
    found
}

/// From a turn to the one with the least sum of squares, and its misfit.
#[inline]
fn between(lines: &[Line; 2], start: Turn, size_sq: f64) -> (Turn, f64) {
    let (mut cos, mut sin) = (start.cos, start.sin);
    for _ in 0..STEPS {
        let (mut slope_sq, mut product) = (0.0, 0.0);
        for [a, b, g] in lines {
            let slope = b * cos - a * sin;
            slope_sq += slope * slope;
            product += slope * (a * cos + b * sin + g);
        }
        let step = if slope_sq > 0.0 { -product / slope_sq } else { 0.0 };
        (cos, sin) = (cos - sin * step, sin + cos * step);
        let norm = (cos * cos + sin * sin).sqrt();
        (cos, sin) = (cos / norm, sin / norm);
    }
    let misfit_sq: f64 = lines.iter().map(|[a, b, g]| (a * cos + b * sin + g) * (a * cos + b * sin + g)).sum();
    (Turn { cos, sin, ..start }, (misfit_sq / size_sq).sqrt())
}
