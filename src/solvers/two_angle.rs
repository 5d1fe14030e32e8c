//! Two points on one plane: two angles and one octic, for rigid poses and similarities.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, two of them on the first plane
//! Given       se3_pair_4pt: 6 rows, the first two on one plane: (2,2,2) (2,2,1,1) (2,1,1,1,1);
//!             sim3_pair_5pt: 7 rows, the first two on one plane: (2,2,2,1) (2,2,1,1,1) (2,1,1,1,1,1)
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R p + t) + d = 0
//! Method      1. Axes (a, b, e) in the sensor, e along the pair; axes (c, f, n1) in the object, n1 the pair's plane. The
//!                pair's two rows say that n1 . X = -d1 for X the image of p_1, and n1 . R e = 0. Every such rotation is
//!                R = Rot_z(alpha) P Rot_z(beta), P the cyclic exchange of axes that lays e onto c: in these axes
//!                    [ -sin alpha cos beta   sin alpha sin beta   cos alpha ]
//!                R = [  cos alpha cos beta  -cos alpha sin beta   sin alpha ]
//!                    [  sin beta             cos beta             0         ]
//!             2. With X = (u, w, -d1) each further row is linear in u, w, delta = d - n1.n d1, and bilinear in
//!                (cos alpha, sin alpha, 1) and (cos beta, sin beta, 1). Reflections remove u, w (and delta for a similarity):
//!                two bilinear equations  a^T G_k b = 0 remain.
//!             3. For fixed alpha they are two lines, g_k = a^T G_k; they meet in h = g_1 x g_2, which must be on the
//!                circle: h_1^2 + h_2^2 = h_3^2. With cos alpha = (w^2 - x^2)/(w^2 + x^2), sin alpha = 2 x w/(w^2 + x^2) the g_k are
//!                quadratic in (x : w), h is quartic, and the condition is an octic. No chart can fail in alpha.
//!             4. Real roots (polynomial.rs), beta from h, Newton on (alpha, beta).
//!             5. Substitution gives s, u, w.
//! Solutions   8 at most, 3 to 5 on average; similarities: those with s > 0, 2.5 to 2.6 on average
//! Degenerate  where both lines coincide at some root (h = 0: axis-aligned boxes) the octic is blind to beta; a root that leads
//!             to no solution of its own, or an odd number of them, shows that some were lost: the three quadrics
//!             (quadrics.rs) take over, in all their charts.
//!             Normals that do not span space, coinciding points: no pose is returned
//! Scaling     differences to p_1; G_1, G_2 orthonormal; all tests are relative
//! Source      mathematics.md section 5; derived here
//! Cost        1.20 to 1.68 us (benches/solvers, shared 2-core EPYC, 2026-11-25); worst residual of 100,000 1.5e-15 of the scene
//! Tests       below; tests/solver_accuracy.rs; golden/rigid.json, similarity.json, hard.json
//! ```

use super::elimination::eliminate;
use super::frame::Axes;
use super::polynomial::real_roots;
use super::quadrics::{se3_6pt_thorough, sim3_7pt_thorough};
use super::{MOST_POSES, Poses, RANK_TOLERANCE, Row};
use crate::geometry::{Rotation3, Similarity, Vector3};

/// Columns of a row: u, w, delta, then the products of (cos alpha, sin alpha, 1) with (cos beta, sin beta, 1), row by row.
/// The product 1 * 1 comes last; only rigid problems have it.
type Columns = [f64; 12];

/// Two lines that meet at less than this angle (squared sine) do not say where: the octic is blind there.
const BLIND_SQ: f64 = 1e-14;

/// Newton steps from a root of the octic; one or two are usual, nearly double roots take more.
const MOST_STEPS: usize = 25;

/// Largest value of the two orthonormal bilinear equations at an accepted pair of angles.
const RESIDUAL: f64 = 1e-11;

/// Farthest that Newton travels from a root that stands for one solution, in cosines and sines.
const NEAR: f64 = 1e-3;

/// Angles closer than this (squared distance of cosines and sines) are one solution: nearly double roots cannot be told
/// apart beyond the square root of the precision.
const SAME_SQ: f64 = 1e-14;

/// cos alpha, sin alpha, cos beta, sin beta.
type Angles = [f64; 4];

/// Pairs of angles, and whether every root of the octic led to one of its own.
struct Found {
    angles: [Angles; MOST_POSES],
    len: usize,
    complete: bool,
}

/// The plane with two points: axes in either frame.
struct Pair {
    sensor: Axes,
    object: Axes,
    pivot: Vector3<f64>,
    /// Offset of the first plane.
    height: f64,
}

/// Rigid poses from six rows, the first two on one plane.
pub fn se3_pair_4pt(rows: &[Row; 6]) -> Poses {
    match from_two_angles(rows) {
        Some(poses) => poses,
        None => se3_6pt_thorough(rows),
    }
}

/// Similarities from seven rows, the first two on one plane.
pub fn sim3_pair_5pt(rows: &[Row; 7]) -> Poses {
    match scaled_from_two_angles(rows) {
        Some(poses) => poses,
        None => sim3_7pt_thorough(rows),
    }
}

