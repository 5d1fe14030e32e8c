//! Six or seven points on planes in any distribution: three quadrics and their octic.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, however they are distributed
//! Given       se3_6pt: 6 rows; sim3_7pt: 7 rows; no row is special
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R(q) p + t) + d = 0 with the unit quaternion q = (w, x, y, z)
//! Method      1. n . R(q) p is a quadratic form in q. With p taken from the centroid and X the centroid's image, a row is
//!                n . X + d |q|^2 + form(q) = 0 (rigid; the offset joins the form, since |q| = 1 may be multiplied in) or
//!                n . X + d + s form(q) = 0 (similarity).
//!             2. Reflections remove X (and d for a similarity) from the last three rows: three homogeneous quadrics
//!                q^T K_k q = 0. By Bezout they meet in 8 points, q and -q being one. They are made orthonormal, so that
//!                sizes mean something.
//!             3. Call two of the coordinates Y, Z and the others X : W. Solve the three equations for Y^2, Z^2, YZ:
//!                    Y^2 = a1 Y + a2 Z + a3,   Z^2 = b1 Y + b2 Z + b3,   YZ = c1 Y + c2 Z + c3
//!                with coefficients of degree 1, 1, 2 in X : W. The identities Z (Y^2) = Y (YZ), Y (Z^2) = Z (YZ) and
//!                (Y^2)(Z^2) = (YZ)^2 become three equations linear in (Y, Z, 1); their determinant is an octic in X : W.
//!             4. For a real root (polynomial.rs) Y : Z : 1 spans the null space of the 3 x 3 matrix.
//!             5. The pair (Y, Z) is the one of six whose matrix of step 3 has the largest determinant; where all six are
//!                small (axis-aligned boxes), q is first turned by a fixed orthogonal matrix. Half-turns (w = 0) are not special.
//!             6. Newton on the sphere polishes every q. A root that leads nowhere, or an odd number of solutions, shows
//!                that two share a value of X : W; then the other charts are asked too and the answers joined.
//!             7. Substitution gives s and X.
//! Solutions   8 at most, 3.03 on average for six planes; similarities: those with s > 0, 2.72 on average for seven planes
//! Degenerate  normals that do not span space, planes through one point (similarity), dependent quadrics: no pose.
//!             A curve of solutions: the octic is rounding noise, whatever it returns satisfies the rows but is one of many;
//!             degeneracy.rs tells
//! Scaling     equivariant in both frames; offsets should be taken about a near origin
//! Source      Kukelova, Heller, Fitzgibbon, "Efficient intersection of three quadrics and applications in computer
//!             vision" (CVPR 2016); homogeneous form, choice of charts and polish: mathematics.md sections 3, 6, 7
//! Cost        1.87 us rigid, 2.39 us similarity (benches/solvers, shared 2-core EPYC, 2026-11-25); worst residual of 100,000
//!             1.2e-15 of the scene
//! Tests       below; tests/solver_accuracy.rs; golden/*.json
//! ```

use super::elimination::{back_substitute, diagonal_holds, eliminate};
use super::polynomial::real_roots;
use super::quaternion::{MONOMIALS, Quaternion, form, monomials, product, rotation, value};
use super::{MOST_POSES, Poses, RANK_TOLERANCE, Row};
use crate::geometry::{Rotation3, Similarity, Vector3};

/// A homogeneous quadric in q: coefficients of the ten monomials of `quaternion::MONOMIALS`.
pub(super) type Quadric = [f64; 10];

/// Charts whose determinant (of three orthonormal quadrics) is larger than this are not compared with turned ones.
const GOOD_CHART: f64 = 0.03;

/// Below this determinant a chart's octic is rounding noise.
const NO_CHART: f64 = 1e-9;

/// Newton steps on the sphere; one or two are usual, nearly double solutions take more.
const MOST_STEPS: usize = 25;

/// Largest value of the three orthonormal quadrics at an accepted unit quaternion.
const RESIDUAL: f64 = 1e-11;

