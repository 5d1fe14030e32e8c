//! Three points on one plane, the others on others: closed forms for rigid poses and similarities.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, three of them on the first plane
//! Given       se3_321: 6 rows (3,2,1); se3_3111: 6 rows (3,1,1,1); sim3_3211: 7 rows (3,2,1,1);
//!             sim3_31111: 7 rows (3,1,1,1,1); se3_322: 7 rows (3,2,2); rows grouped by plane in this order
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R p + t) + d = 0
//! Method      1. The triple spans a plane of the sensor; with unit normal m of that plane, R m = sigma n1, sigma = +-1.
//!             2. Axes (a, b, m) in the sensor and (c, e, n1) in the object. In them R = Rot_z(theta) diag(1, sigma, sigma),
//!                so with y = coordinates of p - p_1 and v = coordinates of n
//!                v . R y = cos (v_x y_x + sigma v_y y_y) + sin (v_y y_x - sigma v_x y_y) + sigma v_z y_z.
//!             3. The first plane gives the height of X, the image of p_1, over itself: n1 . X = -d1. With X = (u, w, -d1)
//!                each further row reads  v_x u + v_y w + delta + s (cos .. + sin .. + ..) = 0,  delta = d - v_z d1.
//!             4. (3,2,1), (3,2,1,1): the difference of the pair's two rows holds neither u, w nor delta: a line and a
//!                circle for each sigma. (3,1,1,1): two reflections remove u, w. (3,1,1,1,1): three remove u, w, delta.
//!                (3,2,2): two such equations. The one that cuts the circle more steeply gives two angles, Gauss and Newton
//!                lay them between both equations, and the angles that leave the smallest misfit are kept.
//!             5. Similarity: the row that has lost u, w but not delta gives s. Two rows give u, w by substitution.
//! Solutions   4 at most, 2 for each sigma. (3,2,1): 4 whenever a pose exists; (3,1,1,1): 0, 2 or 4, 2.745 on average;
//!             (3,2,2): 1, with planes at right angles the twins of mathematics.md 4.5: 2 or 4;
//!             similarities: those with s > 0, 2.15 and 2.06 on average
//! Degenerate  collinear triple, normals that do not span space, the pair along m: no pose is returned
//! Scaling     differences to p_1; every test is relative to lengths in the data
//! Source      Ramalingam et al. (ECCV 2010), section 3.1, in axes of our own; mathematics.md 4.1 to 4.3 and 7
//! Cost        se3_321 0.23 us, se3_3111 0.25 us, se3_322 0.62 us, sim3_3211 0.24 us, sim3_31111 0.29 us (benches/solvers, shared
//!             2-core EPYC, 2026-11-25); residual 1e-15 of the scene as a rule, 1.3e-12 the worst of 100,000
//! Tests       below; tests/solver_accuracy.rs; golden/rigid.json, similarity.json
//! ```

use super::circle::on_circle;
use super::elimination::eliminate;
use super::frame::Axes;
use super::two_triples::undecided;
use super::{Poses, RANK_TOLERANCE, Row};
use crate::geometry::{Rotation3, Similarity, Vector3};

/// Columns of a row: the linear unknowns w, u and the constant delta, then the parts of v . R y that come with cos
/// (without and with sigma), with sin (without and with sigma), and with sigma alone.
type Columns = [f64; 8];

/// The plane with three points: axes in either frame.
struct Triple {
    sensor: Axes,
    object: Axes,
    pivot: Vector3<f64>,
    /// Offset of the first plane.
    height: f64,
}

/// Rotation about the first plane's normal, which side of it the sensor faces, and the scale.
#[derive(Clone, Copy)]
struct Turn {
    cos: f64,
    sin: f64,
    sigma: f64,
    scale: f64,
}

/// Rigid poses from rows (3,2,1).
pub fn se3_321(rows: &[Row; 6]) -> Poses {
    let mut poses = Poses::none();
    let Some(triple) = Triple::new(rows, Some(&rows[3].normal)) else { return poses };
    let pair = triple.difference(&rows[3], &rows[4]);
    let size_sq = (rows[4].point - rows[3].point).norm_squared();
    // The axis c was laid along plane 2's own direction, so its row has no w: the two rows are triangular as they are.
    let m = [triple.columns(&rows[5]), triple.columns(&rows[3])];
    if !spans(&m) {
        return poses;
    }
    for sigma in [1.0, -1.0] {
        for turn in turns(&pair, sigma, 0.0, size_sq) {
            poses.push(triple.pose(&m, &turn));
        }
    }
    poses
}

/// Rigid poses from rows (3,1,1,1).
pub fn se3_3111(rows: &[Row; 6]) -> Poses {
    let mut poses = Poses::none();
    let Some(triple) = Triple::new(rows, None) else { return poses };
    let mut m: [Columns; 3] = std::array::from_fn(|i| triple.columns(&rows[3 + i]));
    let size_sq = size_sq(&m);
    eliminate::<3, 8, 2>(&mut m);
    if !spans(&m) {
        return poses;
    }
    for sigma in [1.0, -1.0] {
        for turn in turns(&m[2], sigma, m[2][2], size_sq) {
            poses.push(triple.pose(&m, &turn));
        }
    }
    poses
}