/// `None` where the octic is blind.
fn from_two_angles(rows: &[Row; 6]) -> Option<Poses> {
    let mut poses = Poses::none();
    let Some(pair) = Pair::new(rows) else { return Some(poses) };
    let mut m: [Columns; 4] = std::array::from_fn(|i| {
        let mut columns = pair.columns(&rows[2 + i]);
        // A rigid problem's offset joins the constant term.
        columns[11] = columns[2];
        columns[2] = 0.0;
        columns
    });
    eliminate::<4, 12, 2>(&mut m);
    if !spans(&m) {
        return Some(poses);
    }
    let found = angles(&m[2], &m[3])?;
    for angles in &found.angles[..found.len] {
        poses.push(pair.pose(&m, angles, 1.0));
    }
    Some(poses)
}

/// `None` where the octic is blind.
fn scaled_from_two_angles(rows: &[Row; 7]) -> Option<Poses> {
    let mut poses = Poses::none();
    let Some(pair) = Pair::new(rows) else { return Some(poses) };
    let mut m: [Columns; 5] = std::array::from_fn(|i| pair.columns(&rows[2 + i]));
    eliminate::<5, 12, 3>(&mut m);
    if !spans(&m) {
        return Some(poses);
    }
    let found = angles(&m[3], &m[4])?;
    for angles in &found.angles[..found.len] {
        let scale = -m[2][2] / along(&m[2], angles);
        if scale > 0.0 {
            poses.push(pair.pose(&m, angles, scale));
        }
    }
    Some(poses)
}

impl Pair {
    #[inline]
    fn new(rows: &[Row]) -> Option<Pair> {
        let pivot = rows[0].point;
        let difference = rows[1].point - pivot;
        let length = difference.norm();
        // Also false for NaN.
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let sensor = Axes::about(&(difference / length));
        Some(Pair { sensor, object: Axes::about(&rows[0].normal), pivot, height: rows[0].offset })
    }

    #[inline]
    fn columns(&self, row: &Row) -> Columns {
        let [px, py, pz] = self.sensor.coordinates(&(row.point - self.pivot));
        let [nx, ny, nz] = self.object.coordinates(&row.normal);
        let delta = row.offset - nz * self.height;
        [nx, ny, delta, ny * px, -ny * py, nx * pz, -nx * px, nx * py, ny * pz, nz * py, nz * px, 0.0]
    }

    #[inline]
    fn pose(&self, m: &[Columns], angles: &Angles, scale: f64) -> Similarity {
        let [ca, sa, cb, sb] = *angles;
        let w = -(m[1][2] + scale * along(&m[1], angles)) / m[1][1];
        let u = -(m[0][2] + scale * along(&m[0], angles) + m[0][1] * w) / m[0][0];
        let image = self.object.vector(u, w, -self.height);
        let rotation = self.object.vector(-sa * cb, ca * cb, sb) * self.sensor.x.transpose()
            + self.object.vector(sa * sb, -ca * sb, cb) * self.sensor.y.transpose()
            + self.object.vector(ca, sa, 0.0) * self.sensor.z.transpose();
        let translation = image - scale * (rotation * self.pivot);
        Similarity { scale, rotation: Rotation3::from_matrix_unchecked(rotation), translation }
    }
}

/// Whether u and w follow from the first two, triangular, rows.
#[inline]
fn spans(m: &[Columns]) -> bool {
    m[0][0].abs() > RANK_TOLERANCE && m[1][1].abs() > RANK_TOLERANCE
}

/// n . R p of a row, or of a combination of rows.
#[inline]
fn along(row: &Columns, angles: &Angles) -> f64 {
    let [ca, sa, cb, sb] = *angles;
    ca * (row[3] * cb + row[4] * sb + row[5])
        + sa * (row[6] * cb + row[7] * sb + row[8])
        + (row[9] * cb + row[10] * sb + row[11])
}

/// All angles that satisfy two bilinear equations; `None` where the octic may have missed one.
fn angles(first: &Columns, second: &Columns) -> Option<Found> {
    let mut found = Found { angles: [[0.0; 4]; MOST_POSES], len: 0, complete: true };
    let size = dot(first, first).sqrt();
    let first = first.map(|v| v / size);
    let overlap = dot(&first, second);
    let mut second: Columns = std::array::from_fn(|j| second[j] - overlap * first[j]);
    let rest = dot(&second, &second).sqrt();
    second = second.map(|v| v / rest);
    if !(size > 0.0 && rest > RANK_TOLERANCE * (overlap.abs() + rest)) {
        return None;
    }
    let lines = [quadratic_lines(&first), quadratic_lines(&second)];
    for root in real_roots(&octic(&lines)).iter() {
        let start = meeting(&lines, root);
        match start.and_then(|start| newton(&first, &second, start)) {
            Some(solution) => found.complete &= found.keep(solution) && start.is_some_and(|s| is_near(&s, &solution)),
            None => found.complete = false,
        }
    }
    // Real roots come in pairs. An odd number means that one was lost or that two have merged.
    (found.complete && found.len.is_multiple_of(2)).then_some(found)
}