/// Unit quaternions closer than this (squared, up to sign) are one solution: nearly double ones cannot be told apart
/// beyond the square root of the precision.
const SAME_SQ: f64 = 1e-14;

/// Rigid poses from six points on planes.
pub fn se3_6pt(rows: &[Row; 6]) -> Poses {
    rigid(rows, three_quadrics)
}

/// The same with every chart asked: for rows on which another solver has found that solutions share a root.
pub(super) fn se3_6pt_thorough(rows: &[Row; 6]) -> Poses {
    rigid(rows, three_quadrics_thorough)
}

#[inline]
fn rigid(rows: &[Row; 6], intersect: fn(&[Quadric; 3]) -> Intersection) -> Poses {
    let pivot = centroid(rows);
    let mut m = rows.map(|row| {
        let f = form(&row.normal, &(row.point - pivot));
        let d = row.offset;
        let n = row.normal;
        [n.x, n.y, n.z, f[0] + d, f[1] + d, f[2] + d, f[3] + d, f[4], f[5], f[6], f[7], f[8], f[9]]
    });
    eliminate::<6, 13, 3>(&mut m);
    let mut poses = Poses::none();
    if !diagonal_holds(&m) {
        return poses;
    }
    let quadrics: [Quadric; 3] = std::array::from_fn(|k| std::array::from_fn(|j| m[3 + k][3 + j]));
    for q in intersect(&quadrics).iter() {
        let mono = monomials(q);
        let right = std::array::from_fn(|i| -(0..10).map(|j| m[i][3 + j] * mono[j]).sum::<f64>());
        poses.push(pose(q, 1.0, back_substitute(&m, right), &pivot));
    }
    poses
}

/// Similarities from seven points on planes.
pub fn sim3_7pt(rows: &[Row; 7]) -> Poses {
    similarities(rows, three_quadrics)
}

/// The same with every chart asked.
pub(super) fn sim3_7pt_thorough(rows: &[Row; 7]) -> Poses {
    similarities(rows, three_quadrics_thorough)
}

#[inline]
fn similarities(rows: &[Row; 7], intersect: fn(&[Quadric; 3]) -> Intersection) -> Poses {
    let pivot = centroid(rows);
    let mut m = rows.map(|row| {
        let f = form(&row.normal, &(row.point - pivot));
        let n = row.normal;
        [n.x, n.y, n.z, row.offset, f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9]]
    });
    eliminate::<7, 14, 4>(&mut m);
    let mut poses = Poses::none();
    if !diagonal_holds(&m) {
        return poses;
    }
    let quadrics: [Quadric; 3] = std::array::from_fn(|k| std::array::from_fn(|j| m[4 + k][4 + j]));
    for q in intersect(&quadrics).iter() {
        let mono = monomials(q);
        let along: [f64; 4] = std::array::from_fn(|i| (0..10).map(|j| m[i][4 + j] * mono[j]).sum::<f64>());
        let scale = -m[3][3] / along[3];
        if scale > 0.0 {
            let right = std::array::from_fn(|i| -(m[i][3] + scale * along[i]));
            poses.push(pose(q, scale, back_substitute(&m, right), &pivot));
        }
    }
    poses
}

fn centroid(rows: &[Row]) -> Vector3<f64> {
    rows.iter().map(|row| row.point).sum::<Vector3<f64>>() / rows.len() as f64
}

#[inline]
fn pose(q: &Quaternion, scale: f64, image: [f64; 3], pivot: &Vector3<f64>) -> Similarity {
    let rotation = rotation(q);
    let translation = Vector3::from(image) - scale * (rotation * pivot);
    Similarity { scale, rotation: Rotation3::from_matrix_unchecked(rotation), translation }
}

/// Distinct real common points of three quadrics, as unit quaternions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intersection {
    points: [Quaternion; MOST_POSES],
    len: usize,
    /// Every real root of an octic led to a point of its own.
    clean: bool,
}

impl std::ops::Deref for Intersection {
    type Target = [Quaternion];

    fn deref(&self) -> &[Quaternion] {
        &self.points[..self.len]
    }
}

