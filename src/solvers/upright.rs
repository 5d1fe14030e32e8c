//! Known vertical: four points on planes for a rigid pose, five for a similarity.
//!
//! ```text
//! Problem     pose of a sensor whose vertical is known, from points that lie on planes
//! Given       upright_se3_4pt: 4 rows (2,1,1) or (1,1,1,1); upright_sim3_5pt: 5 rows (2,1,1,1) or (1,1,1,1,1)
//! Unknowns    heading theta, translation 3, and scale s for a similarity: 4 or 5; as many rows
//! Equations   n . (s R p + t) + d = 0, R = Rot(up_object, theta) R0 with R0 up_sensor = up_object
//! Method      1. axes with the vertical as third in either frame: y = coordinates of p - p_1, v = coordinates of n;
//!                there R is a turn about the third axis and
//!                v . R y = (v_x y_x + v_y y_y) cos + (v_y y_x - v_x y_y) sin + v_z y_z
//!             2. with T the image of p_1, each row is  v . T + d + s (a cos + b sin + g) = 0, linear in T and d
//!             3. rigid: four normals have one linear relation, its weights the volumes of the other three; summed with
//!                them the rows lose T: a cos + b sin + g + d = 0, a line and a circle. The three normals that span most give T
//!             4. similarity: three normals that span an ample volume take T off the other two rows; crosswise these lose d
//!                and give the line, along d they give s, the three rows T
//! Solutions   2 or 0; of a similarity those with s > 0 (the others are mirror images): 1.53 of 2 on random scenes
//! Degenerate  fewer than three directions of normals, normals in one plane (walls alone), a = b = 0 (heading free),
//!             similarity: planes through one point (scale free). A vanishing volume, or r = 0: no pose is returned
//! Scaling     differences to p_1; the solver is equivariant, offsets should be taken about a near origin
//! Source      mathematics.md section 8; derived here
//! Cost        0.13 us, similarity 0.18 us (benches/solvers, shared 2-core EPYC, 2026-11-25)
//! Tests       below; tests/solver_accuracy.rs; golden/gravity.json
//! ```

use super::circle::on_circle;
use super::frame::Axes;
use super::{Poses, RANK_TOLERANCE, Row};
use crate::geometry::{Matrix3, Rotation3, Similarity, Vector3};

/// The vertical in both frames, prepared once for many samples.
#[derive(Clone, Copy, Debug)]
pub struct Up {
    sensor: Axes,
    object: Axes,
}

impl Up {
    /// `None` where a vector has no direction. The vectors may have any length.
    pub fn new(sensor: &Vector3<f64>, object: &Vector3<f64>) -> Option<Up> {
        let unit = |v: &Vector3<f64>| {
            let scaled = v / v.amax();
            let unit = scaled.try_normalize(0.5)?;
            unit.iter().all(|c| c.is_finite()).then_some(unit)
        };
        Some(Up { sensor: Axes::about(&unit(sensor)?), object: Axes::about(&unit(object)?) })
    }

    /// Unit vertical in the sensor frame.
    pub fn in_sensor(&self) -> Vector3<f64> {
        self.sensor.z
    }

    /// Unit vertical in the object frame.
    pub fn in_object(&self) -> Vector3<f64> {
        self.object.z
    }

    pub(super) fn sensor_axes(&self) -> Axes {
        self.sensor
    }

    pub(super) fn object_axes(&self) -> Axes {
        self.object
    }

    /// The turn by `(cos, sin)` about the vertical, after the verticals have been laid onto each other.
    #[inline]
    pub(super) fn rotation(&self, cos: f64, sin: f64) -> Matrix3<f64> {
        let x = self.object.x * cos + self.object.y * sin;
        let y = self.object.y * cos - self.object.x * sin;
        x * self.sensor.x.transpose() + y * self.sensor.y.transpose() + self.object.z * self.sensor.z.transpose()
    }

    /// Coordinates of the normal, and the coefficients (a, b, g) of `cos`, `sin` and 1 in `n . R (p - pivot)`.
    #[inline]
    pub(super) fn coefficients(&self, row: &Row, pivot: &Vector3<f64>) -> ([f64; 3], [f64; 3]) {
        let y = self.sensor.coordinates(&(row.point - pivot));
        let v = self.object.coordinates(&row.normal);
        (v, [v[0] * y[0] + v[1] * y[1], v[1] * y[0] - v[0] * y[1], v[2] * y[2]])
    }

    #[inline]
    fn pose(&self, scale: f64, cos: f64, sin: f64, image: [f64; 3], pivot: &Vector3<f64>) -> Similarity {
        let rotation = self.rotation(cos, sin);
        let image = self.object.vector(image[0], image[1], image[2]);
        let translation = image - scale * (rotation * pivot);
        Similarity { scale, rotation: Rotation3::from_matrix_unchecked(rotation), translation }
    }
}