/// Rigid poses from rows (3,2,2).
pub fn se3_322(rows: &[Row; 7]) -> Poses {
    let mut poses = Poses::none();
    let Some(triple) = Triple::new(rows, Some(&rows[3].normal)) else { return poses };
    let (first, second) = (rows[4].point - rows[3].point, rows[6].point - rows[5].point);
    let pairs = [triple.difference(&rows[3], &rows[4]), triple.difference(&rows[5], &rows[6])];
    let size_sq = first.norm_squared().max(second.norm_squared());
    let m = [triple.columns(&middle(&rows[5], &rows[6])), triple.columns(&middle(&rows[3], &rows[4]))];
    if !spans(&m) || !(size_sq > 0.0) {
        return poses;
    }
    let mut best = [(Turn { cos: 1.0, sin: 0.0, sigma: 1.0, scale: 1.0 }, f64::INFINITY); 4];
    for (slot, sigma) in [(0, 1.0), (2, -1.0)] {
        for (i, start) in turns_between(&pairs, sigma, size_sq).into_iter().flatten().enumerate() {
            best[slot + i] = start;
        }
    }
    let least = best.iter().map(|entry| entry.1).fold(f64::INFINITY, f64::min);
    for (slot, (turn, misfit)) in best.into_iter().enumerate() {
        // A tangent gives the same angle twice.
        let twice = slot % 2 == 1 && turn.nearly(&best[slot - 1].0);
        if misfit.is_finite() && undecided(misfit, least) && !twice {
            poses.push(triple.pose(&m, &turn));
        }
    }
    poses
}

/// Similarities from rows (3,2,1,1).
pub fn sim3_3211(rows: &[Row; 7]) -> Poses {
    let mut poses = Poses::none();
    let Some(triple) = Triple::new(rows, Some(&rows[3].normal)) else { return poses };
    let pair = triple.difference(&rows[3], &rows[4]);
    let size_sq = (rows[4].point - rows[3].point).norm_squared();
    let mut m = [&rows[5], &rows[6], &rows[3]].map(|row| triple.columns(row));
    eliminate::<3, 8, 2>(&mut m);
    if !spans(&m) {
        return poses;
    }
    for sigma in [1.0, -1.0] {
        for turn in turns(&pair, sigma, 0.0, size_sq) {
            triple.push_scaled(&mut poses, &m, &m[2], turn);
        }
    }
    poses
}

/// Similarities from rows (3,1,1,1,1).
pub fn sim3_31111(rows: &[Row; 7]) -> Poses {
    let mut poses = Poses::none();
    let Some(triple) = Triple::new(rows, None) else { return poses };
    let mut m: [Columns; 4] = std::array::from_fn(|i| triple.columns(&rows[3 + i]));
    let size_sq = size_sq(&m);
    eliminate::<4, 8, 3>(&mut m);
    if !spans(&m) {
        return poses;
    }
    for sigma in [1.0, -1.0] {
        for turn in turns(&m[3], sigma, 0.0, size_sq) {
            triple.push_scaled(&mut poses, &m, &m[2], turn);
        }
    }
    poses
}

impl Triple {
    /// Axes of the first three rows' plane; the object's first axis lies along `towards` as seen on the plane, where
    /// that is given. `None` for collinear points and for `towards` across the plane.
    #[inline]
    fn new(rows: &[Row], towards: Option<&Vector3<f64>>) -> Option<Triple> {
        let pivot = rows[0].point;
        let (first, second) = (rows[1].point - pivot, rows[2].point - pivot);
        let m = first.cross(&second);
        let (length, area) = (first.norm(), m.norm());
        // Also false for NaN.
        if !(area > RANK_TOLERANCE * length * second.norm()) {
            return None;
        }
        let (z, x) = (m / area, first / length);
        let sensor = Axes { x, y: z.cross(&x), z };
        let n = rows[0].normal;
        let object = match towards {
            None => Axes::about(&n),
            Some(towards) => {
                let across = n.cross(towards);
                let length = across.norm();
                if !(length > RANK_TOLERANCE) {
                    return None;
                }
                let y = across / length;
                Axes { x: y.cross(&n), y, z: n }
            }
        };
        Some(Triple { sensor, object, pivot, height: rows[0].offset })
    }

    #[inline]
    fn columns(&self, row: &Row) -> Columns {
        let y = self.sensor.coordinates(&(row.point - self.pivot));
        let v = self.object.coordinates(&row.normal);
        let delta = row.offset - v[2] * self.height;
        [v[1], v[0], delta, v[0] * y[0], v[1] * y[1], v[1] * y[0], v[0] * y[1], v[2] * y[2]]
    }