impl Intersection {
    fn keep(&mut self, q: Quaternion) -> bool {
        let same = |other: &Quaternion| {
            let sign = (0..4).map(|i| other[i] * q[i]).sum::<f64>().signum();
            (0..4).map(|i| (other[i] - sign * q[i]) * (other[i] - sign * q[i])).sum::<f64>() < SAME_SQ
        };
        let new = self.len < MOST_POSES && !self.points[..self.len].iter().any(same);
        if new {
            self.points[self.len] = q;
            self.len += 1;
        }
        new
    }
}

/// The real common points: one chart where that is enough, the best chart of three turnings where it is not.
pub(super) fn three_quadrics(quadrics: &[Quadric; 3]) -> Intersection {
    let mut found = Intersection { points: [[0.0; 4]; MOST_POSES], len: 0, clean: true };
    let Some(quadrics) = orthonormal(quadrics) else { return found };
    let straight = Chart::best(&quadrics, None);
    if straight.determinant.abs() > GOOD_CHART {
        straight.intersect(&quadrics, &mut found);
        if found.clean && found.len.is_multiple_of(2) {
            return found;
        }
    }
    let mut charts = [straight, Chart::best(&quadrics, Some(0)), Chart::best(&quadrics, Some(1))];
    charts.sort_by(|a, b| b.determinant.abs().total_cmp(&a.determinant.abs()));
    for chart in &charts {
        found.clean = true;
        chart.intersect(&quadrics, &mut found);
        if found.clean && found.len.is_multiple_of(2) {
            break;
        }
    }
    found
}

/// Every real common point that any of the three turnings finds; dearer than `three_quadrics`, for single problems and for
/// samples that are known to be special.
pub(super) fn three_quadrics_thorough(quadrics: &[Quadric; 3]) -> Intersection {
    let mut found = Intersection { points: [[0.0; 4]; MOST_POSES], len: 0, clean: true };
    let Some(quadrics) = orthonormal(quadrics) else { return found };
    for turning in [None, Some(0), Some(1)] {
        Chart::best(&quadrics, turning).intersect(&quadrics, &mut found);
    }
    found
}

/// Gram and Schmidt on the symmetric matrices; `None` where the quadrics are dependent.
fn orthonormal(quadrics: &[Quadric; 3]) -> Option<[Quadric; 3]> {
    let mut out = *quadrics;
    for k in 0..3 {
        let size = dot(&out[k], &out[k]).sqrt();
        if !(size > 0.0) {
            return None;
        }
        out[k] = out[k].map(|v| v / size);
        for j in 0..k {
            let overlap = dot(&out[k], &out[j]);
            for i in 0..10 {
                out[k][i] -= overlap * out[j][i];
            }
        }
        let rest = dot(&out[k], &out[k]).sqrt();
        if !(rest > RANK_TOLERANCE) {
            return None;
        }
        out[k] = out[k].map(|v| v / rest);
    }
    Some(out)
}

/// Frobenius product of the matrices: the coefficient of a mixed monomial stands for two entries of half its size.
#[inline]
fn dot(a: &Quadric, b: &Quadric) -> f64 {
    let squares: f64 = (0..4).map(|j| a[j] * b[j]).sum();
    squares + 0.5 * (4..10).map(|j| a[j] * b[j]).sum::<f64>()
}

/// Which coordinates are Y, Z, X, W, and what the coordinates are: q itself, or q = left q' right.
#[derive(Clone, Copy)]
struct Chart {
    turning: Option<usize>,
    order: [usize; 4],
    determinant: f64,
    quadrics: [Quadric; 3],
}

const ORDERS: [[usize; 4]; 6] = [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];

/// Place of the monomial of coordinates i and j.
const PLACE: [[usize; 4]; 4] = [[0, 4, 5, 6], [4, 1, 7, 8], [5, 7, 2, 9], [6, 8, 9, 3]];