/// Rigid poses from four points on planes, vertical known.
pub fn upright_se3_4pt(rows: &[Row; 4], up: &Up) -> Poses {
    let pivot = rows[0].point;
    let mut v = [Vector3::zeros(); 4];
    let mut m = [Vector3::zeros(); 4];
    for (i, row) in rows.iter().enumerate() {
        let (normal, [a, b, g]) = up.coefficients(row, &pivot);
        (v[i], m[i]) = (Vector3::from(normal), Vector3::new(a, b, g + row.offset));
    }
    let z = relation(&v);
    let size_sq: f64 = z.iter().map(|z| z * z).sum();
    let mut poses = Poses::none();
    if !(size_sq > RANK_TOLERANCE * RANK_TOLERANCE) {
        return poses;
    }
    let equation = m[0] * z[0] + m[1] * z[1] + m[2] * z[2] + m[3] * z[3];
    let (angles, len) = on_circle(equation.x, equation.y, equation.z, spread_sq(rows) * size_sq);
    // |z_k| is the volume that the other three normals span: T follows best from those that span most.
    let dropped = (1..4).fold(0, |k, i| if z[i].abs() > z[k].abs() { i } else { k });
    let [i, j, k] = OTHERS[dropped];
    let across = v[j].cross(&v[k]);
    let inverse = v[i].dot(&across).recip();
    let columns = [across * inverse, v[k].cross(&v[i]) * inverse, v[i].cross(&v[j]) * inverse];
    for &[cos, sin] in &angles[..len] {
        let turn = Vector3::new(cos, sin, 1.0);
        let image = columns[0] * -m[i].dot(&turn) + columns[1] * -m[j].dot(&turn) + columns[2] * -m[k].dot(&turn);
        poses.push(up.pose(1.0, cos, sin, image.into(), &pivot));
    }
    poses
}

/// The three of four rows without one.
const OTHERS: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

/// The weights z of the linear relation among four vectors, each the volume of the other three:
/// a (b . c x d) - b (a . c x d) + c (d . a x b) - d (c . a x b) = 0.
#[inline]
fn relation([a, b, c, d]: &[Vector3<f64>; 4]) -> [f64; 4] {
    let (first, last) = (a.cross(b), c.cross(d));
    [b.dot(&last), -a.dot(&last), d.dot(&first), -c.dot(&first)]
}

/// Similarities from five points on planes, vertical known.
pub fn upright_sim3_5pt(rows: &[Row; 5], up: &Up) -> Poses {
    let pivot = rows[0].point;
    let mut v = [Vector3::zeros(); 5];
    let mut m = [[0.0; 4]; 5];
    for (i, row) in rows.iter().enumerate() {
        let (normal, [a, b, g]) = up.coefficients(row, &pivot);
        (v[i], m[i]) = (Vector3::from(normal), [row.offset, a, b, g]);
    }
    let mut poses = Poses::none();
    let Some((basis, rest)) = basis_of(&v) else { return poses };
    let [i, j, k] = basis;
    let across = v[j].cross(&v[k]);
    let inverse = v[i].dot(&across).recip();
    let columns = [across * inverse, v[k].cross(&v[i]) * inverse, v[i].cross(&v[j]) * inverse];
    // A further normal is n = sum (n . column) basis normal: that much of the basis rows taken off, its row loses T.
    let [first, second] = rest.map(|r| -> [f64; 4] {
        let share = columns.map(|column| column.dot(&v[r]));
        std::array::from_fn(|c| m[r][c] - share[0] * m[i][c] - share[1] * m[j][c] - share[2] * m[k][c])
    });
    // Two rows d + s (a cos + b sin + g) = 0 are left. Crosswise they lose d; along (d, d') they give s.
    let equation: [f64; 4] = std::array::from_fn(|c| second[0] * first[c] - first[0] * second[c]);
    let scale_row: [f64; 4] = std::array::from_fn(|c| first[0] * first[c] + second[0] * second[c]);
    let (angles, len) = on_circle(equation[1], equation[2], equation[3], spread_sq(rows) * scale_row[0]);
    for &[cos, sin] in &angles[..len] {
        let along = |row: &[f64; 4]| row[1] * cos + row[2] * sin + row[3];
        let scale = -scale_row[0] / along(&scale_row);
        if scale > 0.0 {
            let height = |r: usize| -(m[r][0] + scale * along(&m[r]));
            let image = columns[0] * height(i) + columns[1] * height(j) + columns[2] * height(k);
            poses.push(up.pose(scale, cos, sin, image.into(), &pivot));
        }
    }
    poses
}

/// Volume that three unit normals must span to be a basis without a look at the others.
const AMPLE_VOLUME: f64 = 0.05;

/// Three of five normals that span a volume, the largest one where no ample one is found at once, and the other two.
#[inline]
fn basis_of(v: &[Vector3<f64>; 5]) -> Option<([usize; 3], [usize; 2])> {
    let z = relation(&[v[0], v[1], v[2], v[3]]);
    let dropped = (1..4).fold(0, |k, i| if z[i].abs() > z[k].abs() { i } else { k });
    if z[dropped].abs() > AMPLE_VOLUME {
        return Some((OTHERS[dropped], [dropped, 4]));
    }
    let mut best = (RANK_TOLERANCE, None);
    for first in 0..5 {
        for second in 0..first {
            let mut basis = (0..5).filter(|&i| i != first && i != second);
            let basis: [usize; 3] = std::array::from_fn(|_| basis.next().unwrap_or_default());
            let volume = v[basis[0]].cross(&v[basis[1]]).dot(&v[basis[2]]).abs();
            if volume > best.0 {
                best = (volume, Some((basis, [second, first])));
            }
        }
    }
    best.1
}

/// Sum of squared distances to the first point: the size that a and b have in general.
#[inline]
fn spread_sq(rows: &[Row]) -> f64 {
    rows[1..].iter().map(|row| (row.point - rows[0].point).norm_squared()).sum()
}
