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
//!                quadrics in all turnings (quadrics.rs); of more than three, three fixed combinations.
//!             4. For a rotation, s and t by linear least squares; then Gauss and Newton on all rows. For a minimal problem this
//!                is Newton's method, for more rows it minimises the sum of squared distances.
//!             5. Kept are poses that satisfy all rows, with s > 0, each once. Poses that are not isolated are dropped; a
//!                problem that has no others is refused.
//! Solutions   as the table of `solvers` says; the twins of right-angled corners are all returned
//! Degenerate  refused with the reason (`Degeneracy`); nothing that leaves here is NaN
//! Scaling     units from 1e-12 to 1e12, coordinates to 1e7 times the spread (golden/hard.json)
//! Source      mathematics.md sections 2, 10, 11, 12
//! Cost        about a millisecond, and a few microseconds for each further row: it is made for single problems, not for loops;
//!             it allocates
//! Tests       tests/solver_problems.rs; tools/score_solve.py over golden/*.json
//! ```

use super::degeneracy::{Degeneracy, NOT_ISOLATED, condition, meet_in_points};
use super::forms::triangular;
use super::frame::Axes;
use super::normalised::Normalised;
use super::polish::{Fit, polish};
use super::quadrics::{Quadric, three_quadrics_thorough};
use super::quaternion::{form_of, rotation};
use super::{Row, Sought};
use crate::geometry::{Matrix3, Rotation3, Similarity, Vector3};

/// Largest residual, over the spread of the images, of a pose that satisfies as many rows as it has unknowns: rounding, times
/// what an ill-conditioned translation makes of it. A nearly real complex pair leaves the square of its imaginary part.
const EXACT: f64 = 1e-11;

/// The same for more rows than unknowns, which are consistent only as far as their coordinates have digits.
const CONSISTENT: f64 = 1e-8;

/// ... and what a far image adds, as a share of its distance: nearly parallel planes put poses a million spreads away, where the
/// terms of a row cancel only to some 1e-15 of their size.
const FAR_ROUNDING: f64 = 1e-14;

/// Rotations (Frobenius norm) and scales (relative) closer than this are one solution.
const SAME: f64 = 1e-7;