    /// The difference of two rows of one plane: no linear unknown is left.
    #[inline]
    fn difference(&self, from: &Row, to: &Row) -> Columns {
        let y = self.sensor.coordinates(&(to.point - from.point));
        let v = self.object.coordinates(&from.normal);
        [0.0, 0.0, 0.0, v[0] * y[0], v[1] * y[1], v[1] * y[0], v[0] * y[1], v[2] * y[2]]
    }

    /// Takes the scale from a row without u and w, and keeps the pose if it is no mirror image.
    #[inline]
    fn push_scaled(&self, poses: &mut Poses, m: &[Columns], scale_row: &Columns, turn: Turn) {
        let scale = -scale_row[2] / turn.along(scale_row);
        if scale > 0.0 {
            poses.push(self.pose(m, &Turn { scale, ..turn }));
        }
    }

    #[inline]
    fn pose(&self, m: &[Columns], turn: &Turn) -> Similarity {
        let Turn { cos, sin, sigma, scale } = *turn;
        let u = -(m[1][2] + scale * turn.along(&m[1])) / m[1][1];
        let w = -(m[0][2] + scale * turn.along(&m[0]) + m[0][1] * u) / m[0][0];
        let image = self.object.vector(u, w, -self.height);
        let x = self.object.x * cos + self.object.y * sin;
        let y = (self.object.y * cos - self.object.x * sin) * sigma;
        let rotation = x * self.sensor.x.transpose()
            + y * self.sensor.y.transpose()
            + (self.object.z * sigma) * self.sensor.z.transpose();
        let translation = image - scale * (rotation * self.pivot);
        Similarity { scale, rotation: Rotation3::from_matrix_unchecked(rotation), translation }
    }
}

impl Turn {
    /// Whether two angles cannot be told apart: a tangent is met to the square root of the precision only.
    fn nearly(&self, other: &Turn) -> bool {
        (self.cos - other.cos).hypot(self.sin - other.sin) < 1e-7
    }

    /// v . R y of a row, or of a combination of rows.
    #[inline]
    fn along(&self, row: &Columns) -> f64 {
        self.cos * (row[3] + self.sigma * row[4]) + self.sin * (row[5] - self.sigma * row[6]) + self.sigma * row[7]
    }
}

/// The angles that satisfy a row free of u and w, with `constant` besides v . R y.
#[inline]
fn turns(row: &Columns, sigma: f64, constant: f64, size_sq: f64) -> impl Iterator<Item = Turn> {
    let (angles, len) = on_circle(row[3] + sigma * row[4], row[5] - sigma * row[6], sigma * row[7] + constant, size_sq);
    (0..len).map(move |i| Turn { cos: angles[i][0], sin: angles[i][1], sigma, scale: 1.0 })
}

/// The row of the point halfway between two points of one plane.
#[inline]
fn middle(a: &Row, b: &Row) -> Row {
    Row { point: (a.point + b.point) * 0.5, ..*a }
}

/// The angles that come nearest to two equations at once, with the misfit that they leave (a sine).
fn turns_between(pairs: &[Columns; 2], sigma: f64, size_sq: f64) -> [Option<(Turn, f64)>; 2] {
    let equations = pairs.map(|row| [row[3] + sigma * row[4], row[5] - sigma * row[6], sigma * row[7]]);
    let depth = equations.map(|[a, b, g]| a * a + b * b - g * g);
    let [a, b, g] = equations[usize::from(depth[1] > depth[0])];
    let radius = a.hypot(b);
    // Noise may lift the line off the circle: the nearest point is a good start.
    let (angles, len) = on_circle(a, b, g.clamp(-radius, radius), size_sq);
    let mut found = [None; 2];
    for i in 0..len {
        let [mut cos, mut sin] = angles[i];
        for _ in 0..3 {
            let (mut slope_sq, mut product) = (0.0, 0.0);
            for [a, b, g] in equations {
                let slope = b * cos - a * sin;
                slope_sq += slope * slope;
                product += slope * (a * cos + b * sin + g);
            }
            let step = if slope_sq > 0.0 { -product / slope_sq } else { 0.0 };
            (cos, sin) = (cos - sin * step, sin + cos * step);
            let norm = cos.hypot(sin);
            (cos, sin) = (cos / norm, sin / norm);
        }
        let misfit_sq: f64 = equations.iter().map(|[a, b, g]| (a * cos + b * sin + g) * (a * cos + b * sin + g)).sum();
        found[i] = Some((Turn { cos, sin, sigma, scale: 1.0 }, (misfit_sq / size_sq).sqrt()));
    }
    found
}

/// The square of the size that the coefficients of cos and sin have in general; reflections do not change it.
#[inline]
fn size_sq(m: &[Columns]) -> f64 {
    m.iter().flat_map(|row| &row[3..]).map(|v| v * v).sum()
}

/// Whether u and w follow from the first two, triangular, rows.
#[inline]
fn spans(m: &[Columns]) -> bool {
    m[0][0].abs() > RANK_TOLERANCE && m[1][1].abs() > RANK_TOLERANCE
}