/// Two fixed turnings q = left q' right, unit quaternions without any relation to axes or to each other: square roots in
/// the proportions (1, 2, 3, 5), (7, 1, 2, 3) and (3, 11, 1, 6), (2, 5, 13, 1), signs mixed.
const TURNINGS: [[Quaternion; 2]; 2] = [
    [
        [0.301511344577764, 0.426401432711221, -0.522232967867094, 0.674199862463242],
        [0.733799385705343, -0.277350098112615, 0.392232270276368, 0.480384461415261],
    ],
    [
        [-0.377964473009227, 0.723746864455746, 0.218217890235992, 0.534522483824849],
        [0.308606699924184, 0.487950036474267, -0.786795792469443, 0.218217890235992],
    ],
];

impl Chart {
    fn best(quadrics: &[Quadric; 3], turning: Option<usize>) -> Chart {
        let quadrics = match turning {
            None => *quadrics,
            Some(t) => quadrics.map(|quadric| turned(&quadric, &TURNINGS[t])),
        };
        let mut best = Chart { turning, order: ORDERS[0], determinant: 0.0, quadrics };
        for order in ORDERS {
            let columns = [PLACE[order[0]][order[0]], PLACE[order[1]][order[1]], PLACE[order[0]][order[1]]];
            let [a, b, c] = columns.map(|j| Vector3::new(quadrics[0][j], quadrics[1][j], quadrics[2][j]));
            let determinant = a.cross(&b).dot(&c);
            if determinant.abs() > best.determinant.abs() {
                best = Chart { order, determinant, ..best };
            }
        }
        best
    }

    /// Adds the chart's points; clears `clean` where a root led to no point of its own.
    fn intersect(&self, quadrics: &[Quadric; 3], found: &mut Intersection) {
        if !(self.determinant.abs() > NO_CHART) {
            found.clean = false;
            return;
        }
        let system = Resultant::new(&self.solved());
        for root in real_roots(&system.octic()).iter() {
            let [y, z, x, w] = system.null_vector(root);
            let mut q = [0.0; 4];
            for (place, v) in self.order.iter().zip([y, z, x, w]) {
                q[*place] = v;
            }
            if let Some(t) = self.turning {
                q = product(&product(&TURNINGS[t][0], &q), &TURNINGS[t][1]);
            }
            match newton(quadrics, q) {
                Some(q) => found.clean &= found.keep(q),
                None => found.clean = false,
            }
        }
    }

    /// The coefficients of Y^2, Z^2 and YZ (rows a, b, c) as functions of the others: Y X, Y W, Z X, Z W, W^2, X W, X^2.
    fn solved(&self) -> [[f64; 7]; 3] {
        let [y, z, x, w] = self.order;
        let column = |i: usize, j: usize| {
            let place = PLACE[i][j];
            Vector3::new(self.quadrics[0][place], self.quadrics[1][place], self.quadrics[2][place])
        };
        let (a, b, c) = (column(y, y), column(z, z), column(y, z));
        let scale = -self.determinant.recip();
        let inverse = [b.cross(&c) * scale, c.cross(&a) * scale, a.cross(&b) * scale];
        let right = [column(y, x), column(y, w), column(z, x), column(z, w), column(w, w), column(x, w), column(x, x)];
        inverse.map(|row| right.map(|r| row.dot(&r)))
    }
}

/// The quadric in q' where q = left q' right.
fn turned(quadric: &Quadric, turning: &[Quaternion; 2]) -> Quadric {
    // Columns of the orthogonal matrix: images of the four units.
    let units: [Quaternion; 4] = std::array::from_fn(|i| {
        let mut unit = [0.0; 4];
        unit[i] = 1.0;
        product(&product(&turning[0], &unit), &turning[1])
    });
    let mut out = [0.0; 10];
    for (place, (i, j)) in MONOMIALS.iter().enumerate() {
        // u_i^T K u_j = (f(u_i + u_j) - f(u_i) - f(u_j)) / 2, twice for a mixed monomial.
        out[place] = if i == j {
            value(quadric, &units[*i])
        } else {
            let sum = std::array::from_fn(|k| units[*i][k] + units[*j][k]);
            value(quadric, &sum) - value(quadric, &units[*i]) - value(quadric, &units[*j])
        };
    }
    out
}