/// A root of the octic is as good as its digits. One from which Newton travels knew alpha but not beta: two solutions share
/// that alpha, and the other one would be lost.
#[inline]
fn is_near(start: &Angles, solution: &Angles) -> bool {
    (0..4).all(|i| (start[i] - solution[i]).abs() < NEAR)
}

#[inline]
fn dot(a: &Columns, b: &Columns) -> f64 {
    (3..12).map(|j| a[j] * b[j]).sum()
}

/// The line (cos beta, sin beta, 1) . g = 0 as quadratics in (x : w): g[j] = (w^2, x w, x^2) coefficients of entry j.
#[inline]
fn quadratic_lines(row: &Columns) -> [[f64; 3]; 3] {
    std::array::from_fn(|j| {
        let (cos, sin, one) = (row[3 + j], row[6 + j], row[9 + j]);
        [one + cos, 2.0 * sin, one - cos]
    })
}

#[inline]
fn cross_entry(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> [f64; 5] {
    let mut out = [0.0; 5];
    for i in 0..3 {
        for j in 0..3 {
            out[i + j] += a[i] * b[j] - c[i] * d[j];
        }
    }
    out
}

/// h_1^2 + h_2^2 - h_3^2 with h the cross product of the two lines.
#[inline]
fn octic(lines: &[[[f64; 3]; 3]; 2]) -> [f64; 9] {
    let [g, k] = lines;
    let h = [
        cross_entry(&g[1], &k[2], &g[2], &k[1]),
        cross_entry(&g[2], &k[0], &g[0], &k[2]),
        cross_entry(&g[0], &k[1], &g[1], &k[0]),
    ];
    let mut f = [0.0; 9];
    for i in 0..5 {
        for j in 0..5 {
            f[i + j] += h[0][i] * h[0][j] + h[1][i] * h[1][j] - h[2][i] * h[2][j];
        }
    }
    f
}

/// Both angles at a root of the octic; `None` where the two lines coincide.
#[inline]
fn meeting(lines: &[[[f64; 3]; 3]; 2], root: &[f64; 2]) -> Option<Angles> {
    let [x, w] = *root;
    let [ww, xw, xx] = [w * w, x * w, x * x];
    let [g, k] = lines.map(|line| Vector3::from(line.map(|e| e[0] * ww + e[1] * xw + e[2] * xx)));
    let h = g.cross(&k);
    if !(h.norm_squared() > BLIND_SQ * g.norm_squared() * k.norm_squared()) {
        return None;
    }
    let radius = h.x.hypot(h.y) * h.z.signum();
    let turn = (ww + xx).recip();
    Some([(ww - xx) * turn, 2.0 * xw * turn, h.x / radius, h.y / radius])
}

/// Newton's method on the two equations; `None` where it does not end on a solution.
#[inline]
fn newton(first: &Columns, second: &Columns, start: Angles) -> Option<Angles> {
    let mut at = start;
    for _ in 0..MOST_STEPS {
        let [ca, sa, cb, sb] = at;
        let evaluate = |r: &Columns| {
            let by_cos = r[3] * cb + r[4] * sb + r[5];
            let by_sin = r[6] * cb + r[7] * sb + r[8];
            let value = ca * by_cos + sa * by_sin + (r[9] * cb + r[10] * sb + r[11]);
            let d_alpha = ca * by_sin - sa * by_cos;
            let d_beta = cb * (ca * r[4] + sa * r[7] + r[10]) - sb * (ca * r[3] + sa * r[6] + r[9]);
            [value, d_alpha, d_beta]
        };
        let (e, f) = (evaluate(first), evaluate(second));
        let determinant = e[1] * f[2] - e[2] * f[1];
        let alpha = (e[2] * f[0] - e[0] * f[2]) / determinant;
        let beta = (e[0] * f[1] - e[1] * f[0]) / determinant;
        let step = alpha * alpha + beta * beta;
        if !(step < 1.0) {
            // On the spot already (a double root, exactly met), or gone astray.
            return (e[0].abs() + f[0].abs() < RESIDUAL).then_some(at);
        }
        at = [ca - sa * alpha, sa + ca * alpha, cb - sb * beta, sb + cb * beta];
        let (a, b) = ((at[0] * at[0] + at[1] * at[1]).sqrt(), (at[2] * at[2] + at[3] * at[3]).sqrt());
        at = [at[0] / a, at[1] / a, at[2] / b, at[3] / b];
        if step < 1e-17 {
            return Some(at);
        }
    }
    (along(first, &at).abs() + along(second, &at).abs() < RESIDUAL).then_some(at)
}

impl Found {
    /// False where the solution was there already.
    fn keep(&mut self, solution: Angles) -> bool {
        let same =
            |other: &Angles| (0..4).map(|i| (other[i] - solution[i]) * (other[i] - solution[i])).sum::<f64>() < SAME_SQ;
        let new = self.len < MOST_POSES && !self.angles[..self.len].iter().any(same);
        if new {
            self.angles[self.len] = solution;
            self.len += 1;
        }
        new
    }
}