/// A line whose radius is smaller than this beside the others says nothing of the angle.
const NO_LINE: f64 = 1e-11;

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
    problem.judge_by_all_rows(&mut fits);
    fits.retain(|fit| fit.scale > 0.0 && fit.residual <= limit * fit.scale.max(1.0) + far * fit.translation.norm());
    // Of several approaches to one solution the best stays.
    fits.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    let mut isolated: Vec<Solution> = Vec::new();
    let mut singular = false;
    for fit in &fits {
        let solution = Solution {
            object_from_sensor: problem.pose(fit),
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

/// Rotations to start from; every solution is near one of them.
fn candidates(problem: &Normalised) -> Result<Vec<Matrix3<f64>>, Degeneracy> {
    if let Sought::UprightRigid(up) | Sought::UprightSimilarity(up) = &problem.sought {
        let (found, lines) = about_axis(problem, &up.sensor_axes(), &up.object_axes());
        return if lines == 0 { Err(Degeneracy::FreeHeading) } else { Ok(found) };
    }
    let quadrics = quadrics_of(problem);
    let mut found = Vec::new();
    for seed in 0..if quadrics.len() == 3 { 1 } else { 2 } {
        let three = combined(&quadrics, seed).ok_or(Degeneracy::NotIsolated)?;
        if seed == 0 && !meet_in_points(&three) {
            return Err(Degeneracy::NotIsolated);
        }
        found.extend(three_quadrics_thorough(&three).iter().map(rotation));
    }
    if let Some((triple, normal)) = problem.largest_triangle() {
        for sense in [normal, -normal] {
            found.extend(about_axis(problem, &Axes::about(&triple), &Axes::about(&sense)).0);
        }
    }
    Ok(found)
}

/// Rotations that lay the third sensor axis onto the third object axis and satisfy one of the rows that remain when
/// the linear unknowns are gone; and the number of such rows that say something of the angle.
fn about_axis(problem: &Normalised, sensor: &Axes, object: &Axes) -> (Vec<Matrix3<f64>>, usize) {
    let mut rows: Vec<[f64; 7]> = Vec::with_capacity(problem.forms.len());
    for row in &problem.forms {
        let v = object.coordinates(&row.normal);
        // The point in the sensor's axes times the normal in the object's.
        let product = |v: &Vector3<f64>, y: &Vector3<f64>| v.dot(&(row.turning * y));
        let a = product(&object.x, &sensor.x) + product(&object.y, &sensor.y);
        let b = product(&object.y, &sensor.x) - product(&object.x, &sensor.y);
        let g = product(&object.z, &sensor.z);
        let (d, constant) = problem.sought.split(row.offset);
        rows.push([v[0], v[1], v[2], d, a, b, g + constant]);
    }
    let eliminated = problem.sought.linear_unknowns();
    triangular(&mut rows, eliminated);
    let mut found = Vec::new();
    let mut lines = 0;
    for row in &rows[eliminated..] {
        let [a, b, g] = [row[4], row[5], row[6]];
        let radius = a.hypot(b);
        if !(radius > NO_LINE * g.abs().max(1.0)) {
            continue;
        }
        lines += 1;
        // With more rows than unknowns a tangent line may pass beside the circle by more than rounding.
        let g = if g.abs() < radius * (1.0 + 1e-7) { g.clamp(-radius, radius) } else { g };
        let (angles, len) = super::circle::on_circle(a, b, g, 0.0);
        for [cos, sin] in &angles[..len] {
            let x = object.x * *cos + object.y * *sin;
            let y = object.y * *cos - object.x * *sin;
            found.push(x * sensor.x.transpose() + y * sensor.y.transpose() + object.z * sensor.z.transpose());
        }
    }
    (found, lines)
}

/// The rows as quadrics in q, free of the linear unknowns.
fn quadrics_of(problem: &Normalised) -> Vec<Quadric> {
    let mut rows: Vec<[f64; 14]> = Vec::with_capacity(problem.forms.len());
    for row in &problem.forms {
        let (d, constant) = problem.sought.split(row.offset);
        let mut out = [0.0; 14];
        out[..4].copy_from_slice(&[row.normal.x, row.normal.y, row.normal.z, d]);
        out[4..].copy_from_slice(&form_of(&row.turning));
        // |q|^2 = 1 turns a constant into a quadratic form.
        out[4..8].iter_mut().for_each(|square| *square += constant);
        rows.push(out);
    }
    let eliminated = problem.sought.linear_unknowns();
    triangular(&mut rows, eliminated);
    rows[eliminated..].iter().map(|row| std::array::from_fn(|j| row[4 + j])).collect()
}

/// Three general combinations of three or more quadrics; the weights are fixed numbers without structure.
fn combined(quadrics: &[Quadric], seed: usize) -> Option<[Quadric; 3]> {
    if let Ok(three) = quadrics.try_into() {
        return Some(three);
    }
    (quadrics.len() > 3).then(|| {
        std::array::from_fn(|k| {
            let mut out = [0.0; 10];
            for (i, quadric) in quadrics.iter().enumerate() {
                let weight = (1.0 + 2.3 * (k as f64 + 1.0) * (i as f64 + 1.7) + 0.9 * seed as f64).sin();
                for j in 0..10 {
                    out[j] += weight * quadric[j];
                }
            }
            out
        })
    })
}

impl Sought {
    /// Linear unknowns removed by reflections: the translation, and the constant 1 beside an unknown scale.
    fn linear_unknowns(&self) -> usize {
        if self.is_similarity() { 4 } else { 3 }
    }

    /// An offset as (column beside the translation, constant beside the rotation).
    fn split(&self, offset: f64) -> (f64, f64) {
        if self.is_similarity() { (offset, 0.0) } else { (0.0, offset) }
    }

    /// Whether the scale is sought too.
    pub fn is_similarity(&self) -> bool {
        matches!(self, Sought::Similarity | Sought::UprightSimilarity(_))
    }
}

/// The least-squares pose of more rows than unknowns, from a start: Gauss and Newton on the sum of squared distances.
/// `None` where the rows do not determine it.
pub fn refine(sought: &Sought, rows: &[Row], start: &Similarity) -> Option<Similarity> {
    let problem = Normalised::new(sought, rows).ok()?;
    polish(&problem, start.rotation.matrix()).filter(|fit| fit.scale > 0.0).map(|fit| problem.pose(&fit))
}

impl Normalised {
    /// Largest absolute row where polishing has seen the rows joined into fewer forms.
    fn judge_by_all_rows(&self, fits: &mut [Fit]) {
        if self.forms.len() == self.rows.len() {
            return;
        }
        for fit in fits {
            let turned = fit.rotation * fit.scale;
            let residual = |row: &Row| (row.normal.dot(&(turned * row.point + fit.translation)) + row.offset).abs();
            fit.residual = self.rows.iter().map(residual).fold(0.0, f64::max);
        }
    }

    fn pose(&self, fit: &Fit) -> Similarity {
        let scale = if self.sought.is_similarity() { fit.scale * self.unit / self.spread } else { 1.0 };
        let translation = self.near + self.unit * fit.translation - scale * (fit.rotation * self.centroid);
        Similarity { scale, rotation: Rotation3::from_matrix_unchecked(fit.rotation), translation }
    }
}