/// Product of polynomials in X : W, lowest power of X first; `P = N + M - 1`.
#[inline]
fn times<const N: usize, const M: usize, const P: usize>(a: &[f64; N], b: &[f64; M]) -> [f64; P] {
    let mut out = [0.0; P];
    for i in 0..N {
        for j in 0..M {
            out[i + j] += a[i] * b[j];
        }
    }
    out
}

#[inline]
fn sum<const N: usize, const T: usize>(terms: [[f64; N]; T]) -> [f64; N] {
    let mut out = [0.0; N];
    for term in terms {
        for i in 0..N {
            out[i] += term[i];
        }
    }
    out
}

#[inline]
fn minus<const N: usize>(a: [f64; N]) -> [f64; N] {
    a.map(|v| -v)
}

/// The 3 x 3 matrix that annihilates (Y, Z, 1); rows 1 and 2 have degrees (2, 2, 3), row 3 has (3, 3, 4).
struct Resultant {
    m11: [f64; 3],
    m12: [f64; 3],
    m13: [f64; 4],
    m21: [f64; 3],
    m23: [f64; 4],
    m31: [f64; 4],
    m32: [f64; 4],
    m33: [f64; 5],
}

impl Resultant {
    /// mathematics.md (11), line by line. The entry (2, 2) equals (1, 1).
    fn new(solved: &[[f64; 7]; 3]) -> Resultant {
        let linear = |row: &[f64; 7], k: usize| [row[2 * k + 1], row[2 * k]];
        let quadratic = |row: &[f64; 7]| [row[4], row[5], row[6]];
        let [a, b, c] = solved;
        let (a1, a2, a3) = (linear(a, 0), linear(a, 1), quadratic(a));
        let (b1, b2, b3) = (linear(b, 0), linear(b, 1), quadratic(b));
        let (c1, c2, c3) = (linear(c, 0), linear(c, 1), quadratic(c));
        let (n_c1, n_c2, n_c3) = (minus(c1), minus(c2), minus(c3));
        let alpha: [f64; 3] = sum([times(&a1, &b1), times(&n_c1, &c1)]);
        let beta: [f64; 3] = sum([times(&a2, &b2), times(&n_c2, &c2)]);
        let a2b1: [f64; 3] = times(&a2, &b1);
        let c1c2: [f64; 3] = times(&n_c1, &c2);
        let gamma: [f64; 3] = sum([times(&a1, &b2), a2b1, c1c2, c1c2]);
        // The last row's "- 2 c1 c3" and "+ gamma c1" join: (gamma - 2 c3) c1; likewise (alpha + b3) a1, (beta + a3) b1.
        let alpha_b3 = sum([alpha, b3]);
        let beta_a3 = sum([beta, a3]);
        let gamma_c3 = sum([gamma, n_c3, n_c3]);
        Resultant {
            m11: sum([a2b1, c1c2, n_c3]),
            m12: sum([times(&a1, &c2), beta_a3, times(&n_c1, &a2)]),
            m13: sum([times(&a1, &c3), times(&a2, &b3), times(&n_c1, &a3), times(&n_c2, &c3)]),
            m21: sum([alpha_b3, times(&b2, &c1), times(&n_c2, &b1)]),
            m23: sum([times(&b1, &a3), times(&b2, &c3), times(&n_c1, &c3), times(&n_c2, &b3)]),
            m31: sum([times(&alpha_b3, &a1), times(&beta_a3, &b1), times(&gamma_c3, &c1)]),
            m32: sum([times(&alpha_b3, &a2), times(&beta_a3, &b2), times(&gamma_c3, &c2)]),
            m33: sum([times(&alpha_b3, &a3), times(&beta, &b3), times(&sum([gamma, n_c3]), &c3)]),
        }
    }

