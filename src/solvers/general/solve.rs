//! Any set of rows: normalise, test, solve, polish, judge.
//!
//! ```text
//! Problem     all poses that satisfy any set of rows, minimal or not, or the reason why none is isolated
//! Given       rows in any number, order and distribution over planes; normals of any length; origins and units of any size
//! Unknowns    as `Sought` says: 4 to 7
//! Equations   n . (s R p + t) + d = 0
//! Method      1. Points about their centroid in units of their spread; planes about x0, the point nearest to all of
//!                them, their offsets formed with twice the digits. Normals become unit vectors after that: with coordinates of
//!                5e6 a plain dot product would lose 1e-9 m, which the condition then multiplies.
//!             2. Structural tests (degeneracy.rs).
//!             3. Candidates for the rotation. Known vertical, or three points on a plane: an axis is known up to its
//!                sense, and every row that has lost t (and d) is a line that meets the circle. Otherwise, and besides: three
//!                quadrics in all charts (candidates.rs); of more than three, three fixed combinations.
//!             4. For a rotation, s and t by linear least squares; then Gauss and Newton on all rows. For a minimal problem this
//!                is Newton's method, for more rows it minimises the sum of squared distances.
//!             5. Kept are poses that satisfy all rows, with s > 0, each once. Poses that are not isolated are dropped; a
//!                problem that has no others is refused.
//! Solutions   as the table of `solvers` says; the twins of right-angled corners are all returned
//! Degenerate  refused with the reason (`Degeneracy`); nothing that leaves here is NaN
//! Scaling     units from 1e-12 to 1e12, coordinates to 2e5 times the spread (docs/golden.md, hard.json)
//! Source      mathematics.md sections 2, 10, 11, 12
//! Cost        about a millisecond, and a few microseconds for each further row: it is made for single problems, not for loops;
//!             it allocates
//! Tests       tests/solver_problems/, over the golden problems (docs/golden.md)
//! ```

use super::candidates::candidates;
use super::degeneracy::{Degeneracy, NOT_ISOLATED, condition};
use super::normalised::Normalised;
use super::polish::{Fit, polish};
use crate::geometry::{Similarity, Vector3};
use crate::solvers::row::Row;
use crate::solvers::sought::Sought;

/// Largest residual, over the spread of the images, of a pose that satisfies as many rows as it has unknowns: rounding, times
/// what an ill-conditioned translation makes of it. A nearly real complex pair leaves the square of its imaginary part.
const EXACT: f64 = 1e-11;

/// The same for more rows than unknowns, which are consistent only as far as their coordinates have digits.
const CONSISTENT: f64 = 1e-8;

/// What a far image adds to `EXACT`, as a share of its distance: nearly parallel planes put poses a million spreads away, where
/// the terms of a row cancel only to some 1e-15 of their size.
const FAR_ROUNDING: f64 = 1e-14;

/// Rotations (Frobenius norm) and scales (relative) closer than this are one solution.
const SAME: f64 = 1e-7;

/// One pose, and how well the rows hold it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    pub object_from_sensor: Similarity,
    /// Largest distance of an image from its plane, over the spread of the images.
    pub residual: f64,
    /// Smallest over largest singular value of the normalised Jacobian: 0 where the pose is not isolated.
    pub condition: f64,
}

/// All poses that satisfy all rows. `normal` may have any length here; equal rows count once.
pub fn solve(sought: &Sought, rows: &[Row]) -> Result<Vec<Solution>, Degeneracy> {
    let problem = Normalised::new(sought, rows)?;
    let (limit, far) = if problem.rows.len() == sought.unknowns() { (EXACT, FAR_ROUNDING) } else { (CONSISTENT, 0.0) };
    let mut fits: Vec<Fit> = candidates(&problem)?.iter().filter_map(|start| polish(&problem, start)).collect();
    judge_by_all_rows(&problem, &mut fits);
    fits.retain(|fit| fit.scale > 0.0 && fit.residual <= limit * fit.scale.max(1.0) + far * fit.translation.norm());
    // Of several approaches to one solution the best stays.
    fits.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    let mut isolated: Vec<Solution> = Vec::new();
    let mut singular = false;
    for fit in &fits {
        let solution = Solution {
            object_from_sensor: pose(&problem, fit),
            residual: fit.residual / fit.scale,
            condition: condition_of(&problem, fit),
        };
        if solution.condition < NOT_ISOLATED {
            singular = true;
        } else if solution.is_finite() && !isolated.iter().any(|other| solution.same(other)) {
            isolated.push(solution);
        }
    }
    if isolated.is_empty() && singular {
        return Err(Degeneracy::NotIsolated);
    }
    Ok(isolated)
}

impl Solution {
    /// Whether two polished poses are one: residuals divided by the condition say how far polishing may have left each
    /// from the solution.
    fn same(&self, other: &Solution) -> bool {
        let (a, b) = (&self.object_from_sensor, &other.object_from_sensor);
        let doubt = (self.residual + other.residual) / self.condition.min(other.condition);
        let same = SAME.max(10.0 * doubt);
        (a.rotation.matrix() - b.rotation.matrix()).norm() < same && (a.scale / b.scale - 1.0).abs() < same
    }

    fn is_finite(&self) -> bool {
        let pose = &self.object_from_sensor;
        let parts = pose.translation.iter().chain(pose.rotation.matrix()).chain([&pose.scale]);
        parts.chain([&self.residual, &self.condition]).all(|v| v.is_finite())
    }
}

fn condition_of(problem: &Normalised, fit: &Fit) -> f64 {
    // The centroid of the points is the origin, so the images of the points, without s and t, are the y of (14).
    let images: Vec<Vector3<f64>> = problem.rows.iter().map(|row| fit.rotation * row.point).collect();
    let normals: Vec<Vector3<f64>> = problem.rows.iter().map(|row| row.normal).collect();
    condition(&problem.sought, &images, &normals)
}

/// The least-squares pose of more rows than unknowns, from a start: Gauss and Newton on the sum of squared distances.
/// `None` where the rows do not determine it.
pub fn refine(sought: &Sought, rows: &[Row], start: &Similarity) -> Option<Similarity> {
    let problem = Normalised::new(sought, rows).ok()?;
    polish(&problem, start.rotation.matrix()).filter(|fit| fit.scale > 0.0).map(|fit| pose(&problem, &fit))
}

/// Largest absolute row where polishing has seen the rows joined into fewer forms.
fn judge_by_all_rows(problem: &Normalised, fits: &mut [Fit]) {
    if problem.forms.len() == problem.rows.len() {
        return;
    }
    for fit in fits {
        let turned = fit.rotation * fit.scale;
        let residual = |row: &Row| (row.normal.dot(&(turned * row.point + fit.translation)) + row.offset).abs();
        fit.residual = problem.rows.iter().map(residual).fold(0.0, f64::max);
    }
}

fn pose(problem: &Normalised, fit: &Fit) -> Similarity {
    problem.similarity(fit.scale, &fit.rotation, &fit.translation)
}
