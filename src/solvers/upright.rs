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
//!             3. rigid: three reflections remove T from the last row: a cos + b sin + g + d = 0, a line and a circle
//!             4. similarity: four reflections make the columns (v, d) triangular; the last row is
//!                a cos + b sin + g = 0, the one above it gives s, the first three give T
//! Solutions   2 or 0; of a similarity those with s > 0 (the others are mirror images): 1.53 of 2 on random scenes
//! Degenerate  fewer than three directions of normals, normals in one plane (walls alone), a = b = 0 (heading free),
//!             similarity: planes through one point (scale free). A vanishing diagonal, or r = 0: no pose is returned
//! Scaling     differences to p_1; the solver is equivariant, offsets should be taken about a near origin
//! Source      mathematics.md section 8; derived here
//! Tests       below; tests/solver_accuracy.rs; golden/gravity.json
//! ```

use super::circle::on_circle;
use super::elimination::eliminate;
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
    let mut m = rows.map(|row| {
        let (v, [a, b, g]) = up.coefficients(&row, &pivot);
        [v[0], v[1], v[2], a, b, g + row.offset]
    });
    eliminate::<4, 6, 3>(&mut m);
    let mut poses = Poses::none();
    if !diagonal_holds(&m) {
        return poses;
    }
    let (angles, len) = on_circle(m[3][3], m[3][4], m[3][5], spread_sq(rows));
    for &[cos, sin] in &angles[..len] {
        let right: [f64; 3] = std::array::from_fn(|i| -(m[i][3] * cos + m[i][4] * sin + m[i][5]));
        poses.push(up.pose(1.0, cos, sin, back_substitute(&m, right), &pivot));
    }
    poses
}

/// Similarities from five points on planes, vertical known.
pub fn upright_sim3_5pt(rows: &[Row; 5], up: &Up) -> Poses {
    let pivot = rows[0].point;
    let mut m = rows.map(|row| {
        let (v, [a, b, g]) = up.coefficients(&row, &pivot);
        [v[0], v[1], v[2], row.offset, a, b, g]
    });
    eliminate::<5, 7, 4>(&mut m);
    let mut poses = Poses::none();
    if !diagonal_holds(&m) {
        return poses;
    }
    let (angles, len) = on_circle(m[4][4], m[4][5], m[4][6], spread_sq(rows));
    for &[cos, sin] in &angles[..len] {
        let along = |i: usize| m[i][4] * cos + m[i][5] * sin + m[i][6];
        let scale = -m[3][3] / along(3);
        if scale > 0.0 {
            let right: [f64; 3] = std::array::from_fn(|i| -(m[i][3] + scale * along(i)));
            poses.push(up.pose(scale, cos, sin, back_substitute(&m, right), &pivot));
        }
    }
    poses
}

/// Sum of squared distances to the first point: the size that a and b have in general.
#[inline]
fn spread_sq(rows: &[Row]) -> f64 {
    rows[1..].iter().map(|row| (row.point - rows[0].point).norm_squared()).sum()
}

/// Whether the normals span space.
#[inline]
pub(super) fn diagonal_holds<const M: usize, const C: usize>(m: &[[f64; C]; M]) -> bool {
    (0..3).all(|k| m[k][k].abs() > RANK_TOLERANCE)
}

/// Solves the triangular first three rows for the image of the pivot.
#[inline]
pub(super) fn back_substitute<const M: usize, const C: usize>(m: &[[f64; C]; M], right: [f64; 3]) -> [f64; 3] {
    let z = right[2] / m[2][2];
    let y = (right[1] - m[1][2] * z) / m[1][1];
    let x = (right[0] - m[0][1] * y - m[0][2] * z) / m[0][0];
    [x, y, z]
}