    /// The determinant, by its last column.
    fn octic(&self) -> [f64; 9] {
        let Resultant { m11, m12, m13, m21, m23, m31, m32, m33 } = self;
        let first: [f64; 6] = sum([times(m21, m32), minus(times(m11, m31))]);
        let second: [f64; 6] = sum([times(m12, m31), minus(times(m11, m32))]);
        let third: [f64; 5] = sum([times(m11, m11), minus(times(m12, m21))]);
        sum([times(m13, &first), times(m23, &second), times(m33, &third)])
    }

    /// (Y, Z, X, W) at the root (X, W): the largest cross product of two rows is a multiple of (Y, Z, 1).
    fn null_vector(&self, root: &[f64; 2]) -> Quaternion {
        let [x, w] = *root;
        let cubic = |p: &[f64; 4]| p[0] * w * w * w + p[1] * x * w * w + p[2] * x * x * w + p[3] * x * x * x;
        let quadratic = |p: &[f64; 3]| p[0] * w * w + p[1] * x * w + p[2] * x * x;
        let quartic = |p: &[f64; 5]| quadratic(&[p[0], p[1], 0.0]) * w * w + quadratic(&[p[2], p[3], p[4]]) * x * x;
        let diagonal = quadratic(&self.m11);
        let rows = [
            Vector3::new(diagonal, quadratic(&self.m12), cubic(&self.m13)),
            Vector3::new(quadratic(&self.m21), diagonal, cubic(&self.m23)),
            Vector3::new(cubic(&self.m31), cubic(&self.m32), quartic(&self.m33)),
        ];
        let crosses = [rows[0].cross(&rows[1]), rows[1].cross(&rows[2]), rows[2].cross(&rows[0])];
        let mut v = crosses[0];
        for cross in &crosses[1..] {
            if cross.norm_squared() > v.norm_squared() {
                v = *cross;
            }
        }
        [v.x, v.y, x * v.z, w * v.z]
    }
}

/// Newton's method on the unit sphere: q moves by q e with e = (0, omega), the three tangents at q.
fn newton(quadrics: &[Quadric; 3], start: Quaternion) -> Option<Quaternion> {
    let mut q = unit(start)?;
    for _ in 0..MOST_STEPS {
        let [w, x, y, z] = q;
        let tangents = [[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]];
        let mut right = [0.0; 3];
        let mut jacobian = [Vector3::zeros(); 3];
        for k in 0..3 {
            // Half the gradient, K q.
            let [a, b, c, d, ab, ac, ad, bc, bd, cd] = quadrics[k];
            let half = [
                a * w + 0.5 * (ab * x + ac * y + ad * z),
                b * x + 0.5 * (ab * w + bc * y + bd * z),
                c * y + 0.5 * (ac * w + bc * x + cd * z),
                d * z + 0.5 * (ad * w + bd * x + cd * y),
            ];
            let along = |t: &Quaternion| half[0] * t[0] + half[1] * t[1] + half[2] * t[2] + half[3] * t[3];
            right[k] = -0.5 * along(&q);
            jacobian[k] = Vector3::new(along(&tangents[0]), along(&tangents[1]), along(&tangents[2]));
        }
        let [j0, j1, j2] = jacobian;
        let c12 = j1.cross(&j2);
        let omega = (c12 * right[0] + j2.cross(&j0) * right[1] + j0.cross(&j1) * right[2]) / j0.dot(&c12);
        let step = omega.norm_squared();
        if !(step < 1.0) {
            // On the spot already (a double point, exactly met), or gone astray.
            return (right.iter().all(|r| r.abs() < RESIDUAL)).then_some(q);
        }
        q = unit(std::array::from_fn(|i| {
            q[i] + omega.x * tangents[0][i] + omega.y * tangents[1][i] + omega.z * tangents[2][i]
        }))?;
        if step < 1e-17 {
            return Some(q);
        }
    }
    quadrics.iter().all(|quadric| value(quadric, &q).abs() < RESIDUAL).then_some(q)
}

#[inline]
fn unit(q: Quaternion) -> Option<Quaternion> {
    let square: f64 = q.iter().map(|v| v * v).sum();
    (square > 0.0 && square.is_finite()).then(|| {
        let inverse = square.sqrt().recip();
        q.map(|v| v * inverse)
    })
}
